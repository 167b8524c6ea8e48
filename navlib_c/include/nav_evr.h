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

/** X(value, NAME, SEVERITY, argument count, "text with {} for each argument") */
#define NAV_EVR_TABLE(X)                                                                           \
    X(1, INITIALIZED, ACTIVITY_HIGH, 1, "navlib initialized, {} parameters")                       \
    X(2, CALL_REFUSED, WARNING_HIGH, 2, "call {} refused with status {}")                          \
    X(3, PARAMETER_REFUSED, WARNING_HIGH, 2, "parameter {} refused, value {}")                     \
    X(4, ZONES_SET, ACTIVITY_HIGH, 2, "{} keep-out and {} keep-in zones set")                      \
    X(5, ZONE_REFUSED, WARNING_HIGH, 1, "zone {} refused")                                         \
    X(6, CLOUD_MERGED, ACTIVITY_LOW, 3, "image {}: {} points merged, {} outside the map")          \
    X(7, COSTMAP_RECENTERED, ACTIVITY_LOW, 2, "costmap recentred on north {} m, east {} m")        \
    X(8, TERRAIN_ANALYZED, ACTIVITY_LOW, 2, "{} cells known, {} infinite")                         \
    X(9, ARC_SELECTED, ACTIVITY_HIGH, 4,                                                           \
      "arc {} m, heading change {} rad, path cost {} s, {} ACE evaluations")                       \
    X(10, NO_PATH, WARNING_HIGH, 3, "no path: {} paths, most rejected by reason {}, {} times")     \
    X(11, BUDGET_USED, WARNING_LOW, 1, "evaluation budget of {} poses used up")                    \
    X(12, ARC_UNSAFE, WARNING_HIGH, 3, "arc unsafe at {} m or rad along it, pose {}, reason {}")   \
    X(13, PRODUCT_REFUSED, WARNING_LOW, 1, "the host refused data product {}")                     \
    X(14, ASSERTION, WARNING_HIGH, 1, "assertion failed in module {}")

#define NAV_EVR_ROW(value, name, severity, count, text) NAV_EVR_##name = (value),
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
} nav_evr_def_t;

/** One row per event, in the order of the table. */
extern const nav_evr_def_t nav_evr_defs[NAV_EVR_COUNT];

/** Supplied by the host: takes one event report. Must not call back into Navlib. */
void nav_evr_send(const nav_evr_t *evr);

/** Fills a report from the table and sends it; unused arguments are given as 0. */
void nav_evr_report(
    double time_s, nav_evr_id_t id, double arg0, double arg1, double arg2, double arg3);

#endif
