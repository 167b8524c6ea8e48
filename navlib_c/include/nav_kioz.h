/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_kioz.h
 * @brief Keep-in and keep-out zones: rectangles, triangles, circles.
 *
 * A point is forbidden when it lies in a keep-out zone grown by a margin, or when keep-in zones exist
 * and it lies in none of them shrunk by that margin (SIM section 3: the margin is the global position
 * uncertainty).
 */
#ifndef NAV_KIOZ_H
#define NAV_KIOZ_H

#include "nav_types.h"

typedef enum
{
    NAV_ZONE_KEEP_OUT = 0,
    NAV_ZONE_KEEP_IN = 1
} nav_zone_kind_t;

typedef enum
{
    NAV_ZONE_CIRCLE = 0,
    NAV_ZONE_RECTANGLE = 1,
    NAV_ZONE_TRIANGLE = 2
} nav_zone_shape_t;

#define NAV_ZONE_FIELDS(S, A, N, M)                                                                \
    S(uint32_t, kind, "1", "nav_zone_kind_t")                                                      \
    S(uint32_t, shape, "1", "nav_zone_shape_t")                                                    \
    S(double, center_x_site_m, "m", "circle, rectangle: north of the centre")                      \
    S(double, center_y_site_m, "m", "circle, rectangle: east of the centre")                       \
    S(double, radius_m, "m", "circle")                                                             \
    S(double, length_m, "m", "rectangle: along its heading")                                       \
    S(double, width_m, "m", "rectangle: across its heading")                                       \
    S(double, heading_rad, "rad", "rectangle: clockwise from north")                               \
    A(double, vertex_x_site_m, 3, "m", "triangle: north of its corners, in either sense")          \
    A(double, vertex_y_site_m, 3, "m", "triangle: east of its corners")
NAV_RECORD(NAV_ZONE_FIELDS, nav_zone_t);

typedef struct
{
    uint32_t zone_count;
    uint32_t keep_in_count;
    nav_zone_t zones[NAV_ZONES_MAX];
} nav_kioz_t;

/** Bound of every coordinate, side and radius of a zone, and of its heading. */
#define NAV_ZONE_LENGTH_MAX_M 1.0e8
#define NAV_ZONE_HEADING_MAX_RAD 1.0e4

/**
 * Is a zone one that can be used: known kind and shape, all fields finite and within their bounds,
 * not degenerate (sides, radius and triangle heights of at least 1 cm)?
 * @return NAV_OK, NAV_NOT_FINITE, NAV_ZONE
 */
nav_status_t nav_kioz_check(const nav_zone_t *zone);

/** Replaces all zones by checked ones; zone_count <= NAV_ZONES_MAX. */
void nav_kioz_set(nav_kioz_t *kioz, const nav_zone_t *zones, uint32_t zone_count);

/** Signed distance from a point to the border of a zone, negative inside (exact for all shapes). */
double nav_kioz_distance_m(const nav_zone_t *zone, double x_site_m, double y_site_m);

/**
 * Is the point forbidden, with zones grown (keep-out) and shrunk (keep-in) by the margin?
 * The borders belong to the zones.
 */
bool nav_kioz_forbids(const nav_kioz_t *kioz, double x_site_m, double y_site_m, double margin_m);

#endif
