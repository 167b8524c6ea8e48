/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ground.c
 * @brief The surface seen from the local ground plane under one pose.
 */
#include "nav_ground.h"

#include <math.h>

#include "nav_guard.h"
#include "nav_math.h"
#include "nav_minmax.h"

#define EDGE_CELLS 1.0e-9
#define SIDE ((int32_t) NAV_CELLS_PER_COST_CELL)
#define MIDDLE (0.5 * ((double) NAV_CELLS_PER_COST_CELL - 1.0))

/** Frame from the plane's slope and the heading. */
static void place_plane(nav_ground_t *ground, const nav_cost_cell_t *cell, double yaw_rad)
{
    double s = 0.0;
    double c = 1.0;
    nav_sincos(yaw_rad, &s, &c);
    ground->dz_dx = (double) cell->plane_dz_dx;
    ground->dz_dy = (double) cell->plane_dz_dy;

    /* in (heading, right, up): forward = (1, 0, a), right = (-ab, 1 + a^2, b), both normalized */
    const double a = -((ground->dz_dx * c) + (ground->dz_dy * s));
    const double b = (ground->dz_dx * s) - (ground->dz_dy * c);
    const double forward_norm = 1.0 / sqrt(1.0 + (a * a));
    const double slant = sqrt(1.0 + (a * a) + (b * b));
    const double cos_slope = 1.0 / slant;
    const double right_norm = forward_norm * cos_slope;
    const double right_forward = -(a * b) * right_norm;
    const double right_right = (1.0 + (a * a)) * right_norm;
    ground->rise_forward = a;
    ground->rise_right = b;
    ground->forward_xy[0] = c * forward_norm;
    ground->forward_xy[1] = s * forward_norm;
    ground->right_xy[0] = (c * right_forward) - (s * right_right);
    ground->right_xy[1] = (s * right_forward) + (c * right_right);
    ground->forward_up = a * forward_norm;
    ground->right_up = b * right_norm;
    ground->cos_slope = cos_slope;

    /* the determinant of the map from (u, v) to (x, y) is cos_slope, never near 0 */
    ground->u_of_xy[0] = ground->right_xy[1] * slant;
    ground->u_of_xy[1] = -ground->right_xy[0] * slant;
    ground->v_of_xy[0] = -ground->forward_xy[1] * slant;
    ground->v_of_xy[1] = ground->forward_xy[0] * slant;
}

/** Lines along the axis that the heading crosses more steeply. */
static void place_lanes(nav_ground_t *ground)
{
    nav_lanes_t *lanes = &ground->lanes;
    const bool is_row = fabs(ground->forward_xy[0]) >= fabs(ground->forward_xy[1]);
    const uint32_t major = is_row ? 0U : 1U;
    const uint32_t minor = is_row ? 1U : 0U;
    const double cell_m = ground->surface->cell_m;

    lanes->step_major = is_row ? NAV_HEIGHTMAP_SIZE : 1;
    lanes->step_minor = is_row ? 1 : NAV_HEIGHTMAP_SIZE;
    lanes->major = is_row ? ground->row : ground->col;
    lanes->minor = is_row ? ground->col : ground->row;
    lanes->major_per_u = ground->forward_xy[major] * ground->cells_per_m;
    lanes->major_per_v = ground->right_xy[major] * ground->cells_per_m;
    lanes->minor_per_u = ground->forward_xy[minor] * ground->cells_per_m;
    lanes->minor_per_v = ground->right_xy[minor] * ground->cells_per_m;
    lanes->u_per_major = 1.0 / lanes->major_per_u;
    lanes->minor_per_major = lanes->minor_per_u * lanes->u_per_major;
    lanes->minor_across = lanes->minor_per_v - (lanes->major_per_v * lanes->minor_per_major);
    lanes->u_per_minor = -(lanes->major_per_v * lanes->u_per_major) / lanes->minor_across;
    lanes->plane_major_m = (is_row ? ground->dz_dx : ground->dz_dy) * cell_m;
    lanes->plane_minor_m = (is_row ? ground->dz_dy : ground->dz_dx) * cell_m;
    lanes->plane_first_m = ground->z_site_m - (lanes->major * lanes->plane_major_m) -
                           (lanes->minor * lanes->plane_minor_m);
}

bool nav_ground_place(nav_ground_t *ground,
                      const nav_surface_t *surface,
                      const nav_costmap_t *costmap,
                      const nav_relief_t *relief,
                      const nav_pose2_t *pose)
{
    uint32_t index = 0U;
    const bool is_inside = nav_costmap_find(costmap, pose->x_m, pose->y_m, &index);
    const nav_cost_cell_t *cell = &costmap->cells[index];
    const bool is_placed = is_inside && (cell->is_known != 0U);
    if (is_placed)
    {
        const int32_t row = (int32_t) (index / (uint32_t) NAV_COSTMAP_SIZE);
        const int32_t col = (int32_t) (index % (uint32_t) NAV_COSTMAP_SIZE);
        const double x_m = ((double) (costmap->origin_row + row) + 0.5) * costmap->cell_m;
        const double y_m = ((double) (costmap->origin_col + col) + 0.5) * costmap->cell_m;
        place_plane(ground, cell, pose->yaw_rad);
        ground->z_site_m = (double) cell->plane_z_site_m + (ground->dz_dx * (pose->x_m - x_m)) +
                           (ground->dz_dy * (pose->y_m - y_m));
        ground->surface = surface;
        ground->costmap = costmap;
        ground->relief = relief;
        ground->cells_per_m = 1.0 / surface->cell_m;
        ground->row = (pose->x_m * ground->cells_per_m) - (double) surface->origin_row - 0.5;
        ground->col = (pose->y_m * ground->cells_per_m) - (double) surface->origin_col - 0.5;
        ground->cost_row = surface->origin_row - (costmap->origin_row * SIDE);
        ground->cost_col = surface->origin_col - (costmap->origin_col * SIDE);
        ground->tile_side_m = (double) SIDE * surface->cell_m;
        ground->tile_north_m =
            ((MIDDLE - (double) ground->cost_row) - ground->row) * surface->cell_m;
        ground->tile_east_m =
            ((MIDDLE - (double) ground->cost_col) - ground->col) * surface->cell_m;
        place_lanes(ground);
    }
    return is_placed;
}

double nav_ground_eta_m(const nav_ground_t *ground, double foot_u_m, double foot_v_m)
{
    const double north_m = (ground->forward_xy[0] * foot_u_m) + (ground->right_xy[0] * foot_v_m);
    const double east_m = (ground->forward_xy[1] * foot_u_m) + (ground->right_xy[1] * foot_v_m);
    const double row = ground->row + (north_m * ground->cells_per_m) + 0.5;
    const double col = ground->col + (east_m * ground->cells_per_m) + 0.5;
    const double size = (double) NAV_HEIGHTMAP_SIZE;
    double eta_m = -NAV_ETA_NONE;
    if ((row >= 0.0) && (col >= 0.0) && (row < size) && (col < size))
    {
        const double plane_z_m =
            ground->z_site_m + (ground->dz_dx * north_m) + (ground->dz_dy * east_m);
        const int32_t cell = ((int32_t) row * NAV_HEIGHTMAP_SIZE) + (int32_t) col;
        eta_m = (plane_z_m - (double) ground->surface->z_site_m[cell]) * ground->cos_slope;
    }
    return eta_m;
}

nav_indices_t nav_ground_between(double low, double high)
{
    nav_indices_t between = {0, -1};
    if (high >= low)
    {
        (void) nav_floor_index((low + 1.0) - EDGE_CELLS, &between.first);
        (void) nav_floor_index(high + EDGE_CELLS, &between.last);
    }
    return between;
}

nav_upright_t nav_ground_upright(const nav_ground_t *ground, const nav_box_t *box)
{
    const double *f = ground->forward_xy;
    const double *r = ground->right_xy;
    const double per_m = ground->cells_per_m;
    const double row = ground->row + (((f[0] * box->u_m) + (r[0] * box->v_m)) * per_m);
    const double col = ground->col + (((f[1] * box->u_m) + (r[1] * box->v_m)) * per_m);
    const double half_row = ((fabs(f[0]) * box->half_u_m) + (fabs(r[0]) * box->half_v_m)) * per_m;
    const double half_col = ((fabs(f[1]) * box->half_u_m) + (fabs(r[1]) * box->half_v_m)) * per_m;
    const nav_upright_t upright = {{row - half_row, row + half_row},
                                   {col - half_col, col + half_col}};
    return upright;
}

/** Costmap rows (or columns) of a range of surface rows. @return false off the map */
static bool cost_indices(const nav_axis_range_t *range, int32_t cost_first, nav_indices_t *cells)
{
    const double low = range->low;
    const double high = range->high;
    bool is_inside = (low >= 0.0) && (high <= (double) (NAV_HEIGHTMAP_SIZE - 1));
    cells->first = 0;
    cells->last = -1;
    if (is_inside)
    {
        const int32_t first = (cost_first + (int32_t) (low + (1.0 - EDGE_CELLS))) / SIDE;
        const int32_t last = (cost_first + (int32_t) (high + EDGE_CELLS)) / SIDE;
        /* wholly on the surface; the surface lies wholly on the costmap */
        is_inside = ((first * SIDE) >= cost_first) &&
                    ((((last + 1) * SIDE) - cost_first) <= NAV_HEIGHTMAP_SIZE) &&
                    NAV_ALWAYS((cost_first >= 0) && (last < NAV_COSTMAP_SIZE));
        cells->first = first;
        cells->last = last;
    }
    return is_inside;
}

bool nav_ground_cost_box(const nav_ground_t *ground, const nav_box_t *box, nav_cost_box_t *cells)
{
    const nav_upright_t upright = nav_ground_upright(ground, box);
    const bool is_row_inside = cost_indices(&upright.rows, ground->cost_row, &cells->rows);
    const bool is_col_inside = cost_indices(&upright.cols, ground->cost_col, &cells->cols);
    return is_row_inside && is_col_inside;
}

double nav_ground_tile_north_m(const nav_ground_t *ground, int32_t cost_row)
{
    return ground->tile_north_m + (ground->tile_side_m * (double) cost_row);
}

double nav_ground_tile_east_m(const nav_ground_t *ground, int32_t cost_col)
{
    return ground->tile_east_m + (ground->tile_side_m * (double) cost_col);
}

nav_tile_t nav_ground_tile(
    const nav_ground_t *ground, int32_t cost_row, int32_t cost_col, double north_m, double east_m)
{
    const int32_t index = (cost_row * NAV_COSTMAP_SIZE) + cost_col;
    const nav_cost_cell_t *cell = &ground->costmap->cells[index];
    const nav_relief_cell_t *relief = &ground->relief->cells[index];
    nav_tile_t tile;
    /* from its own plane to the one under the pose: at the middle, and how they diverge from there */
    const double between_m =
        (ground->z_site_m + (ground->dz_dx * north_m) + (ground->dz_dy * east_m)) -
        (double) cell->plane_z_site_m;
    const double apart_m = MIDDLE * ground->surface->cell_m *
                           (fabs(ground->dz_dx - (double) cell->plane_dz_dx) +
                            fabs(ground->dz_dy - (double) cell->plane_dz_dy));
    tile.above.low_m = (between_m + (double) relief->below_m) - apart_m;
    tile.above.high_m = between_m + (double) relief->above_m + apart_m;
    tile.is_whole = relief->is_whole != 0U;
    return tile;
}

bool nav_ground_range(const nav_ground_t *ground, const nav_box_t *box, nav_interval_t *above)
{
    nav_cost_box_t cells;
    bool is_whole = nav_ground_cost_box(ground, box, &cells);
    above->low_m = NAV_ETA_NONE;
    above->high_m = -NAV_ETA_NONE;
    for (int32_t row = cells.rows.first; (row <= cells.rows.last) && is_whole; row++)
    {
        const double north_m = nav_ground_tile_north_m(ground, row);
        for (int32_t col = cells.cols.first; (col <= cells.cols.last) && is_whole; col++)
        {
            const nav_tile_t tile =
                nav_ground_tile(ground, row, col, north_m, nav_ground_tile_east_m(ground, col));
            above->low_m = nav_min(above->low_m, tile.above.low_m);
            above->high_m = nav_max(above->high_m, tile.above.high_m);
            is_whole = tile.is_whole;
        }
    }
    return is_whole && (above->high_m >= above->low_m);
}
