/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_kioz.c
 * @brief Exact distances to keep-in and keep-out zones.
 */
#include "nav_kioz.h"

#include <math.h>
#include <string.h>

#include "nav_math.h"
#include "nav_minmax.h"

/* Least side, radius or triangle height, m. */
#define NAV_ZONE_SIDE_MIN_M 0.01

#define NAV_ZONE_CORNERS 3U
#define NAV_ZONE_LENGTHS 11U

static double square(double x)
{
    return x * x;
}

static double length_of(double x, double y)
{
    return sqrt(square(x) + square(y));
}

/* twice the area of a triangle, positive when its corners run from north to east */
static double cross_of_corners(const nav_zone_t *zone)
{
    const double ax = zone->vertex_x_site_m[1] - zone->vertex_x_site_m[0];
    const double ay = zone->vertex_y_site_m[1] - zone->vertex_y_site_m[0];
    const double bx = zone->vertex_x_site_m[2] - zone->vertex_x_site_m[0];
    const double by = zone->vertex_y_site_m[2] - zone->vertex_y_site_m[0];

    return (ax * by) - (ay * bx);
}

static double longest_side_m(const nav_zone_t *zone)
{
    double longest_m = 0.0;

    for (uint32_t corner = 0U; corner < NAV_ZONE_CORNERS; corner++)
    {
        const uint32_t next = (corner + 1U) % NAV_ZONE_CORNERS;

        longest_m = nav_max(longest_m,
                            length_of(zone->vertex_x_site_m[next] - zone->vertex_x_site_m[corner],
                                      zone->vertex_y_site_m[next] - zone->vertex_y_site_m[corner]));
    }
    return longest_m;
}

static bool is_wide_enough(const nav_zone_t *zone)
{
    double side_m = 0.0;
    bool is_enough = false;

    switch (zone->shape)
    {
    case NAV_ZONE_CIRCLE:
        is_enough = zone->radius_m >= NAV_ZONE_SIDE_MIN_M;
        break;
    case NAV_ZONE_RECTANGLE:
        is_enough =
            (zone->length_m >= NAV_ZONE_SIDE_MIN_M) && (zone->width_m >= NAV_ZONE_SIDE_MIN_M);
        break;
    case NAV_ZONE_TRIANGLE:
        /* the least height stands on the longest side */
        side_m = longest_side_m(zone);
        is_enough = (side_m >= NAV_ZONE_SIDE_MIN_M) &&
                    ((fabs(cross_of_corners(zone)) / side_m) >= NAV_ZONE_SIDE_MIN_M);
        break;
    default:
        is_enough = false;
        break;
    }
    return is_enough;
}

static double distance_to_rectangle_m(const nav_zone_t *zone, double dx, double dy)
{
    const double c = nav_cos(zone->heading_rad);
    const double s = nav_sin(zone->heading_rad);
    const double ahead = fabs((dx * c) + (dy * s)) - (zone->length_m / 2.0);
    const double aside = fabs((dy * c) - (dx * s)) - (zone->width_m / 2.0);
    const double outside_m = length_of(nav_max(ahead, 0.0), nav_max(aside, 0.0));

    return outside_m + nav_min(nav_max(ahead, aside), 0.0);
}

static double distance_to_triangle_m(const nav_zone_t *zone, double x_site_m, double y_site_m)
{
    const double sense = (cross_of_corners(zone) < 0.0) ? -1.0 : 1.0;
    double least_m = HUGE_VAL;
    bool is_inside = true;

    for (uint32_t corner = 0U; corner < NAV_ZONE_CORNERS; corner++)
    {
        const uint32_t next = (corner + 1U) % NAV_ZONE_CORNERS;
        const double side_x = zone->vertex_x_site_m[next] - zone->vertex_x_site_m[corner];
        const double side_y = zone->vertex_y_site_m[next] - zone->vertex_y_site_m[corner];
        const double dx = x_site_m - zone->vertex_x_site_m[corner];
        const double dy = y_site_m - zone->vertex_y_site_m[corner];
        const double along = ((dx * side_x) + (dy * side_y)) / (square(side_x) + square(side_y));
        const double share = nav_clamp(along, 0.0, 1.0);

        least_m = nav_min(least_m, length_of(dx - (share * side_x), dy - (share * side_y)));
        is_inside = is_inside && ((sense * ((side_x * dy) - (side_y * dx))) >= 0.0);
    }
    return is_inside ? -least_m : least_m;
}

/* Is the point farther from the zone than the margin, for certain? Saves the exact distance. */
static bool is_far(const nav_zone_t *zone, double x_site_m, double y_site_m, double margin_m)
{
    const double dx = x_site_m - zone->center_x_site_m;
    const double dy = y_site_m - zone->center_y_site_m;
    const double reach_m = (zone->length_m + zone->width_m) / 2.0;

    return (zone->shape == (uint32_t) NAV_ZONE_RECTANGLE) &&
           (((dx * dx) + (dy * dy)) > square(reach_m + fabs(margin_m)));
}

nav_status_t nav_kioz_check(const nav_zone_t *zone)
{
    const double lengths[NAV_ZONE_LENGTHS] = {zone->center_x_site_m,
                                              zone->center_y_site_m,
                                              zone->radius_m,
                                              zone->length_m,
                                              zone->width_m,
                                              zone->vertex_x_site_m[0],
                                              zone->vertex_x_site_m[1],
                                              zone->vertex_x_site_m[2],
                                              zone->vertex_y_site_m[0],
                                              zone->vertex_y_site_m[1],
                                              zone->vertex_y_site_m[2]};
    bool is_finite = nav_isfinite(zone->heading_rad);
    bool is_near = fabs(zone->heading_rad) <= NAV_ZONE_HEADING_MAX_RAD;
    nav_status_t status = NAV_OK;

    for (uint32_t index = 0U; index < NAV_ZONE_LENGTHS; index++)
    {
        is_finite = is_finite && nav_isfinite(lengths[index]);
        is_near = is_near && (fabs(lengths[index]) <= NAV_ZONE_LENGTH_MAX_M);
    }
    if (!is_finite)
    {
        status = NAV_NOT_FINITE;
    }
    else if ((zone->kind > (uint32_t) NAV_ZONE_KEEP_IN) || (!is_near) || (!is_wide_enough(zone)))
    {
        status = NAV_ZONE;
    }
    else
    {
        status = NAV_OK;
    }
    return status;
}

void nav_kioz_set(nav_kioz_t *kioz, const nav_zone_t *zones, uint32_t zone_count)
{
    (void) memset(kioz, 0, sizeof(*kioz));
    for (uint32_t index = 0U; (index < zone_count) && (index < (uint32_t) NAV_ZONES_MAX); index++)
    {
        kioz->zones[index] = zones[index];
        kioz->zone_count += 1U;
        if (zones[index].kind == (uint32_t) NAV_ZONE_KEEP_IN)
        {
            kioz->keep_in_count += 1U;
        }
    }
}

double nav_kioz_distance_m(const nav_zone_t *zone, double x_site_m, double y_site_m)
{
    const double dx = x_site_m - zone->center_x_site_m;
    const double dy = y_site_m - zone->center_y_site_m;
    double distance_m = 0.0;

    switch (zone->shape)
    {
    case NAV_ZONE_RECTANGLE:
        distance_m = distance_to_rectangle_m(zone, dx, dy);
        break;
    case NAV_ZONE_TRIANGLE:
        distance_m = distance_to_triangle_m(zone, x_site_m, y_site_m);
        break;
    case NAV_ZONE_CIRCLE:
    default:
        distance_m = length_of(dx, dy) - zone->radius_m;
        break;
    }
    return distance_m;
}

bool nav_kioz_forbids(const nav_kioz_t *kioz, double x_site_m, double y_site_m, double margin_m)
{
    bool is_kept_out = false;
    bool is_kept_in = kioz->keep_in_count == 0U;

    for (uint32_t index = 0U; (index < kioz->zone_count) && (index < (uint32_t) NAV_ZONES_MAX);
         index++)
    {
        const nav_zone_t *zone = &kioz->zones[index];

        if (!is_far(zone, x_site_m, y_site_m, margin_m))
        {
            const double distance_m = nav_kioz_distance_m(zone, x_site_m, y_site_m);

            if (zone->kind == (uint32_t) NAV_ZONE_KEEP_IN)
            {
                is_kept_in = is_kept_in || (distance_m <= -margin_m);
            }
            else
            {
                is_kept_out = is_kept_out || (distance_m <= margin_m);
            }
        }
    }
    return is_kept_out || (!is_kept_in);
}
