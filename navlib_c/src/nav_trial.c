/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_trial.c
 * @brief Tests walks and paths pose by pose.
 */
#include "nav_trial.h"

#include <math.h>

#include "nav_math.h"
#include "nav_minmax.h"

#define TURNS ((uint32_t) NAV_TREE_TURNS)
#define ARCS ((uint32_t) NAV_TREE_ARCS)

static void worsen(nav_ace_bounds_t *worst, const nav_ace_bounds_t *bounds)
{
    worst->clearance_min_m = nav_min(worst->clearance_min_m, bounds->clearance_min_m);
    worst->wheel_drop_max_m = nav_max(worst->wheel_drop_max_m, bounds->wheel_drop_max_m);
    worst->tilt_max_rad = nav_max(worst->tilt_max_rad, bounds->tilt_max_rad);
    worst->z_min_site_m = nav_min(worst->z_min_site_m, bounds->z_min_site_m);
    worst->z_max_site_m = nav_max(worst->z_max_site_m, bounds->z_max_site_m);
    worst->roll_min_rad = nav_min(worst->roll_min_rad, bounds->roll_min_rad);
    worst->roll_max_rad = nav_max(worst->roll_max_rad, bounds->roll_max_rad);
    worst->pitch_min_rad = nav_min(worst->pitch_min_rad, bounds->pitch_min_rad);
    worst->pitch_max_rad = nav_max(worst->pitch_max_rad, bounds->pitch_max_rad);
    worst->rocker_min_rad = nav_min(worst->rocker_min_rad, bounds->rocker_min_rad);
    worst->rocker_max_rad = nav_max(worst->rocker_max_rad, bounds->rocker_max_rad);
    worst->bogie_left_min_rad = nav_min(worst->bogie_left_min_rad, bounds->bogie_left_min_rad);
    worst->bogie_left_max_rad = nav_max(worst->bogie_left_max_rad, bounds->bogie_left_max_rad);
    worst->bogie_right_min_rad = nav_min(worst->bogie_right_min_rad, bounds->bogie_right_min_rad);
    worst->bogie_right_max_rad = nav_max(worst->bogie_right_max_rad, bounds->bogie_right_max_rad);
    worst->wheel_unknown = nav_max(worst->wheel_unknown, bounds->wheel_unknown);
    worst->belly_unknown = nav_max(worst->belly_unknown, bounds->belly_unknown);
    worst->is_certified = worst->is_certified & bounds->is_certified;
}

void nav_trial_best(nav_ace_bounds_t *bounds)
{
    *bounds = (nav_ace_bounds_t){.clearance_min_m = NAV_COST_INFINITE,
                                 .z_min_site_m = NAV_COST_INFINITE,
                                 .z_max_site_m = -NAV_COST_INFINITE,
                                 .roll_min_rad = NAV_PI,
                                 .roll_max_rad = -NAV_PI,
                                 .pitch_min_rad = NAV_PI,
                                 .pitch_max_rad = -NAV_PI,
                                 .rocker_min_rad = NAV_PI,
                                 .rocker_max_rad = -NAV_PI,
                                 .bogie_left_min_rad = NAV_PI,
                                 .bogie_left_max_rad = -NAV_PI,
                                 .bogie_right_min_rad = NAV_PI,
                                 .bogie_right_max_rad = -NAV_PI,
                                 .is_certified = 1U};
}

void nav_trial_begin(nav_trial_t *trial)
{
    nav_tree_t *tree = trial->tree;
    for (uint32_t k = 0U; k < TURNS; k++)
    {
        tree->turn_verdict[k] = (uint8_t) NAV_TREE_UNTESTED;
        nav_trial_best(&tree->turn_bounds[k]);
    }
    for (uint32_t k = 0U; k < (uint32_t) NAV_TREE_FIRST_ARCS; k++)
    {
        tree->first_verdict[k] = (uint8_t) NAV_TREE_UNTESTED;
        nav_trial_best(&tree->first_bounds[k]);
    }
    for (uint32_t k = 0U; k < (uint32_t) NAV_TREE_PATHS; k++)
    {
        tree->second_verdict[k] = (uint8_t) NAV_TREE_UNTESTED;
    }
}

/** Tests one pose, distance_m along the path, by zones and by ACE as the mode demands. */
static nav_reason_t test_pose(nav_trial_t *trial,
                              const nav_pose2_t *pose,
                              double distance_m,
                              nav_ace_bounds_t *worst)
{
    const nav_request_t *request = trial->request;
    nav_reason_t reason = NAV_REASON_NONE;
    if (nav_kioz_forbids(request->scene->kioz, pose->x_m, pose->y_m,
                         request->in->uncertainty.global_position_m))
    {
        reason = NAV_REASON_KIOZ;
    }
    else if (request->test_terrain)
    {
        const nav_uncertainty_t grown =
            nav_ace_grow(request->params, &request->in->uncertainty, distance_m);
        const bool is_leaving =
            trial->is_leaving && (distance_m <= request->params->leave_length_m);
        nav_ace_bounds_t bounds;
        nav_ace_evaluate(&request->scene->ace, pose, &grown, is_leaving, &bounds);
        trial->ace_evaluations++;
        worsen(worst, &bounds);
        reason = (nav_reason_t) bounds.reason;
        nav_costmap_feedback(request->scene->costmap, pose, reason);
    }
    else
    {
        reason = NAV_REASON_NONE;
    }
    return reason;
}

/**
 * Tests an arc or turn that begins distance_m along the path, up to the waydisc or to the first pose
 * that fails, and worsens the bounds.
 */
static nav_reason_t test_walk(nav_trial_t *trial,
                              const nav_walk_t *walk,
                              double distance_m,
                              nav_ace_bounds_t *bounds)
{
    const nav_request_t *request = trial->request;
    const bool is_turn = fabs(walk->arc.length_m) <= NAV_WALK_EMPTY;
    nav_reason_t reason = NAV_REASON_NONE;
    bool is_at_goal = false;

    for (uint32_t place = 0U;
         (place < walk->pose_count) && (reason == NAV_REASON_NONE) && !is_at_goal; place++)
    {
        const nav_pose2_t pose = nav_walk_pose(walk, place);
        reason =
            test_pose(trial, &pose, distance_m + ((double) (place + 1U) * walk->spacing_m), bounds);
        is_at_goal =
            !is_turn && (nav_walk_goal_distance_m(request, &pose) <= request->in->goal.radius_m);
    }
    return reason;
}

/** Tests any arc or turn in place that begins distance_m along the path. */
static nav_reason_t test_arc(nav_trial_t *trial,
                             const nav_pose2_t *start,
                             const nav_arc_t *arc,
                             double distance_m,
                             nav_ace_bounds_t *bounds)
{
    const nav_walk_t walk = nav_walk_arc(trial->request, start, arc);
    return test_walk(trial, &walk, distance_m, bounds);
}

nav_reason_t nav_trial_arc(nav_trial_t *trial, const nav_arc_t *arc, nav_ace_bounds_t *bounds)
{
    return test_arc(trial, &trial->request->start, arc, 0.0, bounds);
}

static bool is_refused(uint8_t verdict)
{
    return (verdict != (uint8_t) NAV_REASON_NONE) && (verdict != (uint8_t) NAV_TREE_UNTESTED);
}

bool nav_trial_may_pass(const nav_trial_t *trial, uint32_t node)
{
    return !is_refused(trial->tree->turn_verdict[node / ARCS]) &&
           !is_refused(trial->tree->first_verdict[node]);
}

static nav_reason_t test_turn(nav_trial_t *trial, uint32_t turn)
{
    nav_tree_t *tree = trial->tree;
    if (tree->turn_verdict[turn] == (uint8_t) NAV_TREE_UNTESTED)
    {
        const nav_arc_t turning = nav_walk_turn(turn);
        tree->turn_verdict[turn] =
            (uint8_t) nav_trial_arc(trial, &turning, &tree->turn_bounds[turn]);
    }
    return (nav_reason_t) tree->turn_verdict[turn];
}

nav_reason_t nav_trial_first(nav_trial_t *trial, uint32_t node)
{
    nav_tree_t *tree = trial->tree;
    const uint32_t turn = node / ARCS;
    nav_reason_t reason = test_turn(trial, turn);
    if (reason == NAV_REASON_NONE)
    {
        if (tree->first_verdict[node] == (uint8_t) NAV_TREE_UNTESTED)
        {
            const nav_arc_t turning = nav_walk_turn(turn);
            const nav_pose2_t turned = nav_arc_pose(&trial->request->start, &turning, 1.0);
            const nav_walk_t walk = nav_walk_tree(trial->request, &turned, node % ARCS);
            tree->first_bounds[node] = tree->turn_bounds[turn];
            tree->first_verdict[node] =
                (uint8_t) test_walk(trial, &walk, 0.0, &tree->first_bounds[node]);
        }
        reason = (nav_reason_t) tree->first_verdict[node];
    }
    return reason;
}

nav_reason_t nav_trial_second(nav_trial_t *trial, uint32_t path, nav_ace_bounds_t *bounds)
{
    const nav_request_t *request = trial->request;
    const uint32_t node = path / ARCS;
    const nav_branch_t first = nav_walk_follow_first(request, node);
    nav_reason_t reason = NAV_REASON_NONE;
    *bounds = trial->tree->first_bounds[node];
    if (!first.is_at_goal)
    {
        const nav_walk_t walk = nav_walk_tree(request, &first.end, path % ARCS);
        reason = test_walk(trial, &walk, request->params->tree_arc_length_m, bounds);
    }
    trial->tree->second_verdict[path] = (uint8_t) reason;
    return reason;
}

nav_reason_t nav_trial_kept(nav_trial_t *trial, nav_ace_bounds_t *bounds)
{
    const nav_request_t *request = trial->request;
    const nav_path_t *kept = &trial->tree->kept;
    const nav_pose2_t turned = nav_arc_pose(&request->start, &kept->turn, 1.0);
    const nav_branch_t first = nav_walk_follow_arc(request, &turned, &kept->first);
    nav_trial_best(bounds);
    nav_reason_t reason = nav_trial_arc(trial, &kept->turn, bounds);
    if (reason == NAV_REASON_NONE)
    {
        reason = test_arc(trial, &turned, &kept->first, 0.0, bounds);
    }
    if ((reason == NAV_REASON_NONE) && !first.is_at_goal)
    {
        reason = test_arc(trial, &first.end, &kept->second, kept->first.length_m, bounds);
    }
    return reason;
}
