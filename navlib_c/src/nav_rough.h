/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_rough.h
 * @brief Private to Navlib: how high a wheel can stand, cheaply.
 *
 * Like nav_wheel_interval, but on a ball in place of the disc, and over upright rectangles of the grid in
 * place of boxes along the heading: wider, at a tenth of the price.
 */
#ifndef NAV_ROUGH_H
#define NAV_ROUGH_H

#include "nav_ground.h"

/**
 * Heights of a wheel's lowest point over the plane, along its normal: not below the lowest ground under its
 * places, not above a ball that rests there. -NAV_ETA_NONE to NAV_ETA_NONE where ground nearby is not
 * known, or where it puts the wheel far from height_m.
 * @param places    where the wheel's lowest point can be
 * @param height_m  about what its height is
 * @param lean_rad  how far the wheel can lean sideways
 */
nav_interval_t nav_rough_interval(const nav_ground_t *ground,
                                  const nav_box_t *places,
                                  double height_m,
                                  double lean_rad,
                                  double radius_m);

#endif
