/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_host.h
 * @brief Records that a simulator adds to the stream: ground truth, estimate, timeline. Never flight's.
 */
#ifndef NAV_HOST_H
#define NAV_HOST_H

#include "nav_dp.h"

#define NAV_HOST_TRUTH_FIELDS(S, A, N, M)                                                          \
    S(double, time_s, "s", "")                                                                     \
    N(nav_pose_t, pose, "of the settled rover")                                                    \
    S(double, rocker_rad, "rad", "left rocker, nose down positive")                                \
    S(double, bogie_left_rad, "rad", "against its rocker, nose down positive")                     \
    S(double, bogie_right_rad, "rad", "against its rocker, nose down positive")                    \
    S(double, tilt_rad, "rad", "against gravity")                                                  \
    S(double, clearance_m, "m", "belly pan to terrain along the body z axis")                      \
    S(double, wheel_drop_m, "m", "largest height span in a wheel's footprint")                     \
    S(double, slip, "1", "1 - actual / commanded motion along the arc")                            \
    S(double, distance_driven_m, "m", "since the start")                                           \
    S(double, residual_m, "m", "largest gap left between a wheel and the ground")                  \
    S(uint32_t, is_converged, "1", "1 when the settling met its tolerance")                        \
    S(uint32_t, pad_0, "1", "zero")                                                                \
    M(nav_point_t, contacts, NAV_WHEELS, "wheel contact points, SITE")
NAV_RECORD(NAV_HOST_TRUTH_FIELDS, nav_host_truth_t);

#define NAV_HOST_ESTIMATE_FIELDS(S, A, N, M)                                                       \
    S(double, time_s, "s", "")                                                                     \
    N(nav_pose_t, pose, "what the rover believes")                                                 \
    N(nav_uncertainty_t, uncertainty, "")
NAV_RECORD(NAV_HOST_ESTIMATE_FIELDS, nav_host_estimate_t);

/** What the executive does, one lane each. X(value, NAME, "meaning") */
#define NAV_HOST_ACTIVITY_TABLE(X)                                                                 \
    X(0, IMAGING, "taking stereo pairs")                                                           \
    X(1, VISUAL_ODOMETRY, "VO fix")                                                                \
    X(2, PROCESS_DISPARITY, "merging a point cloud")                                               \
    X(3, ANALYZE_TERRAIN, "computing the costmap")                                                 \
    X(4, SELECT_ARC, "choosing the next arc")                                                      \
    X(5, EVALUATE_ARC, "checking the arc being driven")                                            \
    X(6, STEERING, "turning the wheels, standing")                                                 \
    X(7, DRIVING, "driving an arc")                                                                \
    X(8, WAITING, "standing because thinking is late")

#define NAV_HOST_ACTIVITY_ROW(value, name, text) NAV_HOST_##name = (value),
typedef enum
{
    NAV_HOST_ACTIVITY_TABLE(NAV_HOST_ACTIVITY_ROW) NAV_HOST_ACTIVITY_COUNT = 9
} nav_host_activity_t;

#define NAV_HOST_TIMELINE_FIELDS(S, A, N, M)                                                       \
    S(double, start_s, "s", "")                                                                    \
    S(double, end_s, "s", "")                                                                      \
    S(uint32_t, activity, "1", "nav_host_activity_t")                                              \
    S(uint32_t, cycle, "1", "planning cycle it belongs to")                                        \
    N(nav_arc_t, arc, "of steering, driving, selecting, evaluating; else 0")
NAV_RECORD(NAV_HOST_TIMELINE_FIELDS, nav_host_timeline_t);

/** X(value, NAME, record type, "what it is") */
#define NAV_HOST_DP_TABLE(X)                                                                       \
    X(32, TRUTH, nav_host_truth_t, "ground truth of one 8 Hz step")                                \
    X(33, ESTIMATE, nav_host_estimate_t, "estimated pose after a fix")                             \
    X(34, TIMELINE, nav_host_timeline_t, "an activity with its start and end")

#define NAV_HOST_DP_ROW(value, name, type, doc) NAV_HOST_DP_##name = (value),
typedef enum
{
    NAV_HOST_DP_TABLE(NAV_HOST_DP_ROW) NAV_HOST_DP_COUNT = 3
} nav_host_dp_kind_t;

#define NAV_HOST_RECORD_TABLE(X)                                                                   \
    X(nav_host_truth_t, NAV_HOST_TRUTH_FIELDS)                                                     \
    X(nav_host_estimate_t, NAV_HOST_ESTIMATE_FIELDS)                                               \
    X(nav_host_timeline_t, NAV_HOST_TIMELINE_FIELDS)

#define NAV_HOST_RECORD_COUNT (0 NAV_HOST_RECORD_TABLE(NAV_RECORD_ONE))

extern const nav_record_def_t nav_host_record_defs[NAV_HOST_RECORD_COUNT];
extern const nav_dp_def_t nav_host_dp_defs[NAV_HOST_DP_COUNT];

#endif
