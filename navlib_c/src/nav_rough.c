/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_rough.c
 * @brief How high a wheel can stand, cheaply.
 */
#include "nav_rough.h"

#include <math.h>

#include "nav_minmax.h"

/* Heights are trusted where they are this near to what was expected: on a slope they move the feet. */
#define REACH_M 0.3

/** Rows or columns of the cells around a range of places. @return false where some are off the map */
static bool cells_around(double middle, double half, nav_indices_t *cells)
{
    const double low = middle - half;
    const double high = middle + half;
    const bool is_inside = (low >= 0.0) && (high < (double) (NAV_HEIGHTMAP_SIZE - 1));
    cells->first = is_inside ? (int32_t) low : 0;
    cells->last = is_inside ? ((int32_t) high + 1) : -1;
    return is_inside;
}

/** The cells around a box of feet. */
typedef struct
{
    nav_indices_t rows;
    nav_indices_t cols;
    double plane_m;   /* z of the plane at the first of them, */
    double per_row_m; /* from row to row, */
    double per_col_m; /* and from column to column */
} patch_t;

/** @return false where some of them are off the map */
static bool patch_around(const nav_ground_t *ground, const nav_box_t *feet, patch_t *patch)
{
    const double *f = ground->forward_xy;
    const double *r = ground->right_xy;
    const double per_m = ground->cells_per_m;
    const double row = ground->row + (((f[0] * feet->u_m) + (r[0] * feet->v_m)) * per_m);
    const double col = ground->col + (((f[1] * feet->u_m) + (r[1] * feet->v_m)) * per_m);
    const double half_row = ((fabs(f[0]) * feet->half_u_m) + (fabs(r[0]) * feet->half_v_m)) * per_m;
    const double half_col = ((fabs(f[1]) * feet->half_u_m) + (fabs(r[1]) * feet->half_v_m)) * per_m;
    const bool is_row_inside = cells_around(row, half_row, &patch->rows);
    const bool is_col_inside = cells_around(col, half_col, &patch->cols);
    patch->per_row_m = ground->dz_dx * ground->surface->cell_m;
    patch->per_col_m = ground->dz_dy * ground->surface->cell_m;
    patch->plane_m = ground->z_site_m +
                     (patch->per_row_m * ((double) patch->rows.first - ground->row)) +
                     (patch->per_col_m * ((double) patch->cols.first - ground->col));
    return is_row_inside && is_col_inside;
}

/** The least that the plane is above a grid in a patch, vertically. */
static double least_under_m(const patch_t *patch, const float z_site_m[NAV_HEIGHTMAP_CELLS])
{
    double least_m = NAV_ETA_NONE;
    double row_plane_m = patch->plane_m;
    for (int32_t row = patch->rows.first; row <= patch->rows.last; row++)
    {
        const float *z_m = &z_site_m[row * NAV_HEIGHTMAP_SIZE];
        double plane_m = row_plane_m;
        for (int32_t col = patch->cols.first; col <= patch->cols.last; col++)
        {
            least_m = nav_min(plane_m - (double) z_m[col], least_m);
            plane_m += patch->per_col_m;
        }
        row_plane_m += patch->per_row_m;
    }
    return least_m;
}

/** The most that the plane is above a grid in a patch, vertically. */
static double most_under_m(const patch_t *patch, const float z_site_m[NAV_HEIGHTMAP_CELLS])
{
    double most_m = -NAV_ETA_NONE;
    double row_plane_m = patch->plane_m;
    for (int32_t row = patch->rows.first; row <= patch->rows.last; row++)
    {
        const float *z_m = &z_site_m[row * NAV_HEIGHTMAP_SIZE];
        double plane_m = row_plane_m;
        for (int32_t col = patch->cols.first; col <= patch->cols.last; col++)
        {
            most_m = nav_max(plane_m - (double) z_m[col], most_m);
            plane_m += patch->per_col_m;
        }
        row_plane_m += patch->per_row_m;
    }
    return most_m;
}

/** The feet of what stands at a height over the plane, give or take REACH_M. */
static nav_box_t feet_of(const nav_ground_t *ground, const nav_box_t *places, double height_m)
{
    const double above_m = height_m / ground->cos_slope;
    const double reach_m = REACH_M / ground->cos_slope;
    const nav_box_t feet = {places->u_m - (above_m * ground->forward_up),
                            places->v_m - (above_m * ground->right_up),
                            places->half_u_m + (reach_m * fabs(ground->forward_up)),
                            places->half_v_m + (reach_m * fabs(ground->right_up))};
    return feet;
}

nav_interval_t nav_rough_interval(const nav_ground_t *ground,
                                  const nav_box_t *places,
                                  double height_m,
                                  double lean_rad,
                                  double radius_m)
{
    const nav_box_t under = feet_of(ground, places, height_m);
    nav_box_t hubs = feet_of(ground, places, height_m + radius_m);
    /* the hub of a wheel that leans is beside its lowest point */
    hubs.half_v_m += radius_m * lean_rad;
    patch_t below;
    patch_t around;
    nav_interval_t height = {-NAV_ETA_NONE, NAV_ETA_NONE};
    if (patch_around(ground, &under, &below) && patch_around(ground, &hubs, &around))
    {
        const double low_m = least_under_m(&below, ground->surface->z_site_m);
        const double high_m = most_under_m(&around, ground->relief->rest_z_site_m);
        height.low_m = low_m * ground->cos_slope;
        height.high_m = ((high_m + radius_m) * ground->cos_slope) - radius_m;
    }
    if ((height.low_m < (height_m - REACH_M)) || (height.high_m > (height_m + REACH_M)))
    {
        height.low_m = -NAV_ETA_NONE;
        height.high_m = NAV_ETA_NONE;
    }
    return height;
}
