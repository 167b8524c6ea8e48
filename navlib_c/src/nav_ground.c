/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ground.c
 * @brief The surface seen from the local ground plane under one pose.
 */
#include "nav_ground.h"

#include <math.h>

#include "nav_math.h"

#define COLUMN_REACH_M 10.0
#define EDGE_CELLS 1.0e-9

/** Frame from the plane's slope and the heading. */
static void place_plane(nav_ground_t *ground, const nav_cost_cell_t *cell, double yaw_rad)
{
    const double c = nav_cos(yaw_rad);
    const double s = nav_sin(yaw_rad);
    ground->dz_dx = (double) cell->plane_dz_dx;
    ground->dz_dy = (double) cell->plane_dz_dy;

    /* in (heading, right, up): forward = (1, 0, a), right = (-ab, 1 + a^2, b), both normalized */
    const double a = -((ground->dz_dx * c) + (ground->dz_dy * s));
    const double b = (ground->dz_dx * s) - (ground->dz_dy * c);
    const double forward_norm = 1.0 / sqrt(1.0 + (a * a));
    const double cos_slope = 1.0 / sqrt(1.0 + (a * a) + (b * b));
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
    ground->u_of_xy[0] = ground->right_xy[1] / cos_slope;
    ground->u_of_xy[1] = -ground->right_xy[0] / cos_slope;
    ground->v_of_xy[0] = -ground->forward_xy[1] / cos_slope;
    ground->v_of_xy[1] = ground->forward_xy[0] / cos_slope;
}

bool nav_ground_place(nav_ground_t *ground,
                      const nav_surface_t *surface,
                      const nav_costmap_t *costmap,
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
        ground->cells_per_m = 1.0 / surface->cell_m;
        ground->row = (pose->x_m * ground->cells_per_m) - (double) surface->origin_row - 0.5;
        ground->col = (pose->y_m * ground->cells_per_m) - (double) surface->origin_col - 0.5;
    }
    return is_placed;
}

/** Whole numbers within [low, high]. */
static nav_columns_t whole_between(double low, double high)
{
    nav_columns_t between = {0, -1};
    if (high >= low)
    {
        (void) nav_floor_index((low + 1.0) - EDGE_CELLS, &between.first);
        (void) nav_floor_index(high + EDGE_CELLS, &between.last);
    }
    return between;
}

nav_columns_t nav_ground_rows(const nav_ground_t *ground, const nav_box_t *box)
{
    const double middle_m = (ground->forward_xy[0] * box->u_m) + (ground->right_xy[0] * box->v_m);
    const double half_m =
        (fabs(ground->forward_xy[0]) * box->half_u_m) + (fabs(ground->right_xy[0]) * box->half_v_m);
    return whole_between(ground->row + ((middle_m - half_m) * ground->cells_per_m),
                         ground->row + ((middle_m + half_m) * ground->cells_per_m));
}

/** Part of a row between two parallel sides of the box. */
static void cut_row(double slope, double middle_m, double half_m, double *low_m, double *high_m)
{
    if (fabs(slope) > 1.0e-9)
    {
        const double at_m = middle_m / slope;
        const double reach_m = fabs(half_m / slope);
        *low_m = nav_max(*low_m, at_m - reach_m);
        *high_m = nav_min(*high_m, at_m + reach_m);
    }
    else if (fabs(middle_m) > half_m)
    {
        *high_m = *low_m - 1.0;
    }
    else
    {
        /* the whole row lies between these two sides */
    }
}

nav_columns_t nav_ground_columns(const nav_ground_t *ground,
                                 const nav_box_t *box,
                                 int32_t row,
                                 uint32_t *outside_count)
{
    const double dx_m = ((double) row - ground->row) * ground->surface->cell_m;
    double low_m = -COLUMN_REACH_M;
    double high_m = COLUMN_REACH_M;
    cut_row(ground->u_of_xy[1], box->u_m - (ground->u_of_xy[0] * dx_m), box->half_u_m, &low_m,
            &high_m);
    cut_row(ground->v_of_xy[1], box->v_m - (ground->v_of_xy[0] * dx_m), box->half_v_m, &low_m,
            &high_m);

    nav_columns_t columns = whole_between(ground->col + (low_m * ground->cells_per_m),
                                          ground->col + (high_m * ground->cells_per_m));
    const int32_t count = (columns.last - columns.first) + 1;
    const bool is_row_inside = (row >= 0) && (row < NAV_HEIGHTMAP_SIZE);
    columns.first = (columns.first < 0) ? 0 : columns.first;
    columns.last = (columns.last < NAV_HEIGHTMAP_SIZE) ? columns.last : (NAV_HEIGHTMAP_SIZE - 1);
    columns.last = is_row_inside ? columns.last : (columns.first - 1);
    const int32_t left = (columns.last >= columns.first) ? ((columns.last - columns.first) + 1) : 0;
    *outside_count += (count > left) ? (uint32_t) (count - left) : 0U;
    return columns;
}

bool nav_ground_cell(const nav_ground_t *ground,
                     int32_t row,
                     int32_t col,
                     nav_ground_point_t *point)
{
    const float z = ground->surface->z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col];
    const bool is_known = z < NAV_SURFACE_UNKNOWN_M;
    if (is_known)
    {
        const double dx_m = ((double) row - ground->row) * ground->surface->cell_m;
        const double dy_m = ((double) col - ground->col) * ground->surface->cell_m;
        const double above_m =
            (ground->z_site_m + (ground->dz_dx * dx_m) + (ground->dz_dy * dy_m)) - (double) z;
        point->u_m = (ground->u_of_xy[0] * dx_m) + (ground->u_of_xy[1] * dy_m) +
                     (above_m * ground->forward_up);
        point->v_m = (ground->v_of_xy[0] * dx_m) + (ground->v_of_xy[1] * dy_m) +
                     (above_m * ground->right_up);
        point->eta_m = above_m * ground->cos_slope;
    }
    return is_known;
}

/** Bilinear z between four cells. @return false when one is unknown */
static bool surface_z_m(const nav_surface_t *surface, double row, double col, double *z_m)
{
    const int32_t row_0 = (int32_t) row;
    const int32_t col_0 = (int32_t) col;
    const double north = row - (double) row_0;
    const double east = col - (double) col_0;
    const float *south_cells = &surface->z_site_m[(row_0 * NAV_HEIGHTMAP_SIZE) + col_0];
    const float *north_cells = &south_cells[NAV_HEIGHTMAP_SIZE];
    const bool is_known =
        (south_cells[0] < NAV_SURFACE_UNKNOWN_M) && (south_cells[1] < NAV_SURFACE_UNKNOWN_M) &&
        (north_cells[0] < NAV_SURFACE_UNKNOWN_M) && (north_cells[1] < NAV_SURFACE_UNKNOWN_M);
    const double south_z_m =
        (double) south_cells[0] + (east * ((double) south_cells[1] - (double) south_cells[0]));
    const double north_z_m =
        (double) north_cells[0] + (east * ((double) north_cells[1] - (double) north_cells[0]));
    *z_m = south_z_m + (north * (north_z_m - south_z_m));
    return is_known;
}

double nav_ground_eta_m(const nav_ground_t *ground, double foot_u_m, double foot_v_m)
{
    const double last = (double) (NAV_HEIGHTMAP_SIZE - 1);
    const double dx_m = (ground->forward_xy[0] * foot_u_m) + (ground->right_xy[0] * foot_v_m);
    const double dy_m = (ground->forward_xy[1] * foot_u_m) + (ground->right_xy[1] * foot_v_m);
    const double row = ground->row + (dx_m * ground->cells_per_m);
    const double col = ground->col + (dy_m * ground->cells_per_m);
    double eta_m = -NAV_ETA_NONE;
    double z_m = 0.0;

    if ((row >= 0.0) && (col >= 0.0) && (row < last) && (col < last) &&
        surface_z_m(ground->surface, row, col, &z_m))
    {
        const double plane_z_m = ground->z_site_m + (ground->dz_dx * dx_m) + (ground->dz_dy * dy_m);
        eta_m = (plane_z_m - z_m) * ground->cos_slope;
    }
    return eta_m;
}

void nav_ground_crossings(const nav_ground_t *ground,
                          uint32_t axis,
                          double foot_u_m,
                          double foot_v_m,
                          double reach_m,
                          nav_crossings_t *crossings)
{
    const double origin = (axis == NAV_GROUND_ROWS) ? ground->row : ground->col;
    const double per_u = ground->forward_xy[axis] * ground->cells_per_m;
    const double per_v = ground->right_xy[axis] * ground->cells_per_m;
    const double middle = origin + (per_u * foot_u_m) + (per_v * foot_v_m);
    const double half = fabs(per_u) * reach_m;

    crossings->count = 0U;
    if (fabs(per_u) > 1.0e-6)
    {
        const nav_columns_t lines = whole_between(middle - half, middle + half);
        for (int32_t line = lines.first;
             (line <= lines.last) && (crossings->count < (uint32_t) NAV_CROSSINGS_MAX); line++)
        {
            const double u_m = foot_u_m + (((double) line - middle) / per_u);
            const double eta_m = nav_ground_eta_m(ground, u_m, foot_v_m);
            if (eta_m > (-0.5 * NAV_ETA_NONE))
            {
                crossings->foot_u_m[crossings->count] = u_m;
                crossings->eta_m[crossings->count] = eta_m;
                crossings->count++;
            }
        }
    }
}
