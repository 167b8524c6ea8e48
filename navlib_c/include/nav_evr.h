/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_evr.h
 * @brief Event reports: one table, and the one function through which they leave.
 */
#ifndef NAV_EVR_H
#define NAV_EVR_H

#include "nav_types.h"

#define NAV_EVR_ARGS_MAX 4

typedef enum
{
    NAV_EVR_DIAGNOSTIC = 0,
    NAV_EVR_ACTIVITY_LOW = 1,
    NAV_EVR_ACTIVITY_HIGH = 2,
    NAV_EVR_WARNING_LOW = 3,
    NAV_EVR_WARNING_HIGH = 4,
    NAV_EVR_FATAL = 5
} nav_evr_severity_t;

/** X(value, NAME, SEVERITY, argument count, "text with {} for each argument", "cause",
 * "meaning of each argument, separated by semicolons") */
#define NAV_EVR_TABLE(X)                                                                           \
    X(1, INITIALIZED, ACTIVITY_HIGH, 1, "navlib initialized, {} parameters",                       \
      "nav_init took all parameters", "number of parameters")                                      \
    X(2, CALL_REFUSED, WARNING_HIGH, 2, "call {} refused with status {}",                          \
      "an input was not usable; nothing was changed",                                              \
      "data product kind of the input; nav_status_t")                                              \
    X(3, PARAMETER_REFUSED, WARNING_HIGH, 2, "parameter {} refused, value {}",                     \
      "a parameter is out of range or contradicts another",                                        \
      "index in the parameter table; its value, 0 when not finite")                                \
    X(4, ZONES_SET, ACTIVITY_HIGH, 2, "{} keep-out and {} keep-in zones set",                      \
      "nav_set_kioz replaced all zones", "number of keep-out zones; of keep-in zones")             \
    X(5, ZONE_REFUSED, WARNING_HIGH, 1, "zone {} refused",                                         \
      "a zone is degenerate, not finite or of unknown kind; the old zones stay",                   \
      "index of the first such zone")                                                              \
    X(6, CLOUD_MERGED, ACTIVITY_LOW, 3, "image {}: {} points merged, {} outside the map",          \
      "a chunk of a point cloud was merged", "image number; points merged; points outside")        \
    X(7, COSTMAP_RECENTERED, ACTIVITY_LOW, 2, "costmap recentred on north {} m, east {} m",        \
      "the rover was near the edge of the costmap, or it was the first analysis",                  \
      "new middle, m north; m east")                                                               \
    X(8, TERRAIN_ANALYZED, ACTIVITY_LOW, 2, "{} cells known, {} infinite",                         \
      "nav_analyze_terrain is done", "costmap cells with a plane; cells that cannot be crossed")   \
    X(9, ARC_SELECTED, ACTIVITY_HIGH, 4,                                                           \
      "arc {} m, heading change {} rad, path cost {} s, {} ACE evaluations",                       \
      "nav_select_arc found a path",                                                               \
      "arc length, m; heading change, rad; cost of the path, s; ACE poses evaluated")              \
    X(10, NO_PATH, WARNING_HIGH, 3, "no path: {} paths, most rejected by reason {}, {} times",     \
      "no candidate passed the checks of the mode",                                                \
      "candidates; most frequent nav_reason_t, cost aside; how often")                             \
    X(11, BUDGET_USED, WARNING_LOW, 1, "evaluation budget of {} poses used up",                    \
      "ace_budget_poses was reached before a safe path was found", "ACE poses evaluated")          \
    X(12, ARC_UNSAFE, WARNING_HIGH, 3, "arc unsafe at {} m or rad along it, pose {}, reason {}",   \
      "nav_evaluate_arc found a pose that fails",                                                  \
      "distance along the arc, m, or angle in a turn, rad; index of the pose; nav_reason_t")       \
    X(13, PRODUCT_REFUSED, WARNING_LOW, 1, "the host refused data product {}",                     \
      "nav_dp_send did not return NAV_OK; the call went on", "kind of the data product")           \
    X(14, ASSERTION, WARNING_HIGH, 1, "assertion failed in module {}",                             \
      "a state that only a defect or a changed memory can produce", "module")

#define NAV_EVR_ROW(value, name, severity, count, text, cause, args) NAV_EVR_##name = (value),
typedef enum
{
    NAV_EVR_TABLE(NAV_EVR_ROW) NAV_EVR_COUNT = 14
} nav_evr_id_t;

#define NAV_EVR_FIELDS(S, A, N, M)                                                                 \
    S(double, time_s, "s", "time of the call that reported it")                                    \
    S(uint32_t, id, "1", "nav_evr_id_t")                                                           \
    S(uint32_t, severity, "1", "nav_evr_severity_t")                                               \
    S(uint32_t, arg_count, "1", "arguments used")                                                  \
    S(uint32_t, pad_0, "1", "zero")                                                                \
    A(double, args, NAV_EVR_ARGS_MAX, "1", "arguments in the order of the text")
NAV_RECORD(NAV_EVR_FIELDS, nav_evr_t);

typedef struct
{
    uint32_t id;
    nav_evr_severity_t severity;
    uint32_t arg_count;
    const char *name;
    const char *text;
    const char *cause;
    const char *args; /* the meaning of each, separated by "; " */
} nav_evr_def_t;

/** One row per event, in the order of the table. */
extern const nav_evr_def_t nav_evr_defs[NAV_EVR_COUNT];

/** Supplied by the host: takes one event report. Must not call back into Navlib. */
void nav_evr_send(const nav_evr_t *evr);

/** Fills a report from the table and sends it; unused arguments are given as 0. */
void nav_evr_report(
    double time_s, nav_evr_id_t id, double arg0, double arg1, double arg2, double arg3);

#endif
