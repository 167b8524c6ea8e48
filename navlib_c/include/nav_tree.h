/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_tree.h
 * @brief The tree of 14 turns in place x 11 arcs x 11 arcs: ranked by cost, tested from the cheapest.
 */
#ifndef NAV_TREE_H
#define NAV_TREE_H

#include "nav_ace.h"
#include "nav_global.h"

/** Verdict of a branch that has not been tested. */
#define NAV_TREE_UNTESTED 255

/** Candidates: the paths of the tree, and what is left of the path selected before. */
#define NAV_TREE_CANDIDATES (NAV_TREE_PATHS + 1)

/**
 * Last resorts, when no candidate passes: from NAV_TREE_SHORT the first arcs of the tree alone, from
 * NAV_TREE_BACK as many arcs backwards.
 */
#define NAV_TREE_SHORT NAV_TREE_CANDIDATES
#define NAV_TREE_BACK (NAV_TREE_SHORT + NAV_TREE_FIRST_ARCS)
#define NAV_TREE_NONE (NAV_TREE_BACK + NAV_TREE_ARCS)

/** A path as three arcs, any of which may be empty, from an expected pose. */
#define NAV_PATH_FIELDS(S, A, N, M)                                                                \
    S(double, x_site_m, "m", "expected start")                                                     \
    S(double, y_site_m, "m", "expected start")                                                     \
    S(double, yaw_rad, "rad", "expected start")                                                    \
    N(nav_arc_t, turn, "turn in place")                                                            \
    N(nav_arc_t, first, "")                                                                        \
    N(nav_arc_t, second, "")                                                                       \
    S(uint32_t, is_kept, "1", "1 when there is such a path")                                       \
    S(uint32_t, pad_0, "1", "zero")
NAV_RECORD(NAV_PATH_FIELDS, nav_path_t);

/**
 * The tree's path = (turn * NAV_TREE_ARCS + first) * NAV_TREE_ARCS + second. The last candidate,
 * NAV_TREE_PATHS, is the rest of the path selected before: driving 1 m of a path leads to a place
 * from which the tree may not hold what follows. It competes by cost while keep_path_min_m of it are
 * left, and is a last resort after that.
 */
#define NAV_TREE_FIELDS(S, A, N, M)                                                                \
    A(double, path_cost_s, NAV_TREE_CANDIDATES, "s", "1e12 when it crosses an infinite cell")      \
    A(double, first_cost_s, NAV_TREE_FIRST_ARCS, "s", "of a first arc alone")                      \
    N(nav_path_t, kept, "what is left of the selected path")                                       \
    M(nav_ace_bounds_t, turn_bounds, NAV_TREE_TURNS, "worst bounds along a tested turn")           \
    M(nav_ace_bounds_t, first_bounds, NAV_TREE_FIRST_ARCS, "worst bounds to the end of it")        \
    A(uint16_t, order, NAV_TREE_CANDIDATES, "1", "paths by rising cost, then index; kept last")    \
    A(uint8_t, path_reason, NAV_TREE_CANDIDATES, "1", "nav_reason_t")                              \
    A(uint8_t, turn_verdict, NAV_TREE_TURNS, "1", "nav_reason_t of a turn, 255 untested")          \
    A(uint8_t, first_verdict, NAV_TREE_FIRST_ARCS, "1", "of a first arc")                          \
    A(uint8_t, second_verdict, NAV_TREE_PATHS, "1", "of a second arc")                             \
    A(uint8_t, pad_0, 5, "1", "zero")
NAV_RECORD(NAV_TREE_FIELDS, nav_tree_t);

/** Poses of the NAV_TREE_ARCS arcs from a start at the origin heading north, spaced evenly. */
typedef struct
{
    uint32_t pose_count; /* along an arc; the last is its end */
    double heading_change_rad[NAV_TREE_ARCS];
    double forward_m[NAV_TREE_ARCS][NAV_ARC_POSES_MAX];
    double right_m[NAV_TREE_ARCS][NAV_ARC_POSES_MAX];
} nav_tree_shapes_t;

/** Computes the shapes of the arcs from checked parameters. */
void nav_tree_init(const nav_params_t *params, nav_tree_shapes_t *shapes);

#define NAV_SELECT_ARC_IN_FIELDS(S, A, N, M)                                                       \
    S(double, time_s, "s", "")                                                                     \
    N(nav_pose_t, pose, "predicted pose at the end of the current arc")                            \
    N(nav_uncertainty_t, uncertainty, "at that pose")                                              \
    N(nav_waydisc_t, goal, "")                                                                     \
    N(nav_steering_t, steering, "of the current arc")                                              \
    S(uint32_t, mode, "1", "nav_mode_t")                                                           \
    S(uint32_t, pad_0, "1", "zero")
NAV_RECORD(NAV_SELECT_ARC_IN_FIELDS, nav_select_arc_in_t);

#define NAV_SELECT_ARC_OUT_FIELDS(S, A, N, M)                                                      \
    S(uint32_t, status, "1", "nav_status_t: OK or NO_PATH")                                        \
    S(uint32_t, path_index, "1",                                                                   \
      "selected; 1694 rest of the last path, 1695.. first arcs, 1849.. back")                      \
    N(nav_arc_t, arc, "what to drive next")                                                        \
    S(double, path_cost_s, "s", "of the selected path")                                            \
    S(double, cost_to_go_s, "s", "from its end to the goal, part of path_cost_s")                  \
    S(uint32_t, ace_evaluations, "1", "ACE poses evaluated in this call")                          \
    S(uint32_t, paths_tested, "1", "")                                                             \
    S(uint32_t, is_leaving, "1", "1 when only the leave limits let a path pass")                   \
    S(uint32_t, pad_0, "1", "zero")                                                                \
    A(uint32_t, rejections, NAV_REASON_COUNT, "1", "candidates by nav_reason_t")                   \
    N(nav_ace_bounds_t, bounds, "worst of each bound along the selected path")                     \
    S(uint32_t, path_point_count, "1", "")                                                         \
    S(uint32_t, global_point_count, "1", "")                                                       \
    M(nav_point_t, path_points, NAV_PATH_POINTS_MAX, "local path, SITE, z 0")                      \
    M(nav_point_t, global_points, NAV_GLOBAL_POINTS_MAX, "from its end to the goal, SITE, z 0")
NAV_RECORD(NAV_SELECT_ARC_OUT_FIELDS, nav_select_arc_out_t);

/** What the tree reads and, through ACE's feedback, marks. */
typedef struct
{
    nav_ace_scene_t ace;
    const nav_kioz_t *kioz;
    const nav_global_t *global;
    const nav_tree_shapes_t *shapes;
    nav_costmap_t *costmap; /* ACE's feedback is written here */
} nav_tree_scene_t;

#endif
