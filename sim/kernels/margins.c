/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file margins.c
 * @brief Clearance and wheel drop: extremes over the terrain nodes in boxes of the body frame.
 */
#include "margins.h"

#include <math.h>
#include <stddef.h>

/* steeper than any rover stands, and where a box seen from above would have no bounds */
#define COSINE_TILT_MIN 0.1
/* a side of a box this close to a row of nodes does not cut it */
#define CUT_MIN 1e-9
/* rounding of a cut, in nodes */
#define CUT_SLACK 1e-6

/* a box in the body frame, and the SITE unit vector along which depth is measured */
typedef struct
{
    double low[3];
    double high[3];
    double down[3];
} box_t;

typedef struct
{
    double low;
    double high;
} range_t;

/* two opposite sides of a box over the nodes of a row: those within half_m of the middle */
typedef struct
{
    double shift_per_north;
    double shift_m;
    double half_m;
} cut_t;

static inline int is_in_box(const box_t *box, double x, double y)
{
    return (x >= box->low[0]) && (x <= box->high[0]) && (y >= box->low[1]) && (y <= box->high[1]);
}

static inline double middle_of(const box_t *box, int axis)
{
    return 0.5 * (box->low[axis] + box->high[axis]);
}

static inline double half_of(const box_t *box, int axis)
{
    return 0.5 * (box->high[axis] - box->low[axis]);
}

static inline double smaller(double a, double b)
{
    return (a < b) ? a : b;
}

static inline double larger(double a, double b)
{
    return (a > b) ? a : b;
}

static int32_t clamp_index(double value, int32_t count)
{
    return (value < 0.0) ? 0 : ((value > (double) (count - 1)) ? count - 1 : (int32_t) value);
}

/* rows of nodes that can hold some of the box */
static void box_rows(const sim_terrain_t *terrain,
                     const linkage_t *linkage,
                     const box_t *box,
                     int32_t *first,
                     int32_t *last)
{
    const double along[3] = {linkage->ex[0], linkage->ey[0], linkage->ez[0]};
    double middle_m = 0.0;
    double reach_m = 0.0;
    for (int axis = 0; axis < 3; axis++)
    {
        middle_m += along[axis] * middle_of(box, axis);
        reach_m += fabs(along[axis]) * half_of(box, axis);
    }
    const double from_m = linkage->origin_m[0] - terrain->north_min_m + middle_m;
    *first =
        clamp_index(((from_m - reach_m) / terrain->resolution_m) + 1.0 - CUT_SLACK, terrain->rows);
    *last = clamp_index(((from_m + reach_m) / terrain->resolution_m) + CUT_SLACK, terrain->rows);
}

/*
 * Where the sides across one body axis cut a row. A point at that body coordinate w and body z lies
 * at  w = a north + b east + c z  around the origin.
 */
static cut_t cut_of(const linkage_t *linkage, const double *axis, const box_t *box, int side)
{
    const double c = axis[2] / larger(linkage->ez[2], COSINE_TILT_MIN);
    const double a = axis[0] - (c * linkage->ez[0]);
    const double b = axis[1] - (c * linkage->ez[1]);
    if (!(fabs(b) > CUT_MIN))
    {
        return (cut_t){0.0, 0.0, INFINITY};
    }
    return (cut_t){-a / b, (middle_of(box, side) - (c * middle_of(box, 2))) / b,
                   (half_of(box, side) + (fabs(c) * half_of(box, 2))) / fabs(b)};
}

/*
 * Widens a span to the depths under the rover origin of all terrain nodes inside the box; NaN when a
 * node without ground lies in it, taken at the height of the origin.
 */
static range_t span_in_box(const sim_terrain_t *terrain,
                           const linkage_t *linkage,
                           const box_t *box,
                           range_t span)
{
    const double *ex = linkage->ex;
    const double *ey = linkage->ey;
    const double step_m = terrain->resolution_m;
    const double per_m = 1.0 / step_m;
    const double first_east_m = terrain->east_min_m - linkage->origin_m[1];
    const double z_origin_m = linkage->origin_m[2];
    const double depth_step = box->down[1] * step_m;
    const cut_t cut_x = cut_of(linkage, ex, box, 0);
    const cut_t cut_y = cut_of(linkage, ey, box, 1);
    int has_hole = 0;
    int32_t row;
    int32_t last_row;
    box_rows(terrain, linkage, box, &row, &last_row);
    for (; row <= last_row; row++)
    {
        const double north_m =
            terrain->north_min_m + ((double) row * step_m) - linkage->origin_m[0];
        const double x_m = (cut_x.shift_per_north * north_m) + cut_x.shift_m - first_east_m;
        const double y_m = (cut_y.shift_per_north * north_m) + cut_y.shift_m - first_east_m;
        const double west_m = larger(x_m - cut_x.half_m, y_m - cut_y.half_m);
        const double east_m = smaller(x_m + cut_x.half_m, y_m + cut_y.half_m);
        if (!(west_m <= east_m))
        {
            continue;
        }
        const int32_t first = clamp_index((west_m * per_m) + 1.0 - CUT_SLACK, terrain->cols);
        const int32_t last = clamp_index((east_m * per_m) + CUT_SLACK, terrain->cols);
        const float *z_site_m = &terrain->z_site_m[(ptrdiff_t) row * terrain->cols];
        double depth_at_zero = (box->down[0] * north_m) + (box->down[1] * first_east_m) -
                               (box->down[2] * z_origin_m) + ((double) first * depth_step);
        for (int32_t col = first; col <= last; col++)
        {
            const double depth = depth_at_zero + (box->down[2] * (double) z_site_m[col]);
            depth_at_zero += depth_step;
            /* most nodes change nothing; NaN does */
            if ((depth >= span.low) && (depth <= span.high))
            {
                continue;
            }
            const double z_m = (double) z_site_m[col] - z_origin_m;
            const double place_east_m = first_east_m + ((double) col * step_m);
            const int is_hole = isnan(z_m);
            const double height_m = is_hole ? 0.0 : z_m;
            const double x = (ex[0] * north_m) + (ex[1] * place_east_m) + (ex[2] * height_m);
            const double y = (ey[0] * north_m) + (ey[1] * place_east_m) + (ey[2] * height_m);
            if (!is_in_box(box, x, y))
            {
                continue;
            }
            has_hole |= is_hole;
            span.low = (depth < span.low) ? depth : span.low;
            span.high = (depth > span.high) ? depth : span.high;
        }
    }
    return has_hole ? (range_t){NAN, NAN} : span;
}

/* unit vector down across the slope of the ground around a place, NaN where there is none */
static void ground_normal(const sim_terrain_t *terrain, const double *place_m, double *down)
{
    const double row = (place_m[0] - terrain->slope_north_min_m) / terrain->slope_cell_m;
    const double col = (place_m[1] - terrain->slope_east_min_m) / terrain->slope_cell_m;
    double gradient[2] = {NAN, NAN};
    if ((terrain->slope != NULL) && (row >= 0.0) && (col >= 0.0) &&
        (row < (double) terrain->slope_rows) && (col < (double) terrain->slope_cols))
    {
        const ptrdiff_t cell = ((ptrdiff_t) row * terrain->slope_cols) + (ptrdiff_t) col;
        gradient[0] = (double) terrain->slope[2 * cell];
        gradient[1] = (double) terrain->slope[(2 * cell) + 1];
    }
    const double norm = sqrt(1.0 + (gradient[0] * gradient[0]) + (gradient[1] * gradient[1]));
    down[0] = -gradient[0] / norm;
    down[1] = -gradient[1] / norm;
    down[2] = 1.0 / norm;
}

double clearance_of(const sim_terrain_t *terrain,
                    const sim_vehicle_t *vehicle,
                    const linkage_t *linkage)
{
    /* ground further than this from the frame's origin plane cannot be under a standing rover */
    const box_t belly = {
        {vehicle->belly_rear_m, -vehicle->belly_half_width_m, vehicle->belly_z_m - 1.0},
        {vehicle->belly_front_m, vehicle->belly_half_width_m, 0.7},
        {linkage->ez[0], linkage->ez[1], linkage->ez[2]}};
    /* nothing is too deep */
    const range_t above = {INFINITY, INFINITY};
    return span_in_box(terrain, linkage, &belly, above).low - vehicle->belly_z_m;
}

double wheel_drop_of(const sim_terrain_t *terrain,
                     const sim_vehicle_t *vehicle,
                     const linkage_t *linkage)
{
    const double half_length_m = vehicle->wheel_radius_m;
    const double half_width_m = 0.5 * vehicle->wheel_width_m;
    const range_t nothing = {INFINITY, -INFINITY};
    double down[3];
    ground_normal(terrain, linkage->origin_m, down);
    double largest_m = 0.0 * down[2]; /* NaN without a slope */
    for (int wheel = 0; (wheel < SIM_WHEEL_COUNT) && !isnan(largest_m); wheel++)
    {
        const double *hub_m = linkage->hub_body_m[wheel];
        const box_t box = {{hub_m[0] - half_length_m, hub_m[1] - half_width_m, hub_m[2] - 0.7},
                           {hub_m[0] + half_length_m, hub_m[1] + half_width_m, hub_m[2] + 1.3},
                           {down[0], down[1], down[2]}};
        const range_t span = span_in_box(terrain, linkage, &box, nothing);
        /* a box between coarse nodes holds none and has no drop; one with a hole has no known one */
        const double drop_m = (span.high < span.low) ? 0.0 : span.high - span.low;
        largest_m = ((drop_m > largest_m) || isnan(drop_m)) ? drop_m : largest_m;
    }
    return largest_m;
}
