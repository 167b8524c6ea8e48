/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_rank.c
 * @brief Costs of the candidates, and their order.
 */
#include "nav_rank.h"

#include <math.h>

#include "nav_guard.h"
#include "nav_math.h"

#define TURNS ((uint32_t) NAV_TREE_TURNS)
#define ARCS ((uint32_t) NAV_TREE_ARCS)
#define PATHS ((uint32_t) NAV_TREE_PATHS)

/* The rest of a path is of use only where it was expected to begin. */
#define KEPT_DISTANCE_MAX_M 0.5
#define KEPT_YAW_MAX_RAD 0.2

nav_reason_t nav_rank_to_go(const nav_request_t *request, const nav_branch_t *leaf, double *cost_s)
{
    nav_reason_t reason = NAV_REASON_NONE;
    const double distance_m = nav_walk_goal_distance_m(request, &leaf->end);
    *cost_s = 0.0;
    if (leaf->is_at_goal)
    {
        reason = NAV_REASON_NONE;
    }
    else if ((distance_m - request->start_distance_m) > request->params->negative_progress_max_m)
    {
        reason = NAV_REASON_NEGATIVE_PROGRESS;
    }
    else if (request->use_terrain_cost || request->use_zone_cost)
    {
        *cost_s = nav_global_cost_to_go_s(request->scene->global, request->scene->costmap,
                                          request->params, &request->in->goal, leaf->end.x_m,
                                          leaf->end.y_m);
    }
    else
    {
        *cost_s = distance_m / request->params->speed_max_m_per_s;
    }
    return reason;
}

/** Why no way leads on from a leaf whose cost-to-go is infinite. */
static nav_reason_t leaf_reason(const nav_request_t *request, const nav_branch_t *leaf)
{
    nav_reason_t reason = NAV_REASON_UNEXPECTED;
    uint32_t index = 0U;
    if (nav_costmap_find(request->scene->costmap, leaf->end.x_m, leaf->end.y_m, &index))
    {
        reason = nav_costmap_reason(&request->scene->costmap->cells[index],
                                    request->use_terrain_cost, request->use_zone_cost);
        reason = (reason == NAV_REASON_NONE) ? NAV_REASON_UNEXPECTED : reason;
    }
    return reason;
}

static double steering_s(const nav_request_t *request,
                         const nav_steering_t *from,
                         const nav_arc_t *arc)
{
    const nav_steering_t to = nav_arc_steering(arc);
    return nav_arc_steering_duration_s(request->params, from, &to);
}

nav_reason_t nav_rank_path(const nav_request_t *request,
                           double before_s,
                           const nav_branch_t *leaf,
                           double *cost_s)
{
    double to_go_s = 0.0;
    nav_reason_t reason = leaf->reason;
    if (reason == NAV_REASON_NONE)
    {
        reason = nav_rank_to_go(request, leaf, &to_go_s);
    }
    if ((reason == NAV_REASON_NONE) && (to_go_s >= NAV_COST_INFINITE))
    {
        reason = leaf_reason(request, leaf);
    }
    *cost_s = (reason == NAV_REASON_NONE) ? (before_s + leaf->cost_s + to_go_s) : NAV_COST_INFINITE;
    return reason;
}

double nav_rank_arc(const nav_request_t *request, const nav_arc_t *arc)
{
    const nav_branch_t leaf = nav_walk_follow_arc(request, &request->start, arc);
    double cost_s = NAV_COST_INFINITE;
    (void) nav_rank_path(request, steering_s(request, &request->in->steering, arc), &leaf, &cost_s);
    return cost_s;
}

static void path_rank(const nav_request_t *request,
                      nav_tree_t *tree,
                      uint32_t path,
                      double before_s,
                      const nav_branch_t *leaf)
{
    tree->path_reason[path] =
        (uint8_t) nav_rank_path(request, before_s, leaf, &tree->path_cost_s[path]);
}

/** Ranks the 11 paths that go on from a first arc. */
static void rank_seconds(const nav_request_t *request,
                         nav_tree_t *tree,
                         uint32_t node,
                         const nav_branch_t *first,
                         double before_s)
{
    const nav_arc_t arc = nav_walk_tree_arc(request, node % ARCS);
    const nav_steering_t steering = nav_arc_steering(&arc);
    for (uint32_t k = 0U; k < ARCS; k++)
    {
        const uint32_t path = (node * ARCS) + k;
        const nav_arc_t next = nav_walk_tree_arc(request, k);
        nav_branch_t leaf = *first;
        leaf.cost_s = 0.0;
        double cost_s = before_s + first->cost_s;
        if ((first->reason == NAV_REASON_NONE) && !first->is_at_goal)
        {
            const nav_walk_t walk = nav_walk_tree(request, &first->end, k);
            leaf = nav_walk_follow(request, &walk);
            cost_s += steering_s(request, &steering, &next);
        }
        path_rank(request, tree, path, cost_s, &leaf);
    }
}

/** Adds the rest of the path selected before to the candidates, if the rover is where it begins and
 * the mode looks for more than one path. @return whether it is one of them */
static bool rank_kept(const nav_request_t *request, nav_tree_t *tree)
{
    const nav_path_t *kept = &tree->kept;
    const double dx_m = kept->x_site_m - request->start.x_m;
    const double dy_m = kept->y_site_m - request->start.y_m;
    const double turned_rad = nav_wrap_angle(kept->yaw_rad - request->start.yaw_rad);
    const bool is_turn = fabs(kept->turn.heading_change_rad) > NAV_WALK_EMPTY;
    const bool is_candidate =
        (kept->is_kept != 0U) && !request->is_one_path && (fabs(turned_rad) <= KEPT_YAW_MAX_RAD) &&
        (((dx_m * dx_m) + (dy_m * dy_m)) <= (KEPT_DISTANCE_MAX_M * KEPT_DISTANCE_MAX_M));
    if (is_candidate)
    {
        const nav_pose2_t turned = nav_arc_pose(&request->start, &kept->turn, 1.0);
        const nav_steering_t in_place = nav_arc_steering(&kept->turn);
        const nav_steering_t along_first = nav_arc_steering(&kept->first);
        double cost_s = 0.0;
        if (is_turn)
        {
            cost_s = steering_s(request, &request->in->steering, &kept->turn) +
                     nav_arc_duration_s(request->params, &kept->turn);
        }
        cost_s += steering_s(request, is_turn ? &in_place : &request->in->steering, &kept->first);
        const nav_branch_t first = nav_walk_follow_arc(request, &turned, &kept->first);
        nav_branch_t leaf = first;
        if ((first.reason == NAV_REASON_NONE) && !first.is_at_goal &&
            (kept->second.length_m > NAV_WALK_EMPTY))
        {
            leaf = nav_walk_follow_arc(request, &first.end, &kept->second);
            cost_s += first.cost_s + steering_s(request, &along_first, &kept->second);
        }
        path_rank(request, tree, NAV_RANK_KEPT, cost_s, &leaf);
    }
    return is_candidate;
}

/** Costs of all paths; nothing is tested. */
static void rank_tree(const nav_request_t *request, nav_tree_t *tree)
{
    for (uint32_t turn = 0U; turn < TURNS; turn++)
    {
        const nav_arc_t turning = nav_walk_turn(turn);
        const nav_steering_t in_place = nav_arc_steering(&turning);
        const nav_pose2_t turned = nav_arc_pose(&request->start, &turning, 1.0);
        double turn_s = 0.0;
        if (turn > 0U)
        {
            turn_s = steering_s(request, &request->in->steering, &turning) +
                     nav_arc_duration_s(request->params, &turning);
        }
        for (uint32_t k = 0U; k < ARCS; k++)
        {
            const nav_arc_t arc = nav_walk_tree_arc(request, k);
            const nav_walk_t walk = nav_walk_tree(request, &turned, k);
            const nav_branch_t first = nav_walk_follow(request, &walk);
            const nav_steering_t *steering = (turn > 0U) ? &in_place : &request->in->steering;
            const double before_s = turn_s + steering_s(request, steering, &arc);
            const uint32_t node = (turn * ARCS) + k;
            rank_seconds(request, tree, node, &first, before_s);
            (void) nav_rank_path(request, before_s, &first, &tree->first_cost_s[node]);
        }
    }
}

static bool is_cheaper(const nav_tree_t *tree, uint16_t a, uint16_t b)
{
    const double cost_a_s = tree->path_cost_s[a];
    const double cost_b_s = tree->path_cost_s[b];
    return (cost_a_s < cost_b_s) || ((cost_a_s <= cost_b_s) && (a < b));
}

/** Moves the root of order[0..count) down until no child is dearer. */
static void sift_down(nav_tree_t *tree, uint32_t root, uint32_t count)
{
    uint32_t place = root;
    bool is_placed = false;
    for (uint32_t level = 0U; NAV_ALWAYS(level < PATHS) && !is_placed; level++)
    {
        uint32_t child = (2U * place) + 1U;
        if (((child + 1U) < count) && is_cheaper(tree, tree->order[child], tree->order[child + 1U]))
        {
            child++;
        }
        is_placed = (child >= count) || is_cheaper(tree, tree->order[child], tree->order[place]);
        if (!is_placed)
        {
            const uint16_t kept = tree->order[place];
            tree->order[place] = tree->order[child];
            tree->order[child] = kept;
            place = child;
        }
    }
}

/** Does the rest of the path selected before compete with the tree's paths? Shorter, it would win by
 * seeing less of what lies ahead: then it comes last. */
static bool is_kept_sorted(const nav_request_t *request, const nav_tree_t *tree)
{
    return (tree->kept.first.length_m + tree->kept.second.length_m) >=
           request->params->keep_path_min_m;
}

/** Heapsort of the first sorted_count candidates by cost; the others stay behind. */
static void sort_paths(nav_tree_t *tree, uint32_t sorted_count)
{
    for (uint32_t k = 0U; k < (uint32_t) NAV_TREE_CANDIDATES; k++)
    {
        tree->order[k] = (uint16_t) k;
    }
    for (uint32_t k = sorted_count / 2U; k > 0U; k--)
    {
        sift_down(tree, k - 1U, sorted_count);
    }
    for (uint32_t count = sorted_count - 1U; count > 0U; count--)
    {
        const uint16_t kept = tree->order[0];
        tree->order[0] = tree->order[count];
        tree->order[count] = kept;
        sift_down(tree, 0U, count);
    }
}

uint32_t nav_rank_candidates(const nav_request_t *request, nav_tree_t *tree)
{
    rank_tree(request, tree);
    const bool is_kept = rank_kept(request, tree);
    sort_paths(tree, (is_kept && is_kept_sorted(request, tree)) ? (PATHS + 1U) : PATHS);
    return is_kept ? (PATHS + 1U) : PATHS;
}
