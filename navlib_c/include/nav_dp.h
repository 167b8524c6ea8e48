/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_dp.h
 * @brief Data products: one table of kinds, the description of every record, and the one exit.
 */
#ifndef NAV_DP_H
#define NAV_DP_H

#include "nav_evr.h"
#include "nav_interface.h"

/** Version of the records' contents; separate from the library's version. */
#define NAV_DP_VERSION 1

/** X(value, NAME, record type, "what it is") */
#define NAV_DP_TABLE(X)                                                                            \
    X(1, INIT_IN, nav_init_in_t, "parameters")                                                     \
    X(2, INIT_OUT, nav_init_out_t, "what nav_init answered")                                       \
    X(3, SET_KIOZ_IN, nav_set_kioz_in_t, "keep-in and keep-out zones")                             \
    X(4, SET_KIOZ_OUT, nav_set_kioz_out_t, "what nav_set_kioz answered")                           \
    X(5, PROCESS_DISPARITY_IN, nav_process_disparity_in_t, "a chunk of a point cloud")             \
    X(6, PROCESS_DISPARITY_OUT, nav_process_disparity_out_t, "what became of it")                  \
    X(7, ANALYZE_TERRAIN_IN, nav_analyze_terrain_in_t, "pose and goal of an analysis")             \
    X(8, ANALYZE_TERRAIN_OUT, nav_analyze_terrain_out_t, "summary of the costmap")                 \
    X(9, SELECT_ARC_IN, nav_select_arc_in_t, "predicted pose, goal, mode")                         \
    X(10, SELECT_ARC_OUT, nav_select_arc_out_t, "the selected arc and path")                       \
    X(11, EVALUATE_ARC_IN, nav_evaluate_arc_in_t, "an arc to check")                               \
    X(12, EVALUATE_ARC_OUT, nav_evaluate_arc_out_t, "whether it is safe, and its margins")         \
    X(13, EVR, nav_evr_t, "an event report")                                                       \
    X(14, TREE, nav_tree_t, "cost and reason of every candidate path")                             \
    X(15, SURFACE, nav_surface_t, "the heightmap as ACE reads it")                                 \
    X(16, COSTMAP, nav_costmap_t, "the costmap")

#define NAV_DP_ROW(value, name, type, doc) NAV_DP_##name = (value),
typedef enum
{
    NAV_DP_TABLE(NAV_DP_ROW) NAV_DP_COUNT = 16
} nav_dp_kind_t;

/** Every record type that stands in a data product, nested ones first. X(type, FIELDS) */
#define NAV_RECORD_TABLE(X)                                                                        \
    X(nav_pose_t, NAV_POSE_FIELDS)                                                                 \
    X(nav_uncertainty_t, NAV_UNCERTAINTY_FIELDS)                                                   \
    X(nav_waydisc_t, NAV_WAYDISC_FIELDS)                                                           \
    X(nav_arc_t, NAV_ARC_FIELDS)                                                                   \
    X(nav_point_t, NAV_POINT_FIELDS)                                                               \
    X(nav_steering_t, NAV_STEERING_FIELDS)                                                         \
    X(nav_zone_t, NAV_ZONE_FIELDS)                                                                 \
    X(nav_cost_cell_t, NAV_COST_CELL_FIELDS)                                                       \
    X(nav_ace_bounds_t, NAV_ACE_BOUNDS_FIELDS)                                                     \
    X(nav_evr_t, NAV_EVR_FIELDS)                                                                   \
    X(nav_init_in_t, NAV_INIT_IN_FIELDS)                                                           \
    X(nav_init_out_t, NAV_INIT_OUT_FIELDS)                                                         \
    X(nav_set_kioz_in_t, NAV_SET_KIOZ_IN_FIELDS)                                                   \
    X(nav_set_kioz_out_t, NAV_SET_KIOZ_OUT_FIELDS)                                                 \
    X(nav_process_disparity_in_t, NAV_PROCESS_DISPARITY_IN_FIELDS)                                 \
    X(nav_process_disparity_out_t, NAV_PROCESS_DISPARITY_OUT_FIELDS)                               \
    X(nav_analyze_terrain_in_t, NAV_ANALYZE_TERRAIN_IN_FIELDS)                                     \
    X(nav_analyze_terrain_out_t, NAV_ANALYZE_TERRAIN_OUT_FIELDS)                                   \
    X(nav_select_arc_in_t, NAV_SELECT_ARC_IN_FIELDS)                                               \
    X(nav_select_arc_out_t, NAV_SELECT_ARC_OUT_FIELDS)                                             \
    X(nav_evaluate_arc_in_t, NAV_EVALUATE_ARC_IN_FIELDS)                                           \
    X(nav_evaluate_arc_out_t, NAV_EVALUATE_ARC_OUT_FIELDS)                                         \
    X(nav_path_t, NAV_PATH_FIELDS)                                                                 \
    X(nav_tree_t, NAV_TREE_FIELDS)                                                                 \
    X(nav_surface_t, NAV_SURFACE_FIELDS)                                                           \
    X(nav_costmap_t, NAV_COSTMAP_FIELDS)

#define NAV_RECORD_ONE(type, FIELDS) +1
#define NAV_RECORD_COUNT (0 NAV_RECORD_TABLE(NAV_RECORD_ONE))

typedef struct
{
    const char *name;
    const char *type; /* a number type, or the name of a record */
    uint32_t count;   /* 1 unless an array */
    uint32_t offset;  /* bytes */
    const char *unit; /* "" for a nested record */
    const char *doc;
} nav_field_def_t;

typedef struct
{
    const char *type;
    uint32_t size; /* bytes */
    uint32_t field_count;
    const nav_field_def_t *fields;
} nav_record_def_t;

typedef struct
{
    uint32_t kind;
    const char *name;
    const char *type; /* of its record */
    const char *doc;
} nav_dp_def_t;

extern const nav_record_def_t nav_record_defs[NAV_RECORD_COUNT];
extern const nav_dp_def_t nav_dp_defs[NAV_DP_COUNT];

/**
 * Supplied by the host: takes one data product.
 * @param size_bytes  the record's true length: a record whose last field is an array ends after the
 *                    entries in use
 * @return NAV_OK, or NAV_SINK when it could not be taken; Navlib reports that and goes on
 */
nav_status_t nav_dp_send(nav_dp_kind_t kind,
                         double time_s,
                         const void *record,
                         uint32_t size_bytes);

#endif
