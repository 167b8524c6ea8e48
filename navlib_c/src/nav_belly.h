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

#include "nav_ground.h"
#include "nav_vehicle.h"

/** A state of the linkage, spanned by the intervals of the wheel heights. */
typedef struct
{
    nav_linkage_t linkage; /* solved for the middles */
    double half[NAV_LINKAGE_STATES];
    double wheel_middle_m[NAV_WHEELS];
    double wheel_half_m[NAV_WHEELS];
    double curved_m2; /* scale of what the linearization leaves out */
    double sin_roll;  /* of the middle */
    double cos_roll;
    double sin_pitch;
    double cos_pitch;
} nav_spanned_t;

/** What stands under the belly. */
typedef struct
{
    double clearance_min_m; /* NAV_ETA_NONE when no known ground is under it */
    double unknown;         /* share of the box; 1 over no known ground */
} nav_clearance_t;

/**
 * @param box       the belly, grown, along the axes of the body, from the ROVER origin
 * @param height_m  of the pan above the flat ground
 * @param turn_rad  of the body in the plane
 */
nav_clearance_t nav_belly_clearance(const nav_ground_t *ground,
                                    const nav_spanned_t *spanned,
                                    const nav_box_t *box,
                                    double height_m,
                                    double turn_rad);

#endif
