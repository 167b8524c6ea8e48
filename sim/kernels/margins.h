/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file margins.h
 * @brief What the ground leaves to a settled rover: clearance and wheel drop.
 */
#ifndef SIM_MARGINS_H
#define SIM_MARGINS_H

#include "linkage.h"

/** Least distance along body z from the belly pan to a node under it; NaN over a hole. */
double clearance_of(const sim_terrain_t *terrain,
                    const sim_vehicle_t *vehicle,
                    const linkage_t *linkage);

/** Largest span of the nodes in one wheel's box, across the slope of the ground; NaN over a hole. */
double wheel_drop_of(const sim_terrain_t *terrain,
                     const sim_vehicle_t *vehicle,
                     const linkage_t *linkage);

#endif
