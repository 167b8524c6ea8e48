/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_interface.h
 * @brief The six calls of Navlib. Their in and out structs are themselves the data products.
 *
 * Every call checks every input before it changes anything, returns one status, writes the same
 * status into out, reports refusals as EVRs, and sends in and out as data products. A refused call
 * leaves the context as it was. in and out must not overlap; a context belongs to one thread.
 */
#ifndef NAV_INTERFACE_H
#define NAV_INTERFACE_H

#include "nav_context.h"

#define NAV_INIT_IN_FIELDS(S, A, N, M)                                                             \
    S(double, time_s, "s", "")                                                                     \
    A(double, params, NAV_PARAM_COUNT, "1", "nav_params_t, in the order of its table")
NAV_RECORD(NAV_INIT_IN_FIELDS, nav_init_in_t);

#define NAV_INIT_OUT_FIELDS(S, A, N, M)                                                            \
    S(uint32_t, status, "1", "nav_status_t")                                                       \
    S(uint32_t, refused_index, "1", "parameter refused, or the number of parameters")
NAV_RECORD(NAV_INIT_OUT_FIELDS, nav_init_out_t);

#define NAV_SET_KIOZ_IN_FIELDS(S, A, N, M)                                                         \
    S(double, time_s, "s", "")                                                                     \
    S(uint32_t, zone_count, "1", "zones used")                                                     \
    S(uint32_t, pad_0, "1", "zero")                                                                \
    M(nav_zone_t, zones, NAV_ZONES_MAX, "recorded to zone_count")
NAV_RECORD(NAV_SET_KIOZ_IN_FIELDS, nav_set_kioz_in_t);

#define NAV_SET_KIOZ_OUT_FIELDS(S, A, N, M)                                                        \
    S(uint32_t, status, "1", "nav_status_t")                                                       \
    S(uint32_t, refused_index, "1", "zone refused, or zone_count")
NAV_RECORD(NAV_SET_KIOZ_OUT_FIELDS, nav_set_kioz_out_t);

#define NAV_PROCESS_DISPARITY_IN_FIELDS(S, A, N, M)                                                \
    S(double, time_s, "s", "of the imaging")                                                       \
    N(nav_pose_t, pose, "estimated pose at the imaging")                                           \
    S(uint32_t, image_id, "1", "one number for all chunks of an image, never used again")          \
    S(uint32_t, chunk_index, "1", "0 to chunk_count - 1, in order")                                \
    S(uint32_t, chunk_count, "1", "at least 1")                                                    \
    S(uint32_t, point_count, "1", "points used")                                                   \
    M(nav_point_t, points, NAV_CHUNK_POINTS_MAX, "ROVER at the pose; recorded to point_count")
NAV_RECORD(NAV_PROCESS_DISPARITY_IN_FIELDS, nav_process_disparity_in_t);

#define NAV_PROCESS_DISPARITY_OUT_FIELDS(S, A, N, M)                                               \
    S(uint32_t, status, "1", "nav_status_t")                                                       \
    S(uint32_t, merged_count, "1", "points merged")                                                \
    S(uint32_t, outside_count, "1", "points outside the map")                                      \
    S(uint32_t, pad_0, "1", "zero")
NAV_RECORD(NAV_PROCESS_DISPARITY_OUT_FIELDS, nav_process_disparity_out_t);

#define NAV_ANALYZE_TERRAIN_IN_FIELDS(S, A, N, M)                                                  \
    S(double, time_s, "s", "")                                                                     \
    N(nav_pose_t, pose, "estimated pose now")                                                      \
    N(nav_waydisc_t, goal, "")                                                                     \
    S(double, global_position_m, "m", "position uncertainty in SITE: grows zones")
NAV_RECORD(NAV_ANALYZE_TERRAIN_IN_FIELDS, nav_analyze_terrain_in_t);

#define NAV_ANALYZE_TERRAIN_OUT_FIELDS(S, A, N, M)                                                 \
    S(uint32_t, status, "1", "nav_status_t")                                                       \
    S(uint32_t, is_recentered, "1", "1 when the costmap was recentred")                            \
    S(uint32_t, is_goal_inside, "1", "1 when the goal lies on the costmap")                        \
    S(uint32_t, known_count, "1", "costmap cells with a plane")                                    \
    A(uint32_t, infinite, NAV_REASON_COUNT, "1", "costmap cells by nav_reason_t")                  \
    S(double, heightmap_min_x_site_m, "m", "south edge of the heightmap")                          \
    S(double, heightmap_min_y_site_m, "m", "west edge of the heightmap")                           \
    S(double, costmap_min_x_site_m, "m", "south edge of the costmap")                              \
    S(double, costmap_min_y_site_m, "m", "west edge of the costmap")
NAV_RECORD(NAV_ANALYZE_TERRAIN_OUT_FIELDS, nav_analyze_terrain_out_t);

#define NAV_EVALUATE_ARC_IN_FIELDS(S, A, N, M)                                                     \
    S(double, time_s, "s", "")                                                                     \
    N(nav_pose_t, pose, "where the arc starts")                                                    \
    N(nav_uncertainty_t, uncertainty, "at that pose")                                              \
    N(nav_arc_t, arc, "any length up to 10 m either way, or a turn in place")                      \
    S(uint32_t, mode, "1", "nav_mode_t: which checks to make")                                     \
    S(uint32_t, is_leaving, "1", "1 for an arc that select_arc passed by the leave limits")
NAV_RECORD(NAV_EVALUATE_ARC_IN_FIELDS, nav_evaluate_arc_in_t);

#define NAV_EVALUATE_ARC_OUT_FIELDS(S, A, N, M)                                                    \
    S(uint32_t, status, "1", "nav_status_t")                                                       \
    S(uint32_t, is_safe, "1", "1 when no pose fails")                                              \
    S(uint32_t, reason, "1", "nav_reason_t of the first failing pose")                             \
    S(uint32_t, failing_index, "1", "first failing pose, or pose_count")                           \
    S(double, failing_at, "m or rad", "its distance along the arc, its angle in a turn in place")  \
    S(uint32_t, pose_count, "1", "")                                                               \
    S(uint32_t, pad_0, "1", "zero")                                                                \
    M(nav_ace_bounds_t, bounds, NAV_ARC_POSES_MAX, "margins along the arc; to pose_count")
NAV_RECORD(NAV_EVALUATE_ARC_OUT_FIELDS, nav_evaluate_arc_out_t);

/**
 * Checks the parameters, clears the state. Any context may be given, new or used.
 * @return NAV_OK, NAV_NULL_POINTER, NAV_NOT_FINITE (time), NAV_PARAMETER_RANGE, NAV_PARAMETER_CONFLICT
 */
nav_status_t nav_init(nav_ctx_t *ctx, const nav_init_in_t *in, nav_init_out_t *out);

/**
 * Replaces all keep-in and keep-out zones; they take effect in the costmap at the next analysis.
 * @return NAV_OK, NAV_NULL_POINTER, NAV_NOT_INITIALIZED, NAV_NOT_FINITE, NAV_COUNT, NAV_ZONE, NAV_ORDER
 */
nav_status_t nav_set_kioz(nav_ctx_t *ctx, const nav_set_kioz_in_t *in, nav_set_kioz_out_t *out);

/**
 * Merges a chunk of a point cloud into the heightmap, which is centred on the imaging pose first.
 * Chunks of an image come in order. The time is that of the imaging, which may lie before other calls.
 * @return NAV_OK, NAV_NULL_POINTER, NAV_NOT_INITIALIZED, NAV_NOT_FINITE, NAV_OUT_OF_RANGE, NAV_COUNT,
 *         NAV_ORDER
 */
nav_status_t nav_process_disparity(nav_ctx_t *ctx,
                                   const nav_process_disparity_in_t *in,
                                   nav_process_disparity_out_t *out);

/**
 * Centres the heightmap on the rover, recentres the costmap when the rover is near its edge, and
 * recomputes the costs. At least one image must have been merged.
 * @return NAV_OK, NAV_NULL_POINTER, NAV_NOT_INITIALIZED, NAV_NOT_FINITE, NAV_OUT_OF_RANGE, NAV_ORDER
 */
nav_status_t nav_analyze_terrain(nav_ctx_t *ctx,
                                 const nav_analyze_terrain_in_t *in,
                                 nav_analyze_terrain_out_t *out);

/**
 * Chooses the next arc. The terrain must have been analyzed. Changes only ACE's feedback in the costmap.
 * @return NAV_OK, NAV_NO_PATH, NAV_NULL_POINTER, NAV_NOT_INITIALIZED, NAV_NOT_FINITE, NAV_OUT_OF_RANGE,
 *         NAV_ORDER
 */
nav_status_t nav_select_arc(nav_ctx_t *ctx,
                            const nav_select_arc_in_t *in,
                            nav_select_arc_out_t *out);

/**
 * Is one arc safe? Checks zones and terrain as the mode demands, at poses along the arc; the start,
 * where the rover stands already, is not one of them, but an arc without length and heading change
 * is the pose itself. Changes nothing. An unsafe arc is an answer, not an error: NAV_OK, is_safe 0.
 * @return NAV_OK, NAV_NULL_POINTER, NAV_NOT_INITIALIZED, NAV_NOT_FINITE, NAV_OUT_OF_RANGE, NAV_ORDER
 */
nav_status_t nav_evaluate_arc(nav_ctx_t *ctx,
                              const nav_evaluate_arc_in_t *in,
                              nav_evaluate_arc_out_t *out);

#endif
