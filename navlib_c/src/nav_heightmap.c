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
#define NAV_CELL_POINTS_MAX 65535U

/* Points placed in one go. The loops over a batch have this fixed length and no branches, so that
 * compilers turn them into instructions for several numbers at once. */
#define NAV_BATCH 32U

/* Not a place on the map. */
#define NAV_OUTSIDE (-1)

/* A coordinate of a point is linear in its coordinates in ROVER. */
typedef struct
{
    double x;
    double y;
    double z;
    double offset;
} nav_direction_t;

/* From ROVER to cells north and east of the map's corner, not rounded, and to metres down in SITE. */
typedef struct
{
    nav_direction_t row;
    nav_direction_t col;
    nav_direction_t down;
    int32_t first_row; /* where the southernmost row is stored */
    int32_t first_col; /* where the westernmost column is stored */
} nav_placing_t;

typedef struct
{
    double x_m[NAV_BATCH]; /* ROVER */
    double y_m[NAV_BATCH];
    double z_m[NAV_BATCH];
    double place[NAV_BATCH]; /* cells from the map's corner along one axis */
    double down_m[NAV_BATCH];
    int32_t row[NAV_BATCH]; /* of storage, or NAV_OUTSIDE */
    int32_t col[NAV_BATCH];
} nav_batch_t;

/* Known heights of three cells, one above the other. */
typedef struct
{
    double z_sum_m;
    double known_count;
} nav_column_t;

static nav_direction_t scaled(double scale, double x, double y, double z, double offset)
{
    const nav_direction_t direction = {scale * x, scale * y, scale * z, offset};

    return direction;
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
        scaled(1.0, -sp, cp * sr, cp * cr, pose->z_site_m),
        nav_wrap_index(map->origin_row, NAV_SIZE), nav_wrap_index(map->origin_col, NAV_SIZE)};

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

static void place_along(const nav_batch_t *batch, const nav_direction_t *to, double *place)
{
    for (uint32_t point = 0U; point < NAV_BATCH; point++)
    {
        place[point] = ((to->x * batch->x_m[point]) + (to->y * batch->y_m[point])) +
                       ((to->z * batch->z_m[point]) + to->offset);
    }
}

static void store_along(const double *place, int32_t first, int32_t *stored)
{
    for (uint32_t point = 0U; point < NAV_BATCH; point++)
    {
        const double from_low = (place[point] >= 0.0) ? place[point] : (double) NAV_OUTSIDE;
        const double inside =
            (from_low < (double) NAV_HEIGHTMAP_SIZE) ? from_low : (double) NAV_OUTSIDE;
        /* not negative on the map: truncation is floor() */
        const int32_t index = (int32_t) inside;
        const int32_t turned = index + first;
        const int32_t wrapped = (turned >= NAV_SIZE) ? (turned - NAV_SIZE) : turned;

        stored[point] = (index >= 0) ? wrapped : NAV_OUTSIDE;
    }
}

static void place_points(nav_batch_t *batch, const nav_placing_t *placing)
{
    place_along(batch, &placing->row, batch->place);
    store_along(batch->place, placing->first_row, batch->row);
    place_along(batch, &placing->col, batch->place);
    store_along(batch->place, placing->first_col, batch->col);
    place_along(batch, &placing->down, batch->down_m);
}

/* All bits when two numbers are equal, none otherwise. */
static uint32_t mask_of_equal(uint32_t a, uint32_t b)
{
    const uint32_t difference = a ^ b;

    return ((difference | (0U - difference)) >> 31U) - 1U;
}

/*
 * Without a branch on the image: which points are the first of their cells cannot be predicted.
 * @return 1 when the point was taken, 0 when the cell is full
 */
static uint32_t add_to_cell(nav_height_cell_t *cell, double z_m, double time_s, uint32_t image_id)
{
    const uint32_t mask = mask_of_equal(cell->image_id, image_id);
    const uint32_t count = mask & cell->point_count;
    const bool is_taken = count < NAV_CELL_POINTS_MAX;

    if (is_taken)
    {
        cell->z_sum_m = ((double) (mask & 1U) * cell->z_sum_m) + z_m;
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

static float height_of_cell(const nav_height_cell_t *cell, double time_s, double expiry_s)
{
    float z_m = NAV_SURFACE_UNKNOWN_M;

    if ((cell->point_count > 0U) && ((time_s - cell->time_s) <= expiry_s))
    {
        const double mean_m = cell->z_sum_m / (double) cell->point_count;

        if (fabs(mean_m) < (double) NAV_SURFACE_UNKNOWN_M)
        {
            z_m = (float) mean_m;
        }
    }
    return z_m;
}

static void unwrap(const nav_heightmap_t *map, double time_s, double expiry_s, float *z_site_m)
{
    const int32_t start_row = nav_wrap_index(map->origin_row, NAV_SIZE);
    const int32_t start_col = nav_wrap_index(map->origin_col, NAV_SIZE);
    int32_t stored_row = start_row;

    for (int32_t row = 0; row < NAV_SIZE; row++)
    {
        const nav_height_cell_t *cells = &map->cells[stored_row * NAV_SIZE];
        float *z_m = &z_site_m[row * NAV_SIZE];

        for (int32_t col = start_col; col < NAV_SIZE; col++)
        {
            z_m[col - start_col] = height_of_cell(&cells[col], time_s, expiry_s);
        }
        for (int32_t col = 0; col < start_col; col++)
        {
            z_m[(col + NAV_SIZE) - start_col] = height_of_cell(&cells[col], time_s, expiry_s);
        }
        stored_row = ((stored_row + 1) < NAV_SIZE) ? (stored_row + 1) : 0;
    }
}

static void add_to_column(nav_column_t *column, float z_m)
{
    if (z_m < NAV_SURFACE_UNKNOWN_M)
    {
        column->z_sum_m += (double) z_m;
        column->known_count += 1.0;
    }
}

/* Heights south, at and north of a cell; a height filled in before does not count. */
static nav_column_t column_at(const float *z_site_m,
                              const uint8_t *is_filled,
                              int32_t row,
                              int32_t col)
{
    const int32_t index = (row * NAV_SIZE) + col;
    nav_column_t column = {0.0, 0.0};

    if (col < NAV_SIZE)
    {
        if ((row > 0) && (is_filled[col] == 0U))
        {
            add_to_column(&column, z_site_m[index - NAV_SIZE]);
        }
        add_to_column(&column, z_site_m[index]);
        if ((row + 1) < NAV_SIZE)
        {
            add_to_column(&column, z_site_m[index + NAV_SIZE]);
        }
    }
    return column;
}

/* is_filled tells of the row to the south, and of this row west of where the work has come. */
static void fill_row(float *z_site_m, uint8_t *is_filled, int32_t row, double neighbors_min)
{
    nav_column_t west = {0.0, 0.0};
    nav_column_t here = column_at(z_site_m, is_filled, row, 0);

    for (int32_t col = 0; col < NAV_SIZE; col++)
    {
        const nav_column_t east = column_at(z_site_m, is_filled, row, col + 1);
        const double known_count = west.known_count + here.known_count + east.known_count;
        float *z_m = &z_site_m[(row * NAV_SIZE) + col];

        is_filled[col] = 0U;
        if ((*z_m >= NAV_SURFACE_UNKNOWN_M) && (known_count >= neighbors_min))
        {
            const double mean_m = (west.z_sum_m + here.z_sum_m + east.z_sum_m) / known_count;

            *z_m = (float) mean_m;
            is_filled[col] = 1U;
        }
        west = here;
        here = east;
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

    (void) memset(&batch, 0, sizeof(batch)); /* what no point fills is placed as well */
    for (uint32_t first = 0U; first < total; first += NAV_BATCH)
    {
        const uint32_t rest = total - first;
        const uint32_t count = (rest < NAV_BATCH) ? rest : NAV_BATCH;

        spread(&batch, &points[first], count);
        place_points(&batch, &placing);
        for (uint32_t point = 0U; point < count; point++)
        {
            const int32_t row = batch.row[point];
            const int32_t col = batch.col[point];

            if ((row == NAV_OUTSIDE) || (col == NAV_OUTSIDE))
            {
                merge.outside_count += 1U;
            }
            else
            {
                merge.merged_count += add_to_cell(&map->cells[(row * NAV_SIZE) + col],
                                                  batch.down_m[point], time_s, image_id);
            }
        }
    }
    return merge;
}

void nav_heightmap_surface(const nav_heightmap_t *map,
                           const nav_params_t *params,
                           double time_s,
                           nav_surface_t *surface)
{
    uint8_t is_filled[NAV_HEIGHTMAP_SIZE] = {0};

    surface->time_s = time_s;
    surface->cell_m = map->cell_m;
    surface->origin_row = map->origin_row;
    surface->origin_col = map->origin_col;
    unwrap(map, time_s, params->heightmap_expiry_s, surface->z_site_m);
    for (int32_t row = 0; row < NAV_SIZE; row++)
    {
        fill_row(surface->z_site_m, is_filled, row, params->surface_fill_neighbors);
    }
}
