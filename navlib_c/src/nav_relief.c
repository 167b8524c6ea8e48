/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_relief.c
 * @brief Highest and lowest ground of each costmap cell against its plane.
 */
#include "nav_relief.h"

#include <string.h>

#include "nav_guard.h"
#include "nav_math.h"

#define SIDE ((int32_t) NAV_CELLS_PER_COST_CELL)
#define MIDDLE (0.5 * ((double) NAV_CELLS_PER_COST_CELL - 1.0))
#define NOTHING_M 1.0e9

#define BLOCKS ((int32_t) NAV_BLOCKS_SIDE)

/* Cells that a ball reaches on either side of its middle: of the largest wheel on the finest grid. */
#define REACH_MAX 12
#define BLANK ((uint32_t) (SIDE * SIDE))     /* gaps in a block without a height */
#define UNKNOWN_Z_M (-NAV_SURFACE_UNKNOWN_M) /* ground that could be as high as anything */

/* Columns done in one go. The loops over a batch have this fixed length and no branches, so that
 * compilers turn them into instructions for several numbers at once. */
#define BATCH 20

_Static_assert(NAV_BLOCKS_SIDE <= 64, "sets of blocks in a row have a bit for each");
_Static_assert(
    (NAV_CELLS_PER_COST_CELL >= 3) && (NAV_CELLS_PER_COST_CELL <= 5),
    "closed gaps do not reach the middle of a block, balls from all of it do: at least 2 cells");
_Static_assert(NAV_HEIGHTMAP_SIZE >= ((2 * REACH_MAX) + BATCH), "a batch fits between the edges");

/** Relief of a costmap cell that has a plane and whose first heightmap cell is the given one on the
 * surface. */
static nav_relief_cell_t relief_of(const nav_cost_cell_t *cell,
                                   const float *z_site_m,
                                   double cell_m)
{
    const double per_row_m = (double) cell->plane_dz_dx * cell_m;
    const double per_col_m = (double) cell->plane_dz_dy * cell_m;
    double plane_row_m =
        ((double) cell->plane_z_site_m - (MIDDLE * per_row_m)) - (MIDDLE * per_col_m);
    double above_m = -NOTHING_M;
    double below_m = NOTHING_M;
    nav_relief_cell_t relief = {0.0F, 0.0F, 0U};

    for (int32_t row = 0; row < SIDE; row++)
    {
        double plane_m = plane_row_m;
        for (int32_t col = 0; col < SIDE; col++)
        {
            const double up_m = plane_m - (double) z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col];
            above_m = (up_m > above_m) ? up_m : above_m;
            below_m = (up_m < below_m) ? up_m : below_m;
            plane_m += per_col_m;
        }
        plane_row_m += per_row_m;
    }
    /* a heightmap cell that is not known lies deeper than anything */
    if (below_m > (-0.5 * (double) NAV_SURFACE_UNKNOWN_M))
    {
        relief.above_m = (float) above_m;
        relief.below_m = (float) below_m;
        relief.is_whole = 1U;
    }
    return relief;
}

void nav_relief_update(nav_relief_t *relief,
                       const nav_costmap_t *costmap,
                       const nav_costmap_state_t *state,
                       const nav_surface_t *surface)
{
    const nav_relief_cell_t nothing = {0.0F, 0.0F, 0U};
    const int32_t last = NAV_HEIGHTMAP_SIZE - SIDE;

    for (int32_t row = 0; row < NAV_COSTMAP_SIZE; row++)
    {
        const int32_t surface_row = ((costmap->origin_row + row) * SIDE) - surface->origin_row;
        for (int32_t col = 0; col < NAV_COSTMAP_SIZE; col++)
        {
            const int32_t surface_col = ((costmap->origin_col + col) * SIDE) - surface->origin_col;
            const int32_t index = (row * NAV_COSTMAP_SIZE) + col;
            if ((surface_row < 0) || (surface_row > last) || (surface_col < 0) ||
                (surface_col > last))
            {
                relief->cells[index] = nothing;
            }
            else if (state->fitted_at[index] == state->surface_count)
            {
                const nav_cost_cell_t *cell = &costmap->cells[index];
                const int32_t first = (surface_row * NAV_HEIGHTMAP_SIZE) + surface_col;
                relief->cells[index] =
                    (cell->is_known != 0U)
                        ? relief_of(cell, &surface->z_site_m[first], surface->cell_m)
                        : nothing;
            }
            else
            {
                /* neither its ground nor its plane has changed */
            }
        }
    }
}

/** A ball over the grid: how much lower its lowest point hangs than ground that many cells away on
 * either side, along one axis. */
typedef struct
{
    int32_t reach; /* cells on either side */
    float fall_m[REACH_MAX + 1];
} ball_t;

/** Blocks along one axis. */
typedef struct
{
    int32_t in_block; /* place of the surface's first cell in its block */
    int32_t first;    /* where that block stands in tables */
    int32_t count;    /* of those that the surface touches */
} blocks_t;

/** A row of blocks: bit k of a set is the one k blocks east of the first. */
typedef struct
{
    uint64_t changed; /* since the last surface that balls rested on */
    uint64_t blank;   /* whole blocks without a height: gaps closed, their middle is unknown */
} row_t;

/** Cells of the surface, from a row and a column to before another. */
typedef struct
{
    int32_t row;
    int32_t row_end;
    int32_t col;
    int32_t col_end;
} part_t;

/**
 * The ball is taken as the paraboloid around it: its two axes add up. All ground it can touch hangs on
 * cells within its radius and two cells more, one from the ground to the cells around it, one from the
 * hub to those around that. Between cells the paraboloid is higher than what they say by a quarter of
 * cell^2 / radius at most, for the ground and for the hub alike: half of that goes to each axis.
 */
static ball_t ball_of(double radius_m, double cell_m)
{
    ball_t ball = {0, {0.0F}};
    ball.reach = (int32_t) ((radius_m / cell_m) + 2.0);
    ball.reach = NAV_ALWAYS(ball.reach <= REACH_MAX) ? ball.reach : REACH_MAX;
    for (int32_t away = 0; away <= ball.reach; away++)
    {
        const double away_m = (double) away * cell_m;
        ball.fall_m[away] =
            (float) (((away_m * away_m) - (0.5 * cell_m * cell_m)) / (2.0 * radius_m));
    }
    return ball;
}

static float lesser(float a, float b)
{
    return (a < b) ? a : b;
}

static float greater(float a, float b)
{
    return (a > b) ? a : b;
}

static int32_t within(int32_t low, int32_t index, int32_t high)
{
    const int32_t raised = (index > low) ? index : low;
    return (raised < high) ? raised : high;
}

/** Where balls rest on the ground of their own column of cells alone, given their row and the columns
 * of a batch. */
static void rest_along_columns(const ball_t *ball,
                               const float *z_site_m,
                               int32_t middle_row,
                               float along_m[BATCH])
{
    const float *middle_m = &z_site_m[middle_row * NAV_HEIGHTMAP_SIZE];
    float rest_m[BATCH];
    float lowest_m[BATCH];

    for (int32_t k = 0; k < BATCH; k++)
    {
        rest_m[k] = middle_m[k] + ball->fall_m[0];
        lowest_m[k] = middle_m[k];
    }
    for (int32_t away = 1; away <= ball->reach; away++)
    {
        const float *south_m = &z_site_m[(middle_row - away) * NAV_HEIGHTMAP_SIZE];
        const float *north_m = &z_site_m[(middle_row + away) * NAV_HEIGHTMAP_SIZE];
        const float fall_m = ball->fall_m[away];
        for (int32_t k = 0; k < BATCH; k++)
        {
            rest_m[k] = lesser(lesser(south_m[k], north_m[k]) + fall_m, rest_m[k]);
            lowest_m[k] = greater(greater(south_m[k], north_m[k]), lowest_m[k]);
        }
    }
    for (int32_t k = 0; k < BATCH; k++)
    {
        along_m[k] = (lowest_m[k] < NAV_SURFACE_UNKNOWN_M) ? rest_m[k] : UNKNOWN_Z_M;
    }
}

/** Where balls rest on all ground, given where they do on that of the columns: highest over those
 * around. From the first column around the first of the batch. */
static void rest_across(const ball_t *ball, const float *along_m, float rest_z_site_m[BATCH])
{
    float rest_m[BATCH];

    for (int32_t k = 0; k < BATCH; k++)
    {
        rest_m[k] = along_m[ball->reach + k] + ball->fall_m[0];
    }
    for (int32_t away = 1; away <= ball->reach; away++)
    {
        const float *west_m = &along_m[ball->reach - away];
        const float *east_m = &along_m[ball->reach + away];
        const float fall_m = ball->fall_m[away];
        for (int32_t k = 0; k < BATCH; k++)
        {
            rest_m[k] = lesser(lesser(west_m[k], east_m[k]) + fall_m, rest_m[k]);
        }
    }
    for (int32_t k = 0; k < BATCH; k++)
    {
        rest_z_site_m[k] = rest_m[k];
    }
}

/** Lets balls rest on columns of a row, a batch of them at least; none reaches an edge. */
static void rest_in_row(const ball_t *ball,
                        const nav_surface_t *surface,
                        int32_t row,
                        int32_t col,
                        int32_t col_end,
                        float *rest_z_site_m)
{
    const int32_t first = col - ball->reach;
    const int32_t width = (col_end - col) + (2 * ball->reach);
    float along_m[NAV_HEIGHTMAP_SIZE];

    /* the last batch ends where the columns do, even if it has some of the one before */
    for (int32_t k = 0; k < width; k += BATCH)
    {
        const int32_t at = within(0, k, width - BATCH);
        rest_along_columns(ball, &surface->z_site_m[first + at], row, &along_m[at]);
    }
    for (int32_t k = col; k < col_end; k += BATCH)
    {
        const int32_t at = within(col, k, col_end - BATCH);
        rest_across(ball, &along_m[at - col], &rest_z_site_m[(row * NAV_HEIGHTMAP_SIZE) + at]);
    }
}

/** Lets balls rest on a part of the surface, where none reaches an edge. Cells of a batch beside it get
 * what they have or will get. */
static void rest_on_part(const ball_t *ball,
                         const nav_surface_t *surface,
                         const part_t *part,
                         float *rest_z_site_m)
{
    const int32_t low = ball->reach;
    const int32_t high = NAV_HEIGHTMAP_SIZE - ball->reach;
    const int32_t col = within(low, part->col, high - BATCH);
    const int32_t col_end = within(col + BATCH, part->col_end, high);
    const int32_t row_end = within(low, part->row_end, high);

    for (int32_t row = within(low, part->row, high); row < row_end; row++)
    {
        rest_in_row(ball, surface, row, col, col_end, rest_z_site_m);
    }
}

/** As if no ground of a part were known. */
static void forget_part(const part_t *part, float *rest_z_site_m)
{
    for (int32_t row = part->row; row < part->row_end; row++)
    {
        for (int32_t col = part->col; col < part->col_end; col++)
        {
            rest_z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col] = UNKNOWN_Z_M;
        }
    }
}

static blocks_t blocks_from(int32_t origin)
{
    const int32_t in_block = nav_wrap_index(origin, SIDE);
    const blocks_t blocks = {in_block, nav_wrap_index((origin - in_block) / SIDE, BLOCKS),
                             (in_block + NAV_HEIGHTMAP_SIZE + (SIDE - 1)) / SIDE};
    return blocks;
}

/** The first cell on the surface of a block, which is given by its place from the first one. */
static int32_t first_cell(const blocks_t *blocks, int32_t block)
{
    return within(0, (block * SIDE) - blocks->in_block, NAV_HEIGHTMAP_SIZE);
}

static int32_t in_tables(const blocks_t *blocks, int32_t block)
{
    const int32_t place = blocks->first + block;
    return (place < BLOCKS) ? place : (place - BLOCKS);
}

/** Takes one row of blocks from tables. */
static row_t row_from(const nav_surface_state_t *changes,
                      const blocks_t *cols,
                      int32_t table_row,
                      uint32_t seen_count)
{
    const int32_t first = table_row * BLOCKS;
    row_t row = {0U, 0U};
    for (int32_t col = 0; col < cols->count; col++)
    {
        const int32_t block = first + in_tables(cols, col);
        const uint64_t is_changed = (changes->changed_at[block] > seen_count) ? 1U : 0U;
        const uint64_t is_blank = (changes->blocks[block].gap_count == BLANK) ? 1U : 0U;
        row.changed |= is_changed << (uint32_t) col;
        row.blank |= is_blank << (uint32_t) col;
    }
    return row;
}

/** Those of a row of blocks from which balls reach a block that changed. */
static uint64_t reached_in_row(const row_t blocks[NAV_BLOCKS_SIDE],
                               int32_t row,
                               int32_t row_count,
                               int32_t reach)
{
    const int32_t last = within(0, row + reach, row_count - 1);
    uint64_t reached = 0U;

    for (int32_t other = within(0, row - reach, last); other <= last; other++)
    {
        reached |= blocks[other].changed;
    }
    for (int32_t step = 0; step < reach; step++)
    {
        reached |= (reached << 1U) | (reached >> 1U);
    }
    return reached;
}

/** The first block from a place on that is in a set; their number when there is none. */
static int32_t find_block(uint64_t set, int32_t from, int32_t count)
{
    int32_t block = from;
    while ((block < count) && (((set >> (uint32_t) block) & 1U) == 0U))
    {
        block++;
    }
    return block;
}

/** The next blocks side by side in a set, as cells, from a place on. @return the place after them */
static int32_t next_part(const blocks_t *cols, uint64_t set, int32_t from, part_t *part)
{
    const int32_t first = find_block(set, from, cols->count);
    const int32_t end = find_block(~set, first, cols->count);
    part->col = first_cell(cols, first);
    part->col_end = first_cell(cols, end);
    return end;
}

/** As if no ground of the blocks of a set were known; in a row of them, given its rows of cells. */
static void forget_blocks(const blocks_t *cols, uint64_t set, part_t part, float *rest_z_site_m)
{
    int32_t end = next_part(cols, set, 0, &part);
    while (part.col < part.col_end)
    {
        forget_part(&part, rest_z_site_m);
        end = next_part(cols, set, end, &part);
    }
}

/** Lets balls rest on the blocks of a set in a row of them, given its rows of cells. */
static void rest_on_blocks(const ball_t *ball,
                           const nav_surface_t *surface,
                           const blocks_t *cols,
                           uint64_t set,
                           part_t part,
                           float *rest_z_site_m)
{
    int32_t end = next_part(cols, set, 0, &part);
    while (part.col < part.col_end)
    {
        rest_on_part(ball, surface, &part, rest_z_site_m);
        end = next_part(cols, set, end, &part);
    }
}

void nav_relief_rest(nav_relief_t *relief,
                     const nav_surface_t *surface,
                     const nav_surface_state_t *changes,
                     double radius_m)
{
    const ball_t ball = ball_of(radius_m, surface->cell_m);
    const int32_t reach = (ball.reach + (SIDE - 1)) / SIDE; /* in blocks */
    const blocks_t rows = blocks_from(surface->origin_row);
    const blocks_t cols = blocks_from(surface->origin_col);
    row_t blocks[NAV_BLOCKS_SIDE];

    (void) nav_heightmap_follow(relief->rest_z_site_m, NAV_HEIGHTMAP_SIZE,
                                (int64_t) surface->origin_row - (int64_t) relief->origin_row,
                                (int64_t) surface->origin_col - (int64_t) relief->origin_col);
    for (int32_t row = 0; row < rows.count; row++)
    {
        blocks[row] = row_from(changes, &cols, in_tables(&rows, row), relief->surface_count);
    }
    for (int32_t row = 0; row < rows.count; row++)
    {
        const part_t part = {first_cell(&rows, row), first_cell(&rows, row + 1), 0, 0};
        const uint64_t reached = reached_in_row(blocks, row, rows.count, reach);
        forget_blocks(&cols, reached, part, relief->rest_z_site_m);
        rest_on_blocks(&ball, surface, &cols, reached & ~blocks[row].blank, part,
                       relief->rest_z_site_m);
    }
    relief->surface_count = changes->surface_count;
    relief->origin_row = surface->origin_row;
    relief->origin_col = surface->origin_col;
}
