/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_states.c
 * @brief The states that the linkage can take while each wheel's height lies within an interval.
 */
#include "nav_states.h"

#include <math.h>

#include "nav_minmax.h"

/* Heights of wheels are solved for to this; what is left over widens their intervals. */
#define SETTLE_TOLERANCE_M 5.0e-5

/** What a linearization of the linkage leaves out: second-order errors at most, of the states and of
 * clearance, per square of a change of wheel heights. Measured, and enlarged by a quarter. */
typedef struct
{
    double state[NAV_LINKAGE_STATES];
    double clearance;
} curvature_t;

/* Of a linearization at any state with wheel heights within +/-0.35 m, per squared half width of the
 * widest interval. */
static const curvature_t CURVATURE = {{0.21, 0.15, 0.29, 0.33, 3.2, 3.2}, 0.47};

/* Of that on flat ground, per square of half of what all wheels span together, up to this. */
static const curvature_t FLAT_CURVATURE = {{0.78, 0.32, 0.52, 0.42, 0.92, 0.92}, 1.42};
#define FLAT_HALF_MAX_M 0.1

static void take_heights(const nav_interval_t heights[NAV_WHEELS], nav_spanned_t *spanned)
{
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        spanned->wheel_middle_m[wheel] = 0.5 * (heights[wheel].low_m + heights[wheel].high_m);
        spanned->wheel_half_m[wheel] = 0.5 * (heights[wheel].high_m - heights[wheel].low_m);
    }
}

/** Half widths of the states from those of the wheels. */
static void spread_states(const curvature_t *curvature,
                          double curved_m2,
                          double wheel_radius_m,
                          nav_spanned_t *spanned)
{
    double gain[NAV_LINKAGE_STATES];
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        double half = curvature->state[k] * curved_m2;
        gain[k] = 0.0;
        for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
        {
            const double per_wheel = fabs(spanned->linkage.inverse[k][wheel]);
            half += per_wheel * spanned->wheel_half_m[wheel];
            gain[k] += per_wheel;
        }
        spanned->half[k] = half;
    }
    spanned->curved_m = curvature->clearance * curved_m2;
    /* a wheel that leans with the body stands lower over what it touches, by this at most */
    const double roll_far =
        fabs(spanned->linkage.state[NAV_LINKAGE_ROLL]) + spanned->half[NAV_LINKAGE_ROLL];
    const double lean_m = 0.5 * wheel_radius_m * (roll_far * roll_far);
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        spanned->half[k] += gain[k] * lean_m;
    }
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        spanned->wheel_half_m[wheel] += lean_m;
    }
}

bool nav_states_solve(const nav_vehicle_t *vehicle,
                      const nav_interval_t heights[NAV_WHEELS],
                      nav_spanned_t *spanned)
{
    double widest_m = 0.0;
    take_heights(heights, spanned);
    nav_vehicle_flat_state(vehicle, spanned->wheel_middle_m, spanned->linkage.state);
    const bool is_solved =
        nav_vehicle_settle(vehicle, spanned->wheel_middle_m, SETTLE_TOLERANCE_M, &spanned->linkage);
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        spanned->wheel_half_m[wheel] += spanned->linkage.residual_max_m;
        widest_m = nav_max(widest_m, spanned->wheel_half_m[wheel]);
    }
    spread_states(&CURVATURE, widest_m * (widest_m + (2.0 * spanned->linkage.moved_max_m)),
                  vehicle->hub_height_m, spanned);
    return is_solved;
}

/** Half of what the heights of all wheels span together. */
static double half_of_all_m(const nav_interval_t heights[NAV_WHEELS])
{
    nav_interval_t all = heights[0];
    for (uint32_t wheel = 1U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        all.low_m = nav_min(all.low_m, heights[wheel].low_m);
        all.high_m = nav_max(all.high_m, heights[wheel].high_m);
    }
    return 0.5 * (all.high_m - all.low_m);
}

bool nav_states_flat(const nav_vehicle_t *vehicle,
                     const nav_interval_t heights[NAV_WHEELS],
                     nav_spanned_t *spanned)
{
    /* what all wheels are raised together raises the rover and bends nothing */
    const double half_m = half_of_all_m(heights);
    const bool is_flat = half_m <= FLAT_HALF_MAX_M;
    if (is_flat)
    {
        take_heights(heights, spanned);
        nav_vehicle_flat_state(vehicle, spanned->wheel_middle_m, spanned->linkage.state);
        for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
        {
            for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
            {
                spanned->linkage.inverse[k][wheel] = vehicle->flat_inverse[k][wheel];
            }
        }
        spread_states(&FLAT_CURVATURE, half_m * half_m, vehicle->hub_height_m, spanned);
    }
    return is_flat;
}
