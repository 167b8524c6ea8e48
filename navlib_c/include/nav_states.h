/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_states.h
 * @brief Used by ACE alone: the states that the linkage can take while each wheel's height lies within an
 * interval.
 */
#ifndef NAV_STATES_H
#define NAV_STATES_H

#include "nav_ground.h"
#include "nav_vehicle.h"

/** A state of the linkage, spanned by the intervals of the wheel heights. */
typedef struct
{
    nav_linkage_t linkage; /* in the middle */
    double half[NAV_LINKAGE_STATES];
    double wheel_middle_m[NAV_WHEELS];
    double wheel_half_m[NAV_WHEELS];
    double curved_m; /* of clearance, that the linearization leaves out */
    double sin_roll; /* of the middle */
    double cos_roll;
    double sin_pitch;
    double cos_pitch;
} nav_spanned_t;

/**
 * Solves the linkage for the middles of the intervals, and linearizes it there. Sines and cosines are left alone.
 * @return false when no state has such heights
 */
bool nav_states_solve(const nav_vehicle_t *vehicle,
                      const nav_interval_t heights[NAV_WHEELS],
                      nav_spanned_t *spanned);

/**
 * The same without solving: linearized on flat ground, so wider.
 * @return false, with spanned as it was, when the heights are too different for that
 */
bool nav_states_flat(const nav_vehicle_t *vehicle,
                     const nav_interval_t heights[NAV_WHEELS],
                     nav_spanned_t *spanned);

#endif
