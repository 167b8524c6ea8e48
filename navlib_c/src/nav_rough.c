/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_rough.c
 * @brief How high a wheel can stand, cheaply.
 *
 * A point of the bilinear surface is a mean of the four cells around it, and its place the same mean of
 * theirs. The mean of a parabola over four places differs from the parabola at their mean by its curvature
 * times their variance. So cells may be taken one by one, each less what a parabola has fallen from the
 * wheel's places to it, and the highest of them is, but for that, not below any point of the surface less
 * the same: fore and aft the parabola is one around the disc; beside the places one keeps out what is not
 * under the wheel.
 */
#include "nav_rough.h"

#include <math.h>

#include "nav_minmax.h"

/* Heights are trusted where they are this near to what was expected: on a slope they move the feet. */
#define REACH_M 0.3

/* The parabolas beside the places, for the highest ground, and around them, for the lowest: per square
 * of the distance. Steeper ones keep out more of what is near, but lose more between cells. */
#define FALL_PER_M 3.0
#define RISE_PER_M 0.4

/* Of numbers of a few metres in single precision. */
#define ROUNDING_M 4.0e-6

/* Cells done in one go. The loops over the columns of a batch have this fixed length and no branches, so
 * that compilers turn them into instructions for several numbers at once. */
#define BATCH_ROWS 2
#define BATCH_COLS 4

/** Cells around all ground that a wheel can touch, a batch at least. */
typedef struct
{
    nav_indices_t rows;
    nav_indices_t cols;
} window_t;

/** A number that changes evenly over the grid. */
typedef struct
{
    float at[BATCH_COLS]; /* in the first row and columns of a window */
    float per_row;
    float per_col;
} ramp_t;

/** A wheel over the cells of a window. */
typedef struct
{
    ramp_t plane_m; /* z of the plane less level_m */
    ramp_t u_m;     /* feet of the cells from the middle of the places */
    ramp_t v_m;
    float level_m;
    float forward_up;
    float right_up;
    float cos_slope;
    float half_u_m;
    float half_v_m;
    /* per square of twice the distance, 1/m: */
    float fall_u_per_m;
    float fall_v_per_m;
    float rise_per_m;
} view_t;

/** Numbers of the row of a batch, to be added to those of its columns. */
typedef struct
{
    float plane_m;
    float u_m;
    float v_m;
} offset_t;

/** Extremes of what batches hold, column by column. */
typedef struct
{
    float high_m[BATCH_COLS]; /* along the normal, less what they fall to the places */
    float low_m[BATCH_COLS];  /* and what they rise */
    float top_m[BATCH_COLS];  /* vertical, as they are */
    float bottom_m[BATCH_COLS];
} extremes_t;

/** Twice a distance, 0 where it is negative. */
static float twice_beyond(float distance_m)
{
    return distance_m + fabsf(distance_m);
}

/** Rows or columns around a range of places, a batch of them at least. @return false where some are off the
 * map */
static bool cells_around(const nav_axis_range_t *range, int32_t batch, nav_indices_t *cells)
{
    const double low = range->low;
    const double high = range->high;
    const bool is_inside = (low >= 0.0) && (high < (double) (NAV_HEIGHTMAP_SIZE - 1));
    const int32_t first = is_inside ? (int32_t) low : 0;
    const int32_t last = is_inside ? ((int32_t) high + 1) : 0;
    const int32_t first_max = NAV_HEIGHTMAP_SIZE - batch;
    cells->first = (first < first_max) ? first : first_max;
    const int32_t last_min = (cells->first + batch) - 1;
    cells->last = (last > last_min) ? last : last_min;
    return is_inside;
}

/** @return false where some of them are off the map */
static bool window_around(const nav_ground_t *ground, const nav_box_t *feet, window_t *window)
{
    const nav_upright_t upright = nav_ground_upright(ground, feet);
    const bool is_row_inside = cells_around(&upright.rows, BATCH_ROWS, &window->rows);
    const bool is_col_inside = cells_around(&upright.cols, BATCH_COLS, &window->cols);
    return is_row_inside && is_col_inside;
}

/** The feet of the ground that a wheel can touch at a height, give or take REACH_M: ground from there up to
 * its hub. */
static nav_box_t feet_of(const nav_ground_t *ground,
                         const nav_box_t *places,
                         double height_m,
                         double radius_m)
{
    const double above_m = (height_m + (0.5 * radius_m)) / ground->cos_slope;
    const double reach_m = (REACH_M + (0.5 * radius_m)) / ground->cos_slope;
    const nav_box_t feet = {places->u_m - (above_m * ground->forward_up),
                            places->v_m - (above_m * ground->right_up),
                            places->half_u_m + radius_m + (reach_m * fabs(ground->forward_up)),
                            places->half_v_m + (reach_m * fabs(ground->right_up))};
    return feet;
}

static ramp_t ramp_of(double first, double per_row, double per_col)
{
    ramp_t ramp = {{0.0F}, (float) per_row, (float) per_col};
    for (int32_t k = 0; k < BATCH_COLS; k++)
    {
        ramp.at[k] = (float) (first + (per_col * (double) k));
    }
    return ramp;
}

static view_t view_of(const nav_ground_t *ground,
                      const nav_box_t *places,
                      const window_t *window,
                      double radius_m)
{
    const double cell_m = ground->surface->cell_m;
    const double north_m = ((double) window->rows.first - ground->row) * cell_m;
    const double east_m = ((double) window->cols.first - ground->col) * cell_m;
    const double plane_m = ground->z_site_m + (ground->dz_dx * north_m) + (ground->dz_dy * east_m);
    const double *u = ground->u_of_xy;
    const double *v = ground->v_of_xy;
    const float level_m = (float) ground->z_site_m;
    const view_t view = {
        ramp_of(plane_m - (double) level_m, ground->dz_dx * cell_m, ground->dz_dy * cell_m),
        ramp_of(((u[0] * north_m) + (u[1] * east_m)) - places->u_m, u[0] * cell_m, u[1] * cell_m),
        ramp_of(((v[0] * north_m) + (v[1] * east_m)) - places->v_m, v[0] * cell_m, v[1] * cell_m),
        level_m,
        (float) ground->forward_up,
        (float) ground->right_up,
        (float) ground->cos_slope,
        (float) places->half_u_m,
        (float) places->half_v_m,
        (float) (0.125 / radius_m),
        (float) (0.25 * FALL_PER_M),
        (float) (0.25 * RISE_PER_M),
    };
    return view;
}

/** Takes one cell, of a column of a batch. */
static inline void take_cell(
    const view_t *view, int32_t k, float z_site_m, const offset_t *offset, extremes_t *extremes)
{
    const float above_m = (view->plane_m.at[k] + offset->plane_m) - (z_site_m - view->level_m);
    const float eta_m = above_m * view->cos_slope;
    const float u_m = (view->u_m.at[k] + offset->u_m) + (above_m * view->forward_up);
    const float v_m = (view->v_m.at[k] + offset->v_m) + (above_m * view->right_up);
    const float off_u_m = twice_beyond(fabsf(u_m) - view->half_u_m);
    const float off_v_m = twice_beyond(fabsf(v_m) - view->half_v_m);
    const float u_m2 = off_u_m * off_u_m;
    const float v_m2 = off_v_m * off_v_m;
    const float fall_m = (u_m2 * view->fall_u_per_m) + (v_m2 * view->fall_v_per_m);
    const float rise_m = (u_m2 + v_m2) * view->rise_per_m;
    extremes->high_m[k] = nav_max_f(extremes->high_m[k], eta_m - fall_m);
    extremes->low_m[k] = nav_min_f(extremes->low_m[k], eta_m + rise_m);
    extremes->top_m[k] = nav_max_f(extremes->top_m[k], above_m);
    extremes->bottom_m[k] = nav_min_f(extremes->bottom_m[k], above_m);
}

/** Takes a batch of cells, given its first cell and what to add to the first of all. */
static void take_batch(const view_t *view,
                       const float *z_site_m,
                       const offset_t *offset,
                       extremes_t *extremes)
{
    const offset_t next = {offset->plane_m + view->plane_m.per_row, offset->u_m + view->u_m.per_row,
                           offset->v_m + view->v_m.per_row};
    for (int32_t k = 0; k < BATCH_COLS; k++)
    {
        take_cell(view, k, z_site_m[k], offset, extremes);
        take_cell(view, k, z_site_m[NAV_HEIGHTMAP_SIZE + k], &next, extremes);
    }
}

/** What to add in a batch, given how many rows and columns it is from the first. */
static float offset_of(const ramp_t *ramp, int32_t rows, int32_t cols)
{
    return ((float) rows * ramp->per_row) + ((float) cols * ramp->per_col);
}

static extremes_t extremes_of(const nav_ground_t *ground,
                              const view_t *view,
                              const window_t *window)
{
    const float none_m = (float) NAV_ETA_NONE;
    const int32_t row_max = window->rows.last - (BATCH_ROWS - 1);
    const int32_t col_max = window->cols.last - (BATCH_COLS - 1);
    extremes_t extremes;
    for (int32_t k = 0; k < BATCH_COLS; k++)
    {
        extremes.high_m[k] = -none_m;
        extremes.low_m[k] = none_m;
        extremes.top_m[k] = -none_m;
        extremes.bottom_m[k] = none_m;
    }
    /* the last batch ends where the window does, even if it has some of the one before */
    for (int32_t row = window->rows.first; row <= window->rows.last; row += BATCH_ROWS)
    {
        const int32_t at_row = (row < row_max) ? row : row_max;
        const float *z_site_m = &ground->surface->z_site_m[at_row * NAV_HEIGHTMAP_SIZE];
        const int32_t rows = at_row - window->rows.first;
        for (int32_t col = window->cols.first; col <= window->cols.last; col += BATCH_COLS)
        {
            const int32_t at_col = (col < col_max) ? col : col_max;
            const int32_t cols = at_col - window->cols.first;
            const offset_t offset = {offset_of(&view->plane_m, rows, cols),
                                     offset_of(&view->u_m, rows, cols),
                                     offset_of(&view->v_m, rows, cols)};
            take_batch(view, &z_site_m[at_col], &offset, &extremes);
        }
    }
    return extremes;
}

/** Variance at most of the places of four cells along an axis of the plane. */
static double variance_m2(const nav_ground_t *ground, double up, double span_m)
{
    const double apart_m = (ground->surface->cell_m / ground->cos_slope) + (fabs(up) * span_m);
    return 0.25 * apart_m * apart_m;
}

/** Heights of a wheel, given the extremes of the cells around. */
static nav_interval_t interval_of(const nav_ground_t *ground,
                                  const extremes_t *extremes,
                                  double radius_m)
{
    float high_m = extremes->high_m[0];
    float low_m = extremes->low_m[0];
    float top_m = extremes->top_m[0];
    float bottom_m = extremes->bottom_m[0];
    for (int32_t k = 1; k < BATCH_COLS; k++)
    {
        high_m = nav_max_f(high_m, extremes->high_m[k]);
        low_m = nav_min_f(low_m, extremes->low_m[k]);
        top_m = nav_max_f(top_m, extremes->top_m[k]);
        bottom_m = nav_min_f(bottom_m, extremes->bottom_m[k]);
    }
    const double span_m = (double) top_m - (double) bottom_m;
    const double u_m2 = variance_m2(ground, ground->forward_up, span_m);
    const double v_m2 = variance_m2(ground, ground->right_up, span_m);
    const nav_interval_t height = {
        (double) low_m - ((RISE_PER_M * (u_m2 + v_m2)) + ROUNDING_M),
        (double) high_m + ((0.5 / radius_m) * u_m2) + (FALL_PER_M * v_m2) + ROUNDING_M,
    };
    return height;
}

nav_interval_t nav_rough_interval(const nav_ground_t *ground,
                                  const nav_box_t *places,
                                  double height_m,
                                  double radius_m)
{
    const nav_box_t feet = feet_of(ground, places, height_m, radius_m);
    window_t window;
    nav_interval_t height = {-NAV_ETA_NONE, NAV_ETA_NONE};
    if (window_around(ground, &feet, &window))
    {
        const view_t view = view_of(ground, places, &window, radius_m);
        const extremes_t extremes = extremes_of(ground, &view, &window);
        height = interval_of(ground, &extremes, radius_m);
    }
    if ((height.low_m < (height_m - REACH_M)) || (height.high_m > (height_m + REACH_M)))
    {
        height.low_m = -NAV_ETA_NONE;
        height.high_m = NAV_ETA_NONE;
    }
    return height;
}
