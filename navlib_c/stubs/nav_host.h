/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_host.h
 * @brief Records that a simulator adds to the stream: ground truth, estimate, timeline, events of its
 * executive. Never flight's.
 */
#ifndef NAV_HOST_H
#define NAV_HOST_H

#include "nav_dp.h"
#include "nav_evr.h"

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

/** Events of the executive, rows as in nav_evr.h; a FAULT_ is the fault of that name and ends the drive. */
#define NAV_HOST_EVR_TABLE(X)                                                                      \
    X(101, GO_TO, ACTIVITY_HIGH, 4, "Go To waypoint {}: north {} m, east {} m, mode {}",           \
      "a Go To begins", "waypoint, from 1; north, m; east, m; nav_mode_t")                         \
    X(102, CRAWL, ACTIVITY_HIGH, 1, "crawling {} m onto the map, unguarded",                       \
      "the terrain under the rover is not known", "least length, m")                               \
    X(103, CRAWL_SKIPPED, ACTIVITY_HIGH, 0, "no crawl: the terrain under the rover is known",      \
      "evaluate_arc passed the pose in mode Guarded", "")                                          \
    X(104, DIRECTED_ARC, ACTIVITY_HIGH, 4, "directed arc {}: {} m, {} rad, mode {}",               \
      "an arc of the scenario's list begins",                                                      \
      "arc, from 1; length, m; heading change, rad; nav_mode_t")                                   \
    X(105, WAYPOINT_REACHED, ACTIVITY_HIGH, 2, "waypoint {} reached, {} m from its middle",        \
      "the believed position is in the waydisc", "waypoint, from 1; distance, m")                  \
    X(106, ARC_STOPPED, WARNING_LOW, 3, "arc stopped after {} of it, reason {}, {} in a row",      \
      "evaluate_arc found the arc being driven unsafe; another is planned",                        \
      "driven share; nav_reason_t; arcs stopped in a row")                                         \
    X(107, LOOKING_AROUND, WARNING_LOW, 1, "no path, {} in a row: looking around",                 \
      "select_arc found no path; images all around are taken", "times in a row")                   \
    X(108, PLACED, ACTIVITY_HIGH, 3, "rover set down at north {} m, east {} m, yaw {} rad",        \
      "a command of the command socket", "north, m; east, m; yaw, rad")                            \
    X(109, STOPPED, ACTIVITY_HIGH, 0, "drive ended by command", "a command of the command socket", \
      "")                                                                                          \
    X(120, FAULT_NO_PATH, WARNING_HIGH, 3,                                                         \
      "fault no_path: {} in a row, most rejected by reason {}, {} times",                          \
      "select_arc found no path, and the mode or the count allows no other attempt",               \
      "times in a row; nav_reason_t; how often")                                                   \
    X(121, FAULT_UNSAFE_ARC, WARNING_HIGH, 3,                                                      \
      "fault unsafe_arc: {} in a row, reason {}, {} m or rad along it",                            \
      "evaluate_arc found an arc unsafe, and the mode or the count allows no other",               \
      "times in a row; nav_reason_t; distance, m, or angle, rad")                                  \
    X(122, FAULT_LIMIT_VIOLATION, WARNING_HIGH, 2,                                                 \
      "fault limit_violation: true position north {} m, east {} m",                                \
      "the true rover exceeds a limit of its vehicle", "north, m; east, m")                        \
    X(123, FAULT_KIOZ_VIOLATION, WARNING_HIGH, 2,                                                  \
      "fault kioz_violation: true position north {} m, east {} m",                                 \
      "the true rover is in a keep-out zone or outside the keep-in zones", "north, m; east, m")    \
    X(124, FAULT_STUCK, WARNING_HIGH, 2, "fault stuck: believed position north {} m, east {} m",   \
      "slip took what was commanded, or the path leads no nearer to the goal",                     \
      "north, m; east, m")                                                                         \
    X(125, FAULT_TIME_LIMIT, WARNING_HIGH, 2, "fault time_limit: {} s, {} m from the goal",        \
      "the time of the drive is over", "time, s; distance, m")                                     \
    X(126, FAULT_LEFT_MAP, WARNING_HIGH, 2, "fault left_map: true position north {} m, east {} m", \
      "a wheel has no terrain under it", "north, m; east, m")                                      \
    X(127, FAULT_PLANNER_ERROR, WARNING_HIGH, 0, "fault planner_error",                            \
      "the planner failed or refused a call", "")

#define NAV_HOST_EVR_ROW(value, name, severity, count, text, cause, args)                          \
    NAV_HOST_EVR_##name = (value),
typedef enum
{
    NAV_HOST_EVR_TABLE(NAV_HOST_EVR_ROW) NAV_HOST_EVR_COUNT = 17
} nav_host_evr_id_t;

extern const nav_evr_def_t nav_host_evr_defs[NAV_HOST_EVR_COUNT];

/** X(value, NAME, record type, "what it is") */
#define NAV_HOST_DP_TABLE(X)                                                                       \
    X(32, TRUTH, nav_host_truth_t, "ground truth of one 8 Hz step")                                \
    X(33, ESTIMATE, nav_host_estimate_t, "estimated pose after a fix")                             \
    X(34, TIMELINE, nav_host_timeline_t, "an activity with its start and end")                     \
    X(35, HOST_EVR, nav_evr_t, "an event of the executive, nav_host_evr_id_t")

#define NAV_HOST_DP_ROW(value, name, type, doc) NAV_HOST_DP_##name = (value),
typedef enum
{
    NAV_HOST_DP_TABLE(NAV_HOST_DP_ROW) NAV_HOST_DP_COUNT = 4
} nav_host_dp_kind_t;

#define NAV_HOST_RECORD_TABLE(X)                                                                   \
    X(nav_host_truth_t, NAV_HOST_TRUTH_FIELDS)                                                     \
    X(nav_host_estimate_t, NAV_HOST_ESTIMATE_FIELDS)                                               \
    X(nav_host_timeline_t, NAV_HOST_TIMELINE_FIELDS)

#define NAV_HOST_RECORD_COUNT (0 NAV_HOST_RECORD_TABLE(NAV_RECORD_ONE))

extern const nav_record_def_t nav_host_record_defs[NAV_HOST_RECORD_COUNT];
extern const nav_dp_def_t nav_host_dp_defs[NAV_HOST_DP_COUNT];

#endif
