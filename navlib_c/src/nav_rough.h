/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_rough.h
 * @brief Private to Navlib: how high a wheel can stand, cheaply.
 *
 * Like nav_wheel_interval, but cell by cell, whatever lies between cells: wider, at a fraction of the price.
 */
#ifndef NAV_ROUGH_H
#define NAV_ROUGH_H

#include "nav_ground.h"

/**
 * Heights of a wheel's lowest point over the plane, along its normal: not below the ground under its
 * places, not above what its disc touches. -NAV_ETA_NONE to NAV_ETA_NONE where ground nearby is not
 * known, or where it puts the wheel far from height_m.
 * @param places    where the wheel's lowest point can be
 * @param height_m  about what its height is
 */
nav_interval_t nav_rough_interval(const nav_ground_t *ground,
                                  const nav_box_t *places,
                                  double height_m,
                                  double radius_m);

#endif
