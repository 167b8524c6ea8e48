/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_show.c
 * @brief What of the selected path is driven, shown and kept.
 */
#include "nav_show.h"

#include <math.h>

#include "nav_math.h"
#include "nav_minmax.h"
#include "nav_rank.h"

#define TURNS ((uint32_t) NAV_TREE_TURNS)
#define ARCS ((uint32_t) NAV_TREE_ARCS)

static void add_point(nav_select_arc_out_t *out, const nav_pose2_t *pose)
{
    if (out->path_point_count < (uint32_t) NAV_PATH_POINTS_MAX)
    {
        nav_point_t *point = &out->path_points[out->path_point_count];
        point->x_m = (float) pose->x_m;
        point->y_m = (float) pose->y_m;
        out->path_point_count++;
    }
}

/** How far a turn is driven before the next planning: whole steps between the turns of the tree, so
 * that what remains is again a turn of the tree and the next plan can go on with it. */
static double executed_turn_rad(const nav_params_t *params, double turn_rad)
{
    const double step_rad = (2.0 * NAV_PI) / (double) TURNS;
    const double steps = nav_max(floor((params->execute_turn_rad / step_rad) + 1.0e-9), 1.0);
    return nav_clamp(turn_rad, -steps * step_rad, steps * step_rad);
}

/** The selected candidate as arcs from the start of the call. */
static nav_path_t selected_path(const nav_request_t *request, const nav_tree_t *tree, uint32_t path)
{
    nav_path_t selected = tree->kept;
    if (path >= (uint32_t) NAV_TREE_BACK)
    {
        selected =
            (nav_path_t){.first = nav_walk_back_arc(request, path - (uint32_t) NAV_TREE_BACK)};
    }
    else if (path >= (uint32_t) NAV_TREE_SHORT)
    {
        const uint32_t node = path - (uint32_t) NAV_TREE_SHORT;
        selected = (nav_path_t){.turn = nav_walk_turn(node / ARCS),
                                .first = nav_walk_tree_arc(request, node % ARCS)};
    }
    else if (path != NAV_RANK_KEPT)
    {
        const uint32_t node = path / ARCS;
        selected.turn = nav_walk_turn(node / ARCS);
        selected.first = nav_walk_tree_arc(request, node % ARCS);
        selected.second = nav_walk_tree_arc(request, path % ARCS);
    }
    else
    {
        /* the kept one */
    }
    return selected;
}

/** The given length from the front of an arc. */
static nav_arc_t arc_front(const nav_arc_t *arc, double length_m)
{
    const nav_arc_t front = {length_m, arc->heading_change_rad * (length_m / arc->length_m)};
    return front;
}

/** The part of a path that is driven: the first metre, up to the waydisc, or steps of a turn. */
static nav_arc_t executed_arc(const nav_request_t *request,
                              const nav_path_t *path,
                              const nav_branch_t *first)
{
    nav_arc_t arc = {0.0, 0.0};
    if (fabs(path->turn.heading_change_rad) > NAV_WALK_EMPTY)
    {
        arc.heading_change_rad = executed_turn_rad(request->params, path->turn.heading_change_rad);
    }
    else
    {
        const double share =
            (double) first->pose_count / (double) nav_arc_pose_count(request->params, &path->first);
        const double most_m = request->params->execute_length_m;
        arc = arc_front(&path->first, nav_clamp(path->first.length_m * share, -most_m, most_m));
    }
    return arc;
}

/** What is left of a path when its first part has been driven; nothing when that was all. */
static nav_path_t rest_of_path(const nav_request_t *request,
                               const nav_path_t *path,
                               const nav_arc_t *driven)
{
    const nav_pose2_t end = nav_arc_pose(&request->start, driven, 1.0);
    nav_path_t rest = *path;
    rest.x_site_m = end.x_m;
    rest.y_site_m = end.y_m;
    rest.yaw_rad = end.yaw_rad;
    if (fabs(path->turn.heading_change_rad) > NAV_WALK_EMPTY)
    {
        rest.turn.heading_change_rad -= driven->heading_change_rad;
    }
    else if ((path->first.length_m - driven->length_m) > NAV_WALK_EMPTY)
    {
        rest.first.length_m -= driven->length_m;
        rest.first.heading_change_rad -= driven->heading_change_rad;
    }
    else
    {
        rest.first = path->second;
        rest.second.length_m = 0.0;
        rest.second.heading_change_rad = 0.0;
    }
    rest.is_kept = (rest.first.length_m > NAV_WALK_EMPTY) ? 1U : 0U;
    return rest;
}

/** Adds the poses that a branch drives to the shown path. */
static void show_walk(const nav_walk_t *walk, const nav_branch_t *branch, nav_select_arc_out_t *out)
{
    for (uint32_t place = 0U; place < branch->pose_count; place++)
    {
        const nav_pose2_t pose = nav_walk_pose(walk, place);
        add_point(out, &pose);
    }
}

void nav_show_path(const nav_request_t *request, nav_tree_t *tree, nav_select_arc_out_t *out)
{
    const nav_path_t path = selected_path(request, tree, out->path_index);
    const nav_pose2_t turned = nav_arc_pose(&request->start, &path.turn, 1.0);
    const nav_walk_t along = nav_walk_arc(request, &turned, &path.first);
    const nav_branch_t first = nav_walk_follow(request, &along);
    nav_branch_t leaf = first;
    double to_go_s = 0.0;

    add_point(out, &request->start);
    show_walk(&along, &first, out);
    if (!first.is_at_goal)
    {
        const nav_walk_t onward = nav_walk_arc(request, &first.end, &path.second);
        leaf = nav_walk_follow(request, &onward);
        show_walk(&onward, &leaf, out);
    }
    (void) nav_rank_to_go(request, &leaf, &to_go_s);
    out->arc = executed_arc(request, &path, &first);
    out->cost_to_go_s = to_go_s;
    if (!leaf.is_at_goal && (request->use_terrain_cost || request->use_zone_cost))
    {
        out->global_point_count =
            nav_global_descend(request->scene->global, request->scene->costmap, leaf.end.x_m,
                               leaf.end.y_m, out->global_points, (uint32_t) NAV_GLOBAL_POINTS_MAX);
    }
    tree->kept = rest_of_path(request, &path, &out->arc);
}
