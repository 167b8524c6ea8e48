/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_vehicle.h
 * @brief The six-wheel rocker-bogie linkage with differential: hub heights of a state, and back.
 *
 * A linkage state is six numbers, relative to a reference plane (its normal is "up"):
 *   [0] height of the ROVER origin above the plane, m
 *   [1] roll, [2] pitch relative to the plane, rad
 *   [3] angle of the left rocker against the body, nose down positive, rad; the right one is its negative
 *   [4] angle of the left bogie against its rocker, nose down positive, rad
 *   [5] angle of the right bogie
 * Given six hub heights the state is determined: 6 equations, 6 unknowns, no mass needed.
 * Body, rockers and bogies turn about axes parallel to y, so only x and z of the pivots matter.
 */
#ifndef NAV_VEHICLE_H
#define NAV_VEHICLE_H

#include "nav_params.h"

#define NAV_LINKAGE_STATES 6
#define NAV_LINKAGE_HEIGHT 0
#define NAV_LINKAGE_ROLL 1
#define NAV_LINKAGE_PITCH 2
#define NAV_LINKAGE_ROCKER 3
#define NAV_LINKAGE_BOGIE_LEFT 4
#define NAV_LINKAGE_BOGIE_RIGHT 5

/** Geometry in ROVER, wheels in the order of NAV_WHEELS, heights up from the flat ground. */
typedef struct
{
    double hub_x_m[NAV_WHEELS];
    double hub_y_m[NAV_WHEELS];
    double hub_height_m; /* all six hubs on flat ground: the wheel radius */
    double rocker_pivot_x_m;
    double rocker_pivot_height_m;
    double bogie_pivot_x_m;
    double bogie_pivot_height_m;
    double flat_inverse[NAV_LINKAGE_STATES]
                       [NAV_WHEELS]; /* derivatives of the state on flat ground */
    /* and of where each hub is, fore and aft, by all heights */
    double forward_per_height[NAV_WHEELS][NAV_WHEELS];
} nav_vehicle_t;

/** A state found for six wheel heights, and how the state changes with them. */
typedef struct
{
    double state[NAV_LINKAGE_STATES];
    double inverse[NAV_LINKAGE_STATES]
                  [NAV_WHEELS]; /* derivatives of the state, near the solution */
    double moved_max_m;    /* largest change of a wheel height from where the inverse was taken */
    double residual_max_m; /* largest wheel height left over */
} nav_linkage_t;

/** Takes the geometry from checked parameters. */
void nav_vehicle_init(const nav_params_t *params, nav_vehicle_t *vehicle);

/**
 * Heights of the six wheels' lowest points above the plane (hub height less the wheel radius), and
 * their derivatives: jacobian[wheel][state].
 */
void nav_vehicle_wheel_heights(const nav_vehicle_t *vehicle,
                               const double state[NAV_LINKAGE_STATES],
                               double height_m[NAV_WHEELS],
                               double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES]);

/**
 * Where the wheels' lowest points are in the plane, forward and right of the ROVER origin: the hub
 * fore and aft, the foot of the tilted wheel sideways.
 */
void nav_vehicle_wheel_places(const nav_vehicle_t *vehicle,
                              const double state[NAV_LINKAGE_STATES],
                              double forward_m[NAV_WHEELS],
                              double right_m[NAV_WHEELS]);

/** The state that has such wheel heights, as if it were linear in them: a guess, near flat ground a good one. */
void nav_vehicle_flat_state(const nav_vehicle_t *vehicle,
                            const double height_m[NAV_WHEELS],
                            double state[NAV_LINKAGE_STATES]);

/**
 * The state whose wheel heights are the given ones: at most 10 Newton steps from linkage->state, which
 * holds a guess. The derivatives are taken where it starts, and anew only when that is far away.
 * @param tolerance_m  largest wheel height that may be left over
 * @return false when that is not reached (heights no linkage could take); linkage then holds no solution
 */
bool nav_vehicle_settle(const nav_vehicle_t *vehicle,
                        const double height_m[NAV_WHEELS],
                        double tolerance_m,
                        nav_linkage_t *linkage);

#endif
