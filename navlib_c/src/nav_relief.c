/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_relief.c
 * @brief Highest and lowest ground of each costmap cell against its plane.
 */
#include "nav_relief.h"

#define SIDE ((int32_t) NAV_CELLS_PER_COST_CELL)
#define MIDDLE (0.5 * ((double) NAV_CELLS_PER_COST_CELL - 1.0))
#define NOTHING_M 1.0e9

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
