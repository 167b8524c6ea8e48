/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_heightmap.c
 * @brief The rolling heightmap and its surface.
 */
#include "nav_heightmap.h"

#include <math.h>
#include <string.h>

#include "nav_math.h"

#define NAV_SIZE ((int32_t) NAV_HEIGHTMAP_SIZE)
#define NAV_BLOCK ((int32_t) NAV_CELLS_PER_COST_CELL)
#define NAV_SIDE ((int32_t) NAV_BLOCKS_SIDE)
#define NAV_RAW ((int32_t) NAV_RAW_SIZE)
#define NAV_CELL_POINTS_MAX 65535U

/* Points placed in one go. The loops over a batch have this fixed length and no branches, so that
 * compilers turn them into instructions for several numbers at once. */
#define NAV_BATCH 32U

/* Time of the oldest height where there is none: it does not expire. */
#define NAV_TIME_NEVER_S 1.0e300

/* Where rows and columns outside the map begin: too low for any sum of a row's and a column's. */
#define NAV_OUTSIDE (-NAV_SIZE * NAV_SIZE)

/* A coordinate of a point is linear in its coordinates in ROVER. */
typedef struct
{
    double x;
    double y;
    double z;
    double offset;
} nav_direction_t;

/* How cells and blocks along one axis are stored. */
typedef struct
{
    int32_t first;       /* where the first cell is stored */
    int32_t in_block;    /* its place in its block */
    int32_t first_block; /* where its block stands in tables */
} nav_axis_t;

/* From ROVER to cells north and east of the map's corner, not rounded, and to metres down in SITE. */
typedef struct
{
    nav_direction_t row;
    nav_direction_t col;
    nav_direction_t down;
    nav_axis_t rows;
    nav_axis_t cols;
} nav_placing_t;

typedef struct
{
    double x_m[NAV_BATCH]; /* ROVER */
    double y_m[NAV_BATCH];
    double z_m[NAV_BATCH];
    double down_m[NAV_BATCH];
    int32_t row[NAV_BATCH]; /* from the map's corner; NAV_SIZE outside */
    int32_t col[NAV_BATCH];
} nav_batch_t;

/* Cells of a row whose gaps are closed in one go, and those that takes: one more at either end. */
#define NAV_FILLED 20
#define NAV_FILLED_FROM (NAV_FILLED + 2)

_Static_assert(NAV_HEIGHTMAP_SIZE >= NAV_FILLED, "cells filled in one go lie on the map");

/* Part of a row before gaps are closed. */
typedef struct
{
    float z_m[NAV_FILLED_FROM];      /* 0 where unknown */
    float is_known[NAV_FILLED_FROM]; /* 1 or 0 */
} nav_known_t;

/* Of the known heights among each cell and its neighbours. */
typedef struct
{
    float mean_m[NAV_FILLED]; /* 0 when there are none */
    float known_count[NAV_FILLED];
} nav_means_t;

/* The cells of a block that lie on the map, one after the other; then such as have no points. */
#define NAV_GATHERED ((uint32_t) (NAV_CELLS_PER_COST_CELL * NAV_CELLS_PER_COST_CELL))
typedef struct
{
    double z_sum_m[NAV_GATHERED];
    double time_s[NAV_GATHERED];
    double point_count[NAV_GATHERED];
    double z_m[NAV_GATHERED]; /* of the surface */
    uint32_t count;           /* of cells on the map */
} nav_gathered_t;

static nav_direction_t scaled(double scale, double x, double y, double z, double offset)
{
    const nav_direction_t direction = {scale * x, scale * y, scale * z, offset};

    return direction;
}

/* Global index of the block of a cell, along one axis. */
static int32_t block_of(int32_t index)
{
    return (index - nav_wrap_index(index, NAV_BLOCK)) / NAV_BLOCK;
}

static nav_axis_t axis_from(int32_t origin)
{
    const nav_axis_t axis = {nav_wrap_index(origin, NAV_SIZE), nav_wrap_index(origin, NAV_BLOCK),
                             nav_wrap_index(block_of(origin), NAV_SIDE)};

    return axis;
}

static nav_placing_t placing_at(const nav_heightmap_t *map, const nav_pose_t *pose)
{
    const double cells_per_m = 1.0 / map->cell_m;
    const double cr = nav_cos(pose->roll_rad);
    const double sr = nav_sin(pose->roll_rad);
    const double cp = nav_cos(pose->pitch_rad);
    const double sp = nav_sin(pose->pitch_rad);
    const double cy = nav_cos(pose->yaw_rad);
    const double sy = nav_sin(pose->yaw_rad);
    /* Rz(yaw) Ry(pitch) Rx(roll) */
    const nav_placing_t placing = {
        scaled(cells_per_m, cy * cp, (cy * sp * sr) - (sy * cr), (cy * sp * cr) + (sy * sr),
               (cells_per_m * pose->x_site_m) - (double) map->origin_row),
        scaled(cells_per_m, sy * cp, (sy * sp * sr) + (cy * cr), (sy * sp * cr) - (cy * sr),
               (cells_per_m * pose->y_site_m) - (double) map->origin_col),
        scaled(1.0, -sp, cp * sr, cp * cr, pose->z_site_m), axis_from(map->origin_row),
        axis_from(map->origin_col)};

    return placing;
}

static void spread(nav_batch_t *batch, const nav_point_t *points, uint32_t count)
{
    for (uint32_t point = 0U; point < count; point++)
    {
        batch->x_m[point] = (double) points[point].x_m;
        batch->y_m[point] = (double) points[point].y_m;
        batch->z_m[point] = (double) points[point].z_m;
    }
}

static double along(const nav_batch_t *batch, const nav_direction_t *to, uint32_t point)
{
    return ((to->x * batch->x_m[point]) + (to->y * batch->y_m[point])) +
           ((to->z * batch->z_m[point]) + to->offset);
}

/* Rows or columns of the map, from its corner. */
static void find_cells(const nav_batch_t *batch, const nav_direction_t *to, int32_t *index)
{
    const double outside = (double) NAV_HEIGHTMAP_SIZE;

    for (uint32_t point = 0U; point < NAV_BATCH; point++)
    {
        const double place = along(batch, to, point);
        const double from_low = (place >= 0.0) ? place : outside;
        const double limited = (from_low < outside) ? from_low : outside;

        /* not negative: truncation is floor() */
        index[point] = (int32_t) limited;
    }
}

static void place_points(nav_batch_t *batch, const nav_placing_t *placing)
{
    find_cells(batch, &placing->row, batch->row);
    find_cells(batch, &placing->col, batch->col);
    for (uint32_t point = 0U; point < NAV_BATCH; point++)
    {
        batch->down_m[point] = along(batch, &placing->down, point);
    }
}

static int32_t wrap_once(int32_t index, int32_t size)
{
    return (index >= size) ? (index - size) : index;
}

/* Lists where rows or columns begin in storage, given what lies between two of them there. */
static void list_lines(const nav_axis_t *axis,
                       int32_t cell_step,
                       int32_t block_step,
                       nav_line_t lines[NAV_HEIGHTMAP_SIZE + 1])
{
    int32_t in_block = axis->in_block;
    int32_t block = axis->first_block;

    for (int32_t index = 0; index < NAV_SIZE; index++)
    {
        lines[index].cell = wrap_once(axis->first + index, NAV_SIZE) * cell_step;
        lines[index].block = block * block_step;
        in_block += 1;
        if (in_block == NAV_BLOCK)
        {
            in_block = 0;
            block = wrap_once(block + 1, NAV_SIDE);
        }
    }
    lines[NAV_SIZE].cell = NAV_OUTSIDE;
    lines[NAV_SIZE].block = 0;
}

/* 1 when two numbers are equal, 0 otherwise; not a comparison, which may become a branch. */
static uint32_t are_equal(uint32_t a, uint32_t b)
{
    const uint64_t difference = (uint64_t) a ^ (uint64_t) b;

    return (uint32_t) ((difference - 1U) >> 63U);
}

/*
 * Without a branch on the image: which points are the first of their cells cannot be predicted.
 * @return 1 when the point was taken, 0 when the cell is full
 */
static uint32_t add_to_cell(nav_height_cell_t *cell, double z_m, double time_s, uint32_t image_id)
{
    static const double kept[2] = {0.0, 1.0}; /* of the sum of another image, of this one */
    const uint32_t is_same = are_equal(cell->image_id, image_id);
    const uint32_t count = (0U - is_same) & cell->point_count;
    const bool is_taken = count < NAV_CELL_POINTS_MAX;

    if (is_taken)
    {
        cell->z_sum_m = (kept[is_same] * cell->z_sum_m) + z_m;
        cell->time_s = time_s;
        cell->image_id = image_id;
        cell->point_count = count + 1U;
    }
    return is_taken ? 1U : 0U;
}

static void clear_rows(nav_heightmap_t *map, int32_t first_row, int32_t row_count)
{
    for (int32_t offset = 0; (offset < NAV_SIZE) && (offset < row_count); offset++)
    {
        const int32_t row = nav_wrap_index(first_row + offset, NAV_SIZE);

        (void) memset(&map->cells[row * NAV_SIZE], 0, sizeof(map->cells[0]) * (size_t) NAV_SIZE);
    }
}

static void clear_cols(nav_heightmap_t *map, int32_t first_col, int32_t col_count)
{
    for (int32_t offset = 0; (offset < NAV_SIZE) && (offset < col_count); offset++)
    {
        const int32_t col = nav_wrap_index(first_col + offset, NAV_SIZE);

        for (int32_t row = 0; row < NAV_SIZE; row++)
        {
            (void) memset(&map->cells[(row * NAV_SIZE) + col], 0, sizeof(map->cells[0]));
        }
    }
}

/* The storage of indices that leave at one end is that of those which come at the other. */
static int32_t first_leaving(int32_t old_origin, int32_t new_origin)
{
    return (new_origin > old_origin) ? old_origin : new_origin;
}

static int32_t leaving_count(int32_t old_origin, int32_t new_origin)
{
    const int64_t moved = (int64_t) new_origin - (int64_t) old_origin;
    const int64_t distance = (moved < 0) ? -moved : moved;

    return (distance < (int64_t) NAV_SIZE) ? (int32_t) distance : NAV_SIZE;
}

static void mark_rows(nav_heightmap_t *map, int32_t first_row, int32_t row_count)
{
    const int32_t last = block_of(first_row + row_count - 1);

    for (int32_t row = block_of(first_row); row <= last; row++)
    {
        const int32_t first = nav_wrap_index(row, NAV_SIDE) * NAV_SIDE;

        (void) memset(&map->is_changed[first], 1, (size_t) NAV_SIDE);
    }
}

static void mark_cols(nav_heightmap_t *map, int32_t first_col, int32_t col_count)
{
    const int32_t last = block_of(first_col + col_count - 1);

    for (int32_t col = block_of(first_col); col <= last; col++)
    {
        for (int32_t row = 0; row < NAV_SIDE; row++)
        {
            map->is_changed[(row * NAV_SIDE) + nav_wrap_index(col, NAV_SIDE)] = 1U;
        }
    }
}

/* Marks what comes along an axis that moves, and the edge behind which cells leave. */
static void mark_moved(nav_heightmap_t *map, int32_t origin_row, int32_t origin_col)
{
    const int32_t rows = leaving_count(map->origin_row, origin_row);
    const int32_t cols = leaving_count(map->origin_col, origin_col);

    if (rows > 0)
    {
        mark_rows(map, origin_row, (origin_row > map->origin_row) ? 1 : rows);
        mark_rows(map, (origin_row + NAV_SIZE) - ((origin_row > map->origin_row) ? rows : 1),
                  (origin_row > map->origin_row) ? rows : 1);
    }
    if (cols > 0)
    {
        mark_cols(map, origin_col, (origin_col > map->origin_col) ? 1 : cols);
        mark_cols(map, (origin_col + NAV_SIZE) - ((origin_col > map->origin_col) ? cols : 1),
                  (origin_col > map->origin_col) ? cols : 1);
    }
}

/* Cells of blocks that lie on the map, as its rows and columns from the corner. */
typedef struct
{
    int32_t row;
    int32_t row_end;
    int32_t col;
    int32_t col_end;
} nav_patch_t;

static int32_t clipped(int32_t place)
{
    const int32_t from_low = (place > 0) ? place : 0;

    return (from_low < NAV_SIZE) ? from_low : NAV_SIZE;
}

/* Of blocks side by side, given by their places from that of the map's corner. */
static nav_patch_t patch_of_blocks(const nav_axis_t *rows,
                                   const nav_axis_t *cols,
                                   int32_t block_row,
                                   int32_t block_col,
                                   int32_t block_col_end)
{
    const int32_t row = (block_row * NAV_BLOCK) - rows->in_block;
    const int32_t col = (block_col * NAV_BLOCK) - cols->in_block;
    const int32_t col_end = (block_col_end * NAV_BLOCK) - cols->in_block;
    const nav_patch_t patch = {clipped(row), clipped(row + NAV_BLOCK), clipped(col),
                               clipped(col_end)};

    return patch;
}

/* Takes the cells of a block from the map. @return false when none of them has a point */
static bool gather(const nav_heightmap_t *map, const nav_patch_t *patch, nav_gathered_t *cells)
{
    const int32_t first_col = nav_wrap_index(map->origin_col + patch->col, NAV_SIZE);
    int32_t stored_row = nav_wrap_index(map->origin_row + patch->row, NAV_SIZE);
    uint32_t any_count = 0U;

    cells->count = 0U;
    for (int32_t row = patch->row; row < patch->row_end; row++)
    {
        int32_t stored_col = first_col;

        for (int32_t col = patch->col; col < patch->col_end; col++)
        {
            const nav_height_cell_t *cell = &map->cells[(stored_row * NAV_SIZE) + stored_col];

            cells->z_sum_m[cells->count] = cell->z_sum_m;
            cells->time_s[cells->count] = cell->time_s;
            cells->point_count[cells->count] = (double) cell->point_count;
            cells->count += 1U;
            any_count |= cell->point_count;
            stored_col = wrap_once(stored_col + 1, NAV_SIZE);
        }
        stored_row = wrap_once(stored_row + 1, NAV_SIZE);
    }
    for (uint32_t cell = cells->count; cell < NAV_GATHERED; cell++)
    {
        cells->z_sum_m[cell] = 0.0;
        cells->time_s[cell] = 0.0;
        cells->point_count[cell] = 0.0;
    }
    return any_count > 0U;
}

/* Takes the means for heights; what has no points or is too old is unknown, and has no time. */
static void judge_heights(nav_gathered_t *cells, double time_s, double expiry_s)
{
    const double unknown_m = (double) NAV_SURFACE_UNKNOWN_M;
    double divisor[NAV_GATHERED];

    for (uint32_t cell = 0U; cell < NAV_GATHERED; cell++)
    {
        divisor[cell] = (cells->point_count[cell] > 1.0) ? cells->point_count[cell] : 1.0;
    }
    for (uint32_t cell = 0U; cell < NAV_GATHERED; cell++)
    {
        const double age_s = time_s - cells->time_s[cell];
        const double mean_m = cells->z_sum_m[cell] / divisor[cell];
        const double near_m = (fabs(mean_m) < unknown_m) ? mean_m : unknown_m;
        const double seen_m = (cells->point_count[cell] > 0.0) ? near_m : unknown_m;

        cells->z_m[cell] = (age_s <= expiry_s) ? seen_m : unknown_m;
    }
    for (uint32_t cell = 0U; cell < NAV_GATHERED; cell++)
    {
        cells->time_s[cell] =
            (cells->z_m[cell] < unknown_m) ? cells->time_s[cell] : NAV_TIME_NEVER_S;
    }
}

static nav_surface_block_t sum_up(const nav_gathered_t *cells)
{
    nav_surface_block_t block = {NAV_TIME_NEVER_S, cells->count};

    for (uint32_t cell = 0U; cell < NAV_GATHERED; cell++)
    {
        const double time_s = cells->time_s[cell];

        block.oldest_s = (time_s < block.oldest_s) ? time_s : block.oldest_s;
        block.gap_count -= (cells->z_m[cell] < (double) NAV_SURFACE_UNKNOWN_M) ? 1U : 0U;
    }
    return block;
}

static void place_heights(const nav_gathered_t *cells, const nav_patch_t *patch, float *raw_m)
{
    uint32_t cell = 0U;

    for (int32_t row = patch->row; row < patch->row_end; row++)
    {
        for (int32_t col = patch->col; col < patch->col_end; col++)
        {
            raw_m[((row + 1) * NAV_RAW) + (col + 1)] = (float) cells->z_m[cell];
            cell += 1U;
        }
    }
}

static void place_unknown(const nav_patch_t *patch, float *raw_m)
{
    for (int32_t row = patch->row; row < patch->row_end; row++)
    {
        for (int32_t col = patch->col; col < patch->col_end; col++)
        {
            raw_m[((row + 1) * NAV_RAW) + (col + 1)] = NAV_SURFACE_UNKNOWN_M;
        }
    }
}

/* Takes the heights of a block from the map. */
static nav_surface_block_t unwrap(const nav_heightmap_t *map,
                                  const nav_patch_t *patch,
                                  double time_s,
                                  double expiry_s,
                                  float *raw_m)
{
    nav_gathered_t cells;
    nav_surface_block_t block = {NAV_TIME_NEVER_S, 0U};

    if (gather(map, patch, &cells))
    {
        judge_heights(&cells, time_s, expiry_s);
        place_heights(&cells, patch, raw_m);
        block = sum_up(&cells);
    }
    else
    {
        place_unknown(patch, raw_m);
        block.gap_count = cells.count;
    }
    return block;
}

/* Copies a patch without gaps to the surface. */
static void copy(const float *raw_m, const nav_patch_t *patch, float *z_site_m)
{
    for (int32_t row = patch->row; row < patch->row_end; row++)
    {
        for (int32_t col = patch->col; col < patch->col_end; col++)
        {
            z_site_m[(row * NAV_SIZE) + col] = raw_m[((row + 1) * NAV_RAW) + (col + 1)];
        }
    }
}

/* @return the number of known heights */
static uint32_t find_known(const float *raw_m, nav_known_t *known)
{
    uint32_t count = 0U;

    for (int32_t col = 0; col < NAV_FILLED_FROM; col++)
    {
        known->z_m[col] = (raw_m[col] < NAV_SURFACE_UNKNOWN_M) ? raw_m[col] : 0.0F;
        known->is_known[col] = (raw_m[col] < NAV_SURFACE_UNKNOWN_M) ? 1.0F : 0.0F;
        count += (raw_m[col] < NAV_SURFACE_UNKNOWN_M) ? 1U : 0U;
    }
    return count;
}

/* Over three rows, from south, and three columns. */
static void take_means(const nav_known_t rows[3], nav_means_t *means)
{
    double z_sum_m[NAV_FILLED_FROM];
    float count[NAV_FILLED_FROM];
    float divisor[NAV_FILLED];

    for (int32_t col = 0; col < NAV_FILLED_FROM; col++)
    {
        z_sum_m[col] = ((0.0 + (double) rows[0].z_m[col]) + (double) rows[1].z_m[col]) +
                       (double) rows[2].z_m[col];
        count[col] = rows[0].is_known[col] + rows[1].is_known[col] + rows[2].is_known[col];
    }
    for (int32_t col = 0; col < NAV_FILLED; col++)
    {
        const float known_count = count[col] + count[col + 1] + count[col + 2];

        means->known_count[col] = known_count;
        divisor[col] = (known_count > 1.0F) ? known_count : 1.0F;
    }
    for (int32_t col = 0; col < NAV_FILLED; col++)
    {
        const double sum_m = z_sum_m[col] + z_sum_m[col + 1] + z_sum_m[col + 2];

        means->mean_m[col] = (float) (sum_m / (double) divisor[col]);
    }
}

static void close_gaps(const float *raw_m,
                       const nav_means_t *means,
                       float known_min,
                       float *z_site_m)
{
    for (int32_t col = 0; col < NAV_FILLED; col++)
    {
        const float gap_m =
            (means->known_count[col] >= known_min) ? means->mean_m[col] : NAV_SURFACE_UNKNOWN_M;

        z_site_m[col] = (raw_m[col] < NAV_SURFACE_UNKNOWN_M) ? raw_m[col] : gap_m;
    }
}

/* Copies a patch to the surface, gaps with enough known neighbours closed, in rows of NAV_FILLED. */
static void fill_part(const float *raw_m,
                      const nav_patch_t *patch,
                      double neighbors_min,
                      float *z_site_m)
{
    const float known_min = (float) -floor(-neighbors_min); /* what is counted is whole */
    const int32_t row_count = patch->row_end - patch->row;
    const float *south_m = &raw_m[(patch->row * NAV_RAW) + patch->col]; /* with the border */
    nav_known_t rows[NAV_CELLS_PER_COST_CELL + 2];
    uint32_t known_count = 0U;

    for (int32_t row = 0; row < (row_count + 2); row++)
    {
        known_count += find_known(&south_m[row * NAV_RAW], &rows[row]);
    }
    if (known_count > 0U)
    {
        for (int32_t row = 0; row < row_count; row++)
        {
            nav_means_t means;

            take_means(&rows[row], &means);
            close_gaps(&south_m[((row + 1) * NAV_RAW) + 1], &means, known_min,
                       &z_site_m[((patch->row + row) * NAV_SIZE) + patch->col]);
        }
    }
    else
    {
        copy(raw_m, patch, z_site_m);
    }
}

/*
 * Copies a patch to the surface, gaps with enough known neighbours closed. The last part may reach beyond
 * the patch: cells there get what they have or will get.
 */
static void fill(const float *raw_m,
                 const nav_patch_t *patch,
                 double neighbors_min,
                 float *z_site_m)
{
    const int32_t last = NAV_SIZE - NAV_FILLED;

    for (int32_t first = patch->col; first < patch->col_end; first += NAV_FILLED)
    {
        const int32_t col = (first < last) ? first : last;
        const nav_patch_t part = {patch->row, patch->row_end, col, col + NAV_FILLED};

        fill_part(raw_m, &part, neighbors_min, z_site_m);
    }
}

static void move(float *to_m, const float *from_m, int32_t count)
{
    (void) memmove(to_m, from_m, sizeof(to_m[0]) * (size_t) count);
}

/* A row at a time, in the order that overwrites nothing before its use. */
static void shift(float *z_m, int32_t width, int32_t offset)
{
    const int32_t count = width * width;

    if (offset > 0)
    {
        for (int32_t at = 0; at < (count - offset); at += width)
        {
            const int32_t left = (count - offset) - at;

            move(&z_m[at], &z_m[at + offset], (left < width) ? left : width);
        }
    }
    else
    {
        for (int32_t end = count; end > -offset; end -= width)
        {
            const int32_t left = end + offset;
            const int32_t first = end - ((left < width) ? left : width);

            move(&z_m[first], &z_m[first + offset], end - first);
        }
    }
}

/* Moves what was made before to where it is now; what comes is made later. @return false if nothing stays */
static bool follow(const nav_heightmap_t *map, nav_surface_state_t *state, nav_surface_t *surface)
{
    const int64_t rows = (int64_t) map->origin_row - (int64_t) surface->origin_row;
    const int64_t cols = (int64_t) map->origin_col - (int64_t) surface->origin_col;

    (void) nav_heightmap_follow(state->z_m, NAV_RAW, rows, cols);
    return nav_heightmap_follow(surface->z_site_m, NAV_SIZE, rows, cols);
}

static void clear_border(float *raw_m)
{
    for (int32_t place = 0; place < NAV_RAW; place++)
    {
        raw_m[place] = NAV_SURFACE_UNKNOWN_M;
        raw_m[((NAV_RAW - 1) * NAV_RAW) + place] = NAV_SURFACE_UNKNOWN_M;
        raw_m[place * NAV_RAW] = NAV_SURFACE_UNKNOWN_M;
        raw_m[(place * NAV_RAW) + (NAV_RAW - 1)] = NAV_SURFACE_UNKNOWN_M;
    }
}

/* Renews the heights of all blocks whose map changed or expired, and leaves them marked. */
static void renew(nav_heightmap_t *map, double time_s, double expiry_s, nav_surface_state_t *state)
{
    const nav_axis_t rows = axis_from(map->origin_row);
    const nav_axis_t cols = axis_from(map->origin_col);

    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        const int32_t first = wrap_once(rows.first_block + row, NAV_SIDE) * NAV_SIDE;

        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            const int32_t block = first + wrap_once(cols.first_block + col, NAV_SIDE);

            if ((map->is_changed[block] != 0U) ||
                ((time_s - state->blocks[block].oldest_s) > expiry_s))
            {
                const nav_patch_t patch = patch_of_blocks(&rows, &cols, row, col, col + 1);

                map->is_changed[block] = 1U;
                state->blocks[block] = unwrap(map, &patch, time_s, expiry_s, state->z_m);
            }
        }
    }
}

/* Gives the blocks that are marked, and those beside them, the number of this surface. */
static void stamp(const uint8_t *is_changed, nav_surface_state_t *state)
{
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        const uint8_t *south = &is_changed[wrap_once(row + (NAV_SIDE - 1), NAV_SIDE) * NAV_SIDE];
        const uint8_t *here = &is_changed[row * NAV_SIDE];
        const uint8_t *north = &is_changed[wrap_once(row + 1, NAV_SIDE) * NAV_SIDE];
        uint8_t is_marked[NAV_BLOCKS_SIDE];

        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            is_marked[col] = (uint8_t) (south[col] | here[col] | north[col]);
        }
        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            const int32_t west = wrap_once(col + (NAV_SIDE - 1), NAV_SIDE);
            const int32_t east = wrap_once(col + 1, NAV_SIDE);

            if ((is_marked[west] | is_marked[col] | is_marked[east]) != 0U)
            {
                state->changed_at[(row * NAV_SIDE) + col] = state->surface_count;
            }
        }
    }
}

/* What a surface asks of a block. */
typedef enum
{
    NAV_KEEP,
    NAV_COPY, /* it has no gaps */
    NAV_FILL
} nav_task_t;

static nav_task_t task_of(const nav_surface_state_t *state, int32_t block)
{
    nav_task_t task = NAV_KEEP;

    if (state->changed_at[block] == state->surface_count)
    {
        task = (state->blocks[block].gap_count == 0U) ? NAV_COPY : NAV_FILL;
    }
    return task;
}

/* The end of the blocks side by side that ask for the same as the one at a place. */
static int32_t end_of_task(const nav_task_t tasks[NAV_BLOCKS_SIDE], int32_t col)
{
    int32_t end = col + 1;

    while ((end < NAV_SIDE) && (tasks[end] == tasks[col]))
    {
        end += 1;
    }
    return end;
}

/* Takes a row of blocks, given by its place from that of the map's corner, to the surface. */
static void fill_row(const nav_heightmap_t *map,
                     const nav_surface_state_t *state,
                     double neighbors_min,
                     int32_t row,
                     float *z_site_m)
{
    const nav_axis_t rows = axis_from(map->origin_row);
    const nav_axis_t cols = axis_from(map->origin_col);
    const int32_t first = wrap_once(rows.first_block + row, NAV_SIDE) * NAV_SIDE;
    nav_task_t tasks[NAV_BLOCKS_SIDE];
    int32_t col = 0;

    for (int32_t block = 0; block < NAV_SIDE; block++)
    {
        tasks[block] = task_of(state, first + wrap_once(cols.first_block + block, NAV_SIDE));
    }
    while (col < NAV_SIDE)
    {
        const int32_t end = end_of_task(tasks, col);
        const nav_patch_t patch = patch_of_blocks(&rows, &cols, row, col, end);

        if (tasks[col] == NAV_COPY)
        {
            copy(state->z_m, &patch, z_site_m);
        }
        else if (tasks[col] == NAV_FILL)
        {
            fill(state->z_m, &patch, neighbors_min, z_site_m);
        }
        else
        {
            /* neither its heights nor those beside it have changed */
        }
        col = end;
    }
}

void nav_heightmap_init(nav_heightmap_t *map, const nav_params_t *params)
{
    (void) memset(map, 0, sizeof(*map));
    map->cell_m = params->heightmap_cell_m;
}

bool nav_heightmap_center(nav_heightmap_t *map, double x_site_m, double y_site_m)
{
    const double cells_per_m = 1.0 / map->cell_m;
    int32_t row = 0;
    int32_t col = 0;
    const bool is_row_valid = nav_floor_index(x_site_m * cells_per_m, &row);
    const bool is_col_valid = nav_floor_index(y_site_m * cells_per_m, &col);
    const bool is_valid = is_row_valid && is_col_valid;

    if (is_valid)
    {
        const int32_t origin_row = row - (NAV_SIZE / 2);
        const int32_t origin_col = col - (NAV_SIZE / 2);

        if (map->is_placed != 0U)
        {
            clear_rows(map, first_leaving(map->origin_row, origin_row),
                       leaving_count(map->origin_row, origin_row));
            clear_cols(map, first_leaving(map->origin_col, origin_col),
                       leaving_count(map->origin_col, origin_col));
            mark_moved(map, origin_row, origin_col);
        }
        map->origin_row = origin_row;
        map->origin_col = origin_col;
        map->is_placed = 1U;
    }
    return is_valid;
}

nav_merge_t nav_heightmap_merge(nav_heightmap_t *map,
                                const nav_pose_t *pose,
                                double time_s,
                                uint32_t image_id,
                                const nav_point_t *points,
                                uint32_t point_count)
{
    const nav_placing_t placing = placing_at(map, pose);
    const uint32_t capacity = (uint32_t) NAV_CHUNK_POINTS_MAX;
    const uint32_t total = (point_count < capacity) ? point_count : capacity;
    nav_merge_t merge = {0U, 0U};
    nav_batch_t batch;

    list_lines(&placing.rows, NAV_SIZE, NAV_SIDE, map->rows);
    list_lines(&placing.cols, 1, 1, map->cols);
    (void) memset(&batch, 0, sizeof(batch)); /* what no point fills is placed as well */
    for (uint32_t first = 0U; first < total; first += NAV_BATCH)
    {
        const uint32_t rest = total - first;
        const uint32_t count = (rest < NAV_BATCH) ? rest : NAV_BATCH;

        spread(&batch, &points[first], count);
        place_points(&batch, &placing);
        for (uint32_t point = 0U; point < count; point++)
        {
            const nav_line_t *row = &map->rows[batch.row[point]];
            const nav_line_t *col = &map->cols[batch.col[point]];
            const int32_t cell = row->cell + col->cell;

            if (cell < 0)
            {
                merge.outside_count += 1U;
            }
            else
            {
                map->is_changed[row->block + col->block] = 1U;
                merge.merged_count +=
                    add_to_cell(&map->cells[cell], batch.down_m[point], time_s, image_id);
            }
        }
    }
    return merge;
}

void nav_heightmap_surface(nav_heightmap_t *map,
                           const nav_params_t *params,
                           double time_s,
                           nav_surface_state_t *state,
                           nav_surface_t *surface)
{
    /* what had expired is known again when time runs backwards */
    const bool is_kept =
        (state->surface_count > 0U) && (time_s >= surface->time_s) && follow(map, state, surface);

    if (!is_kept)
    {
        (void) memset(map->is_changed, 1, sizeof(map->is_changed));
    }
    state->surface_count += 1U;
    surface->time_s = time_s;
    surface->cell_m = map->cell_m;
    surface->origin_row = map->origin_row;
    surface->origin_col = map->origin_col;
    clear_border(state->z_m);
    renew(map, time_s, params->heightmap_expiry_s, state);
    stamp(map->is_changed, state);
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        fill_row(map, state, params->surface_fill_neighbors, row, surface->z_site_m);
    }
    (void) memset(map->is_changed, 0, sizeof(map->is_changed));
}

bool nav_heightmap_follow(float *z_m, int32_t width, int64_t rows, int64_t cols)
{
    const int64_t size = (int64_t) NAV_SIZE;
    const bool is_near = (rows > -size) && (rows < size) && (cols > -size) && (cols < size);

    if (is_near && ((rows != 0) || (cols != 0)))
    {
        shift(z_m, width, (int32_t) ((rows * (int64_t) width) + cols));
    }
    return is_near;
}
