/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_types.h
 * @brief Status, rejection reasons, modes and the small records that every module shares.
 *
 * Frames: SITE is x north, y east, z down. ROVER is x forward, y right, z down, origin on the ground
 * under the middle axle. Yaw is clockwise from north. A vector in ROVER is taken to SITE by
 * Rz(yaw) Ry(pitch) Rx(roll): pitch is positive nose up, roll is positive right side down.
 * Units: metres, radians, seconds.
 *
 * A record is a list of field rows from which the struct, its self-description in data product files
 * and its documentation are all made:
 *   S(type, name, unit, doc)          one number
 *   A(type, name, count, unit, doc)   an array of numbers
 *   N(type, name, doc)                a nested record
 *   M(type, name, count, doc)         an array of nested records
 */
#ifndef NAV_TYPES_H
#define NAV_TYPES_H

#include <stdbool.h>
#include <stdint.h>

#include "nav_config.h"

#define NAV_MEMBER_S(type, name, unit, doc) type name;
#define NAV_MEMBER_A(type, name, count, unit, doc) type name[count];
#define NAV_MEMBER_N(type, name, doc) type name;
#define NAV_MEMBER_M(type, name, count, doc) type name[count];
#define NAV_RECORD(FIELDS, type)                                                                   \
    typedef struct                                                                                 \
    {                                                                                              \
        FIELDS(NAV_MEMBER_S, NAV_MEMBER_A, NAV_MEMBER_N, NAV_MEMBER_M)                             \
    } type

/** X(value, NAME, "meaning") */
#define NAV_STATUS_TABLE(X)                                                                        \
    X(0, OK, "done")                                                                               \
    X(1, NULL_POINTER, "an argument is a null pointer")                                            \
    X(2, NOT_INITIALIZED, "nav_init has not succeeded on this context")                            \
    X(3, PARAMETER_RANGE, "a parameter is outside its range or not a number")                      \
    X(4, PARAMETER_CONFLICT, "two parameters contradict each other")                               \
    X(5, NOT_FINITE, "an input is not a finite number")                                            \
    X(6, OUT_OF_RANGE, "an input is outside its allowed range")                                    \
    X(7, COUNT, "a count is larger than its capacity or does not fit its sequence")                \
    X(8, ORDER, "the call came before the calls it depends on, or time ran backwards")             \
    X(9, ZONE, "a keep-in or keep-out zone is degenerate or of unknown kind")                      \
    X(10, NO_PATH, "no path passed the checks of its mode")                                        \
    X(11, SINK, "the host refused a data product")                                                 \
    X(12, INTERNAL, "a state that only a defect can produce")

#define NAV_STATUS_ROW(value, name, text) NAV_##name = (value),
typedef enum
{
    NAV_STATUS_TABLE(NAV_STATUS_ROW) NAV_STATUS_COUNT = 13
} nav_status_t;

/** Why a costmap cell is infinite or a path was not selected. X(value, NAME, "meaning") */
#define NAV_REASON_TABLE(X)                                                                        \
    X(0, NONE, "not rejected")                                                                     \
    X(1, KIOZ, "inside a keep-out zone or outside a keep-in zone")                                 \
    X(2, WHEEL_DROP, "a wheel could fall further than the limit")                                  \
    X(3, CLEARANCE, "the belly pan could come closer to the ground than the limit")                \
    X(4, TILT, "the rover could tilt more than the limit")                                         \
    X(5, ROCKER, "the rocker angle could exceed its limit")                                        \
    X(6, BOGIE, "a bogie angle could exceed its limit")                                            \
    X(7, UNKNOWN, "too much unknown terrain under the wheels or the belly")                        \
    X(8, NEGATIVE_PROGRESS, "leads too far away from the goal")                                    \
    X(9, UNEXPECTED, "no plane fit, or no consistent bounds")                                      \
    X(10, COST, "safe, but dearer than the selected path")                                         \
    X(11, BUDGET, "not tested: the evaluation budget of the call was used up")

#define NAV_REASON_ROW(value, name, text) NAV_REASON_##name = (value),
typedef enum
{
    NAV_REASON_TABLE(NAV_REASON_ROW) NAV_REASON_COUNT = 12
} nav_reason_t;

/** Go To modes of SIM section 3. X(value, NAME, "meaning") */
#define NAV_MODE_TABLE(X)                                                                          \
    X(0, UNGUARDED, "fastest path; refused when it violates a zone")                               \
    X(1, GUARDED, "the same path, checked against zones and terrain")                              \
    X(2, AVOID_KOZ, "plans round zones, ignores the terrain")                                      \
    X(3, AVOID_ALL, "plans round zones and hazards")

#define NAV_MODE_ROW(value, name, text) NAV_MODE_##name = (value),
typedef enum
{
    NAV_MODE_TABLE(NAV_MODE_ROW) NAV_MODE_COUNT = 4
} nav_mode_t;

#define NAV_POSE_FIELDS(S, A, N, M)                                                                \
    S(double, x_site_m, "m", "north")                                                              \
    S(double, y_site_m, "m", "east")                                                               \
    S(double, z_site_m, "m", "down")                                                               \
    S(double, roll_rad, "rad", "positive right side down")                                         \
    S(double, pitch_rad, "rad", "positive nose up")                                                \
    S(double, yaw_rad, "rad", "clockwise from north")
NAV_RECORD(NAV_POSE_FIELDS, nav_pose_t);

#define NAV_UNCERTAINTY_FIELDS(S, A, N, M)                                                         \
    S(double, position_m, "m", "radius within which the true position lies, relative to the map")  \
    S(double, yaw_rad, "rad", "half width of the yaw error")                                       \
    S(double, global_position_m, "m", "radius of the position error in SITE; grows zones")
NAV_RECORD(NAV_UNCERTAINTY_FIELDS, nav_uncertainty_t);

#define NAV_WAYDISC_FIELDS(S, A, N, M)                                                             \
    S(double, x_site_m, "m", "north of the centre")                                                \
    S(double, y_site_m, "m", "east of the centre")                                                 \
    S(double, radius_m, "m", "the goal is reached inside this radius")
NAV_RECORD(NAV_WAYDISC_FIELDS, nav_waydisc_t);

#define NAV_ARC_FIELDS(S, A, N, M)                                                                 \
    S(double, length_m, "m", "along the arc; 0 is a turn in place; negative drives backward")      \
    S(double, heading_change_rad, "rad", "yaw at the end minus yaw at the start")
NAV_RECORD(NAV_ARC_FIELDS, nav_arc_t);

#define NAV_POINT_FIELDS(S, A, N, M)                                                               \
    S(float, x_m, "m", "forward in ROVER, north in SITE")                                          \
    S(float, y_m, "m", "right in ROVER, east in SITE")                                             \
    S(float, z_m, "m", "down")
NAV_RECORD(NAV_POINT_FIELDS, nav_point_t);

/** What a status means, as text; "unknown status" for a value outside the table. */
const char *nav_status_text(nav_status_t status);
/** What a reason means, as text; "unknown reason" for a value outside the table. */
const char *nav_reason_text(nav_reason_t reason);

#endif
