/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_wheel.h
 * @brief Private to Navlib: what stands in the box of one wheel, and how high its hub can be.
 *
 * All in the plane frame of nav_ground.h. A wheel is a disc along the heading: it stands on the surface
 * dilated by that disc, and its interval is the range of that over all places the wheel can be.
 */
#ifndef NAV_WHEEL_H
#define NAV_WHEEL_H

#include "nav_ground.h"

/** A wheel's box: its hub over the plane, and how the box leans with the body. */
typedef struct
{
    nav_box_t box;
    double radius_m;
    double hub_m; /* height of the hub */
    double pitch_rad;
    double roll_rad;
} nav_footprint_t;

/** What the heightmap cells in a wheel's box hold. */
typedef struct
{
    nav_interval_t above; /* vertical, over the plane; empty when nothing is known */
    uint32_t cell_count;
    uint32_t unknown_count;
} nav_span_t;

/** The box in which the feet of all terrain lie that can stand in the wheel's box. */
nav_box_t nav_wheel_feet(const nav_ground_t *ground, const nav_footprint_t *footprint);

/** Looks at every heightmap cell in the wheel's box. */
nav_span_t nav_wheel_span(const nav_ground_t *ground, const nav_footprint_t *footprint);

/**
 * Heights of a wheel's lowest point over the plane, along its normal.
 * @param places  where the wheel's hub can be; its feet, as far as sideways is concerned
 * @param above   between which heights the ground lies in the box and one cell around
 */
nav_interval_t nav_wheel_interval(const nav_ground_t *ground,
                                  const nav_box_t *places,
                                  const nav_interval_t *above,
                                  double radius_m);

#endif
