/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_belly.h
 * @brief Private to Navlib: least clearance of the belly pan over the ground under it.
 *
 * In the plane frame of nav_ground.h. Clearance at a point of the ground, along the body's z axis, is
 * affine in the point for a given state; over the intervals of the six wheel heights it can fall by a
 * spread that is convex in the point's place.
 */
#ifndef NAV_BELLY_H
#define NAV_BELLY_H

#include "nav_states.h"

/** What stands under the belly. */
typedef struct
{
    double clearance_min_m; /* a lower bound; NAV_ETA_NONE when no known ground is under it */
    double unknown;         /* share of the box; 1 over no known ground */
} nav_clearance_t;

/**
 * @param box       the belly, grown, along the axes of the body, from the ROVER origin
 * @param height_m  of the pan above the flat ground
 * @param turn_rad  of the body in the plane
 * @param enough_m  ground that leaves this much clearance is not looked at closely
 */
nav_clearance_t nav_belly_clearance(const nav_ground_t *ground,
                                    const nav_spanned_t *spanned,
                                    const nav_box_t *box,
                                    double height_m,
                                    double turn_rad,
                                    double enough_m);

#endif
