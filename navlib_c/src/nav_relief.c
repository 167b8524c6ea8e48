/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_relief.c
 * @brief Highest and lowest ground of each costmap cell against its plane.
 */
#include "nav_relief.h"

#include "nav_guard.h"

#define SIDE ((int32_t) NAV_CELLS_PER_COST_CELL)
#define MIDDLE (0.5 * ((double) NAV_CELLS_PER_COST_CELL - 1.0))
#define NOTHING_M 1.0e9

/* Cells that a ball reaches on either side of its middle: of the largest wheel on the finest grid. */
#define REACH_MAX 12
#define TAPS_MAX ((2 * REACH_MAX) + 1)
#define UNKNOWN_Z_M (-NAV_SURFACE_UNKNOWN_M) /* ground that could be as high as anything */

/** Relief of a costmap cell whose first heightmap cell is the given one on the surface. */
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
    /* a cell that is not known lies deeper than anything */
    if ((cell->is_known != 0U) && (below_m > (-0.5 * (double) NAV_SURFACE_UNKNOWN_M)))
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
                const int32_t first = (surface_row * NAV_HEIGHTMAP_SIZE) + surface_col;
                relief->cells[index] =
                    relief_of(&costmap->cells[index], &surface->z_site_m[first], surface->cell_m);
            }
            else
            {
                /* neither its ground nor its plane has changed */
            }
        }
    }
}

/** A ball over the grid: how much lower its lowest point hangs than ground that many cells away, along
 * one axis. */
typedef struct
{
    int32_t reach; /* cells on either side */
    float fall_m[TAPS_MAX];
} ball_t;

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
    for (int32_t tap = 0; tap <= (2 * ball.reach); tap++)
    {
        const double away_m = (double) (tap - ball.reach) * cell_m;
        ball.fall_m[tap] =
            (float) (((away_m * away_m) - (0.5 * cell_m * cell_m)) / (2.0 * radius_m));
    }
    return ball;
}

/** Where balls rest on the ground of one column of cells alone, in every column around a row. */
static void rest_along_columns(const ball_t *ball,
                               const nav_surface_t *surface,
                               int32_t middle_row,
                               float z_m[NAV_HEIGHTMAP_SIZE])
{
    for (int32_t col = 0; col < NAV_HEIGHTMAP_SIZE; col++)
    {
        z_m[col] = NAV_SURFACE_UNKNOWN_M;
    }
    for (int32_t tap = 0; tap <= (2 * ball->reach); tap++)
    {
        const int32_t row = middle_row + (tap - ball->reach);
        const float *ground_m = &surface->z_site_m[row * NAV_HEIGHTMAP_SIZE];
        const float fall_m = ball->fall_m[tap];
        for (int32_t col = 0; col < NAV_HEIGHTMAP_SIZE; col++)
        {
            const float known_m =
                (ground_m[col] < NAV_SURFACE_UNKNOWN_M) ? ground_m[col] : UNKNOWN_Z_M;
            const float rest_m = known_m + fall_m;
            z_m[col] = (rest_m < z_m[col]) ? rest_m : z_m[col];
        }
    }
}

/** Where balls rest on all ground: highest over the columns around. */
static void rest_across(const ball_t *ball,
                        const float along_m[NAV_HEIGHTMAP_SIZE],
                        float rest_z_site_m[NAV_HEIGHTMAP_SIZE])
{
    for (int32_t tap = 0; tap <= (2 * ball->reach); tap++)
    {
        const float fall_m = ball->fall_m[tap];
        const float *from_m = &along_m[tap];
        float *to_m = &rest_z_site_m[ball->reach];
        for (int32_t col = 0; col < (NAV_HEIGHTMAP_SIZE - (2 * ball->reach)); col++)
        {
            const float rest_m = from_m[col] + fall_m;
            to_m[col] = ((tap == 0) || (rest_m < to_m[col])) ? rest_m : to_m[col];
        }
    }
}

void nav_relief_rest(nav_relief_t *relief, const nav_surface_t *surface, double radius_m)
{
    const ball_t ball = ball_of(radius_m, surface->cell_m);
    float along_m[NAV_HEIGHTMAP_SIZE];

    for (int32_t cell = 0; cell < NAV_HEIGHTMAP_CELLS; cell++)
    {
        relief->rest_z_site_m[cell] = UNKNOWN_Z_M;
    }
    for (int32_t row = ball.reach; row < (NAV_HEIGHTMAP_SIZE - ball.reach); row++)
    {
        rest_along_columns(&ball, surface, row, along_m);
        rest_across(&ball, along_m, &relief->rest_z_site_m[row * NAV_HEIGHTMAP_SIZE]);
    }
}
