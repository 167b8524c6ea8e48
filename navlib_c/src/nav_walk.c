/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_walk.c
 * @brief Arcs pose by pose over the costmap.
 */
#include "nav_walk.h"

#include <math.h>
#include <stddef.h>

#include "nav_math.h"

nav_request_t nav_walk_request(const nav_tree_scene_t *scene, const nav_select_arc_in_t *in)
{
    const bool use_terrain_cost = in->mode == (uint32_t) NAV_MODE_AVOID_ALL;
    nav_request_t request = {
        .scene = scene,
        .params = scene->ace.params,
        .in = in,
        .start = {in->pose.x_site_m, in->pose.y_site_m, in->pose.yaw_rad},
        .use_terrain_cost = use_terrain_cost,
        .use_zone_cost = use_terrain_cost || (in->mode == (uint32_t) NAV_MODE_AVOID_KOZ),
        .test_terrain = use_terrain_cost || (in->mode == (uint32_t) NAV_MODE_GUARDED),
        .is_one_path = (in->mode == (uint32_t) NAV_MODE_UNGUARDED) ||
                       (in->mode == (uint32_t) NAV_MODE_GUARDED)};
    request.start_distance_m = nav_walk_goal_distance_m(&request, &request.start);
    return request;
}

nav_arc_t nav_walk_turn(uint32_t turn)
{
    const nav_arc_t arc = {
        0.0, nav_wrap_angle((2.0 * NAV_PI * (double) turn) / (double) NAV_TREE_TURNS)};
    return arc;
}

nav_arc_t nav_walk_tree_arc(const nav_request_t *request, uint32_t k)
{
    const nav_arc_t arc = {request->params->tree_arc_length_m,
                           request->scene->shapes->heading_change_rad[k]};
    return arc;
}

nav_arc_t nav_walk_back_arc(const nav_request_t *request, uint32_t k)
{
    const double length_m = request->params->execute_length_m;
    const double share = length_m / request->params->tree_arc_length_m;
    const nav_arc_t arc = {-length_m, -share * request->scene->shapes->heading_change_rad[k]};
    return arc;
}

static bool is_empty_arc(const nav_arc_t *arc)
{
    return (fabs(arc->length_m) <= NAV_WALK_EMPTY) &&
           (fabs(arc->heading_change_rad) <= NAV_WALK_EMPTY);
}

nav_walk_t nav_walk_tree(const nav_request_t *request, const nav_pose2_t *start, uint32_t k)
{
    const nav_tree_shapes_t *shapes = request->scene->shapes;
    const nav_walk_t walk = {.start = *start,
                             .arc = nav_walk_tree_arc(request, k),
                             .pose_count = shapes->pose_count,
                             .spacing_m =
                                 request->params->tree_arc_length_m / (double) shapes->pose_count,
                             .shapes = shapes,
                             .shape = k,
                             .cos_sin = {nav_cos(start->yaw_rad), nav_sin(start->yaw_rad)}};
    return walk;
}

nav_walk_t nav_walk_arc(const nav_request_t *request,
                        const nav_pose2_t *start,
                        const nav_arc_t *arc)
{
    nav_walk_t walk = {.start = *start, .arc = *arc};
    if (!is_empty_arc(arc))
    {
        walk.pose_count = nav_arc_pose_count(request->params, arc);
        walk.spacing_m = fabs(arc->length_m) / (double) walk.pose_count;
    }
    return walk;
}

nav_pose2_t nav_walk_pose(const nav_walk_t *walk, uint32_t place)
{
    const double fraction = (double) (place + 1U) / (double) walk->pose_count;
    nav_pose2_t pose = walk->start;
    if (walk->shapes != NULL)
    {
        const double forward_m = walk->shapes->forward_m[walk->shape][place];
        const double right_m = walk->shapes->right_m[walk->shape][place];
        pose.x_m = pose.x_m + (forward_m * walk->cos_sin[0]) - (right_m * walk->cos_sin[1]);
        pose.y_m = pose.y_m + (forward_m * walk->cos_sin[1]) + (right_m * walk->cos_sin[0]);
        pose.yaw_rad += fraction * walk->shapes->heading_change_rad[walk->shape];
    }
    else
    {
        pose = nav_arc_pose(&walk->start, &walk->arc, fraction);
    }
    return pose;
}

double nav_walk_goal_distance_m(const nav_request_t *request, const nav_pose2_t *pose)
{
    const double dx_m = request->in->goal.x_site_m - pose->x_m;
    const double dy_m = request->in->goal.y_site_m - pose->y_m;
    return sqrt((dx_m * dx_m) + (dy_m * dy_m));
}

/** Cost per metre of the cell under a pose beyond plain driving time, and why it is infinite if so. */
static nav_reason_t terrain_cost(const nav_request_t *request,
                                 const nav_pose2_t *pose,
                                 double *cost_s_per_m)
{
    const double plain_s_per_m = 1.0 / request->params->speed_max_m_per_s;
    nav_reason_t reason = NAV_REASON_NONE;
    uint32_t index = 0U;
    if (nav_costmap_find(request->scene->costmap, pose->x_m, pose->y_m, &index))
    {
        /* cells that ACE closed may be crossed: ACE judges every pose itself */
        nav_cost_cell_t cell = request->scene->costmap->cells[index];
        const uint32_t barred = nav_costmap_barred(&cell);
        cell.ace_failed_headings = 0U;
        reason = nav_costmap_reason(&cell, request->use_terrain_cost, request->use_zone_cost);
        *cost_s_per_m = 0.0;
        if (request->use_terrain_cost)
        {
            const bool is_barred = ((barred >> nav_costmap_heading(pose->yaw_rad)) & 1U) != 0U;
            *cost_s_per_m = ((double) cell.cost_s_per_m *
                             (is_barred ? request->params->cost_barred_factor : 1.0)) -
                            plain_s_per_m;
        }
    }
    else
    {
        *cost_s_per_m = request->use_terrain_cost
                            ? (plain_s_per_m * (request->params->cost_unknown_factor - 1.0))
                            : 0.0;
    }
    return reason;
}

nav_branch_t nav_walk_follow(const nav_request_t *request, const nav_walk_t *walk)
{
    nav_branch_t branch = {walk->start, 0.0, 0U, false, NAV_REASON_NONE};

    for (uint32_t place = 0U; (place < walk->pose_count) && !branch.is_at_goal; place++)
    {
        double cost_s_per_m = 0.0;
        branch.end = nav_walk_pose(walk, place);
        const nav_reason_t reason = terrain_cost(request, &branch.end, &cost_s_per_m);
        branch.reason = (branch.reason == NAV_REASON_NONE) ? reason : branch.reason;
        branch.cost_s += cost_s_per_m * walk->spacing_m;
        branch.is_at_goal =
            nav_walk_goal_distance_m(request, &branch.end) <= request->in->goal.radius_m;
        branch.pose_count = place + 1U;
    }
    if (branch.pose_count > 0U)
    {
        branch.cost_s += nav_arc_duration_s(request->params, &walk->arc) *
                         (double) branch.pose_count / (double) walk->pose_count;
    }
    return branch;
}

nav_branch_t nav_walk_follow_arc(const nav_request_t *request,
                                 const nav_pose2_t *start,
                                 const nav_arc_t *arc)
{
    const nav_walk_t walk = nav_walk_arc(request, start, arc);
    return nav_walk_follow(request, &walk);
}

nav_branch_t nav_walk_follow_first(const nav_request_t *request, uint32_t node)
{
    const nav_arc_t turning = nav_walk_turn(node / (uint32_t) NAV_TREE_ARCS);
    const nav_pose2_t turned = nav_arc_pose(&request->start, &turning, 1.0);
    const nav_walk_t walk = nav_walk_tree(request, &turned, node % (uint32_t) NAV_TREE_ARCS);
    return nav_walk_follow(request, &walk);
}
