/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_tree.c
 * @brief Ranks and tests the tree of candidate paths.
 */
#include "nav_tree.h"

#include <math.h>
#include <stddef.h>

#include "nav_guard.h"
#include "nav_math.h"
#include "nav_minmax.h"

#define TURNS ((uint32_t) NAV_TREE_TURNS)
#define ARCS ((uint32_t) NAV_TREE_ARCS)
#define PATHS ((uint32_t) NAV_TREE_PATHS)
#define KEPT PATHS /* index of the kept path among the candidates */

/* The rest of a path is of use only where it was expected to begin. */
#define KEPT_DISTANCE_MAX_M 0.5
#define KEPT_YAW_MAX_RAD 0.2
#define EMPTY_M 1.0e-6

/** What one call works with. */
typedef struct
{
    const nav_tree_scene_t *scene;
    const nav_params_t *params;
    const nav_select_arc_in_t *in;
    nav_pose2_t start;
    double start_distance_m; /* to the goal */
    bool use_terrain_cost;
    bool use_zone_cost;
    bool test_terrain;
    bool is_leaving;     /* no path passed the planning limits */
    uint32_t budget_end; /* of ace_evaluations */
    uint32_t ace_evaluations;
    uint32_t candidate_count;
} call_t;

/** Where an arc of the tree ends, and what it cost. */
typedef struct
{
    nav_pose2_t end;
    double cost_s;
    uint32_t pose_count; /* poses driven: all, or up to the waydisc */
    bool is_at_goal;
    nav_reason_t reason; /* of an infinite cell on the way */
} branch_t;

/** The poses of an arc from a start: one of the tree's, whose shape is known, or any other. */
typedef struct
{
    nav_pose2_t start;
    nav_arc_t arc;
    uint32_t pose_count;             /* 0 for an empty arc */
    double spacing_m;                /* of the poses, not negative */
    const nav_tree_shapes_t *shapes; /* null for an arc that is not the tree's */
    uint32_t shape;
    double cos_sin[2]; /* of the start's yaw */
} walk_t;

/** Verdict and worst bounds of an arc tested pose by pose. */
typedef struct
{
    nav_reason_t reason;
    nav_ace_bounds_t bounds;
} test_t;

void nav_tree_init(const nav_params_t *params, nav_tree_shapes_t *shapes)
{
    const nav_pose2_t origin = {0.0, 0.0, 0.0};
    for (uint32_t k = 0U; k < ARCS; k++)
    {
        const double step = (double) k - (0.5 * (double) (ARCS - 1U));
        const nav_arc_t arc = {params->tree_arc_length_m, step * params->tree_heading_step_rad};
        shapes->heading_change_rad[k] = arc.heading_change_rad;
        shapes->pose_count = nav_arc_pose_count(params, &arc);
        for (uint32_t place = 0U; place < shapes->pose_count; place++)
        {
            const nav_pose2_t pose =
                nav_arc_pose(&origin, &arc, (double) (place + 1U) / (double) shapes->pose_count);
            shapes->forward_m[k][place] = pose.x_m;
            shapes->right_m[k][place] = pose.y_m;
        }
    }
}

/** Unguarded and Guarded take the fastest path or none. */
static bool is_one_path(const call_t *call)
{
    return (call->in->mode == (uint32_t) NAV_MODE_UNGUARDED) ||
           (call->in->mode == (uint32_t) NAV_MODE_GUARDED);
}

static nav_arc_t turn_arc(uint32_t turn)
{
    const nav_arc_t arc = {0.0, nav_wrap_angle((2.0 * NAV_PI * (double) turn) / (double) TURNS)};
    return arc;
}

static nav_arc_t tree_arc(const call_t *call, uint32_t k)
{
    const nav_arc_t arc = {call->params->tree_arc_length_m,
                           call->scene->shapes->heading_change_rad[k]};
    return arc;
}

static bool is_empty_arc(const nav_arc_t *arc)
{
    return (fabs(arc->length_m) <= EMPTY_M) && (fabs(arc->heading_change_rad) <= EMPTY_M);
}

/** Walks an arc of the tree. */
static walk_t tree_walk(const call_t *call, const nav_pose2_t *start, uint32_t k)
{
    const nav_tree_shapes_t *shapes = call->scene->shapes;
    const walk_t walk = {.start = *start,
                         .arc = tree_arc(call, k),
                         .pose_count = shapes->pose_count,
                         .spacing_m = call->params->tree_arc_length_m / (double) shapes->pose_count,
                         .shapes = shapes,
                         .shape = k,
                         .cos_sin = {nav_cos(start->yaw_rad), nav_sin(start->yaw_rad)}};
    return walk;
}

/** Walks any arc or turn in place. */
static walk_t arc_walk(const call_t *call, const nav_pose2_t *start, const nav_arc_t *arc)
{
    walk_t walk = {.start = *start, .arc = *arc};
    if (!is_empty_arc(arc))
    {
        walk.pose_count = nav_arc_pose_count(call->params, arc);
        walk.spacing_m = fabs(arc->length_m) / (double) walk.pose_count;
    }
    return walk;
}

static nav_pose2_t walk_pose(const walk_t *walk, uint32_t place)
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

static double goal_distance_m(const call_t *call, const nav_pose2_t *pose)
{
    const double dx_m = call->in->goal.x_site_m - pose->x_m;
    const double dy_m = call->in->goal.y_site_m - pose->y_m;
    return sqrt((dx_m * dx_m) + (dy_m * dy_m));
}

/** Cost per metre of the cell under a pose beyond plain driving time, and why it is infinite if so. */
static nav_reason_t terrain_cost(const call_t *call, const nav_pose2_t *pose, double *cost_s_per_m)
{
    const double plain_s_per_m = 1.0 / call->params->speed_max_m_per_s;
    nav_reason_t reason = NAV_REASON_NONE;
    uint32_t index = 0U;
    if (nav_costmap_find(call->scene->costmap, pose->x_m, pose->y_m, &index))
    {
        /* cells that ACE closed may be crossed: ACE judges every pose itself */
        nav_cost_cell_t cell = call->scene->costmap->cells[index];
        const uint32_t barred = nav_costmap_barred(&cell);
        cell.ace_failed_headings = 0U;
        reason = nav_costmap_reason(&cell, call->use_terrain_cost, call->use_zone_cost);
        *cost_s_per_m = 0.0;
        if (call->use_terrain_cost)
        {
            const bool is_barred = ((barred >> nav_costmap_heading(pose->yaw_rad)) & 1U) != 0U;
            *cost_s_per_m = ((double) cell.cost_s_per_m *
                             (is_barred ? call->params->cost_barred_factor : 1.0)) -
                            plain_s_per_m;
        }
    }
    else
    {
        *cost_s_per_m = call->use_terrain_cost
                            ? (plain_s_per_m * (call->params->cost_unknown_factor - 1.0))
                            : 0.0;
    }
    return reason;
}

/** Follows an arc: time, terrain, end at the waydisc. An empty arc costs nothing. */
static branch_t branch_follow(const call_t *call, const walk_t *walk)
{
    branch_t branch = {walk->start, 0.0, 0U, false, NAV_REASON_NONE};

    for (uint32_t place = 0U; (place < walk->pose_count) && !branch.is_at_goal; place++)
    {
        double cost_s_per_m = 0.0;
        branch.end = walk_pose(walk, place);
        const nav_reason_t reason = terrain_cost(call, &branch.end, &cost_s_per_m);
        branch.reason = (branch.reason == NAV_REASON_NONE) ? reason : branch.reason;
        branch.cost_s += cost_s_per_m * walk->spacing_m;
        branch.is_at_goal = goal_distance_m(call, &branch.end) <= call->in->goal.radius_m;
        branch.pose_count = place + 1U;
    }
    if (branch.pose_count > 0U)
    {
        branch.cost_s += nav_arc_duration_s(call->params, &walk->arc) * (double) branch.pose_count /
                         (double) walk->pose_count;
    }
    return branch;
}

/** Cost-to-go from the end of a path, and whether it leads away. */
static nav_reason_t leaf_cost(const call_t *call, const branch_t *leaf, double *cost_s)
{
    nav_reason_t reason = NAV_REASON_NONE;
    const double distance_m = goal_distance_m(call, &leaf->end);
    *cost_s = 0.0;
    if (leaf->is_at_goal)
    {
        reason = NAV_REASON_NONE;
    }
    else if ((distance_m - call->start_distance_m) > call->params->negative_progress_max_m)
    {
        reason = NAV_REASON_NEGATIVE_PROGRESS;
    }
    else if (call->use_terrain_cost || call->use_zone_cost)
    {
        *cost_s = nav_global_cost_to_go_s(call->scene->global, call->scene->costmap, call->params,
                                          &call->in->goal, leaf->end.x_m, leaf->end.y_m);
    }
    else
    {
        *cost_s = distance_m / call->params->speed_max_m_per_s;
    }
    return reason;
}

/** Why no way leads on from a leaf whose cost-to-go is infinite. */
static nav_reason_t leaf_reason(const call_t *call, const branch_t *leaf)
{
    nav_reason_t reason = NAV_REASON_UNEXPECTED;
    uint32_t index = 0U;
    if (nav_costmap_find(call->scene->costmap, leaf->end.x_m, leaf->end.y_m, &index))
    {
        reason = nav_costmap_reason(&call->scene->costmap->cells[index], call->use_terrain_cost,
                                    call->use_zone_cost);
        reason = (reason == NAV_REASON_NONE) ? NAV_REASON_UNEXPECTED : reason;
    }
    return reason;
}

static double steering_s(const call_t *call, const nav_steering_t *from, const nav_arc_t *arc)
{
    const nav_steering_t to = nav_arc_steering(arc);
    return nav_arc_steering_duration_s(call->params, from, &to);
}

/** Cost of a path whose last arc is the leaf, or the reason of an infinite one. */
static nav_reason_t path_cost(const call_t *call,
                              double before_s,
                              const branch_t *leaf,
                              double *cost_s)
{
    double to_go_s = 0.0;
    nav_reason_t reason = leaf->reason;
    if (reason == NAV_REASON_NONE)
    {
        reason = leaf_cost(call, leaf, &to_go_s);
    }
    if ((reason == NAV_REASON_NONE) && (to_go_s >= NAV_COST_INFINITE))
    {
        reason = leaf_reason(call, leaf);
    }
    *cost_s = (reason == NAV_REASON_NONE) ? (before_s + leaf->cost_s + to_go_s) : NAV_COST_INFINITE;
    return reason;
}

static void path_rank(
    const call_t *call, nav_tree_t *tree, uint32_t path, double before_s, const branch_t *leaf)
{
    tree->path_reason[path] = (uint8_t) path_cost(call, before_s, leaf, &tree->path_cost_s[path]);
}

/** Ranks the 11 paths that go on from a first arc. */
static void rank_seconds(
    const call_t *call, nav_tree_t *tree, uint32_t node, const branch_t *first, double before_s)
{
    const nav_arc_t arc = tree_arc(call, node % ARCS);
    const nav_steering_t steering = nav_arc_steering(&arc);
    for (uint32_t k = 0U; k < ARCS; k++)
    {
        const uint32_t path = (node * ARCS) + k;
        const nav_arc_t next = tree_arc(call, k);
        branch_t leaf = *first;
        leaf.cost_s = 0.0;
        double cost_s = before_s + first->cost_s;
        if ((first->reason == NAV_REASON_NONE) && !first->is_at_goal)
        {
            const walk_t walk = tree_walk(call, &first->end, k);
            leaf = branch_follow(call, &walk);
            cost_s += steering_s(call, &steering, &next);
        }
        path_rank(call, tree, path, cost_s, &leaf);
    }
}

/** Adds the rest of the path selected before to the candidates, if the rover is where it begins and
 * the mode looks for more than one path. */
static void rank_kept(call_t *call, nav_tree_t *tree)
{
    const nav_path_t *kept = &tree->kept;
    const double dx_m = kept->x_site_m - call->start.x_m;
    const double dy_m = kept->y_site_m - call->start.y_m;
    const double turned_rad = nav_wrap_angle(kept->yaw_rad - call->start.yaw_rad);
    const bool is_turn = fabs(kept->turn.heading_change_rad) > EMPTY_M;
    call->candidate_count = PATHS;
    if ((kept->is_kept != 0U) && !is_one_path(call) && (fabs(turned_rad) <= KEPT_YAW_MAX_RAD) &&
        (((dx_m * dx_m) + (dy_m * dy_m)) <= (KEPT_DISTANCE_MAX_M * KEPT_DISTANCE_MAX_M)))
    {
        const nav_pose2_t turned = nav_arc_pose(&call->start, &kept->turn, 1.0);
        const nav_steering_t in_place = nav_arc_steering(&kept->turn);
        const nav_steering_t along_first = nav_arc_steering(&kept->first);
        double cost_s = 0.0;
        if (is_turn)
        {
            cost_s = steering_s(call, &call->in->steering, &kept->turn) +
                     nav_arc_duration_s(call->params, &kept->turn);
        }
        cost_s += steering_s(call, is_turn ? &in_place : &call->in->steering, &kept->first);
        const walk_t along = arc_walk(call, &turned, &kept->first);
        const branch_t first = branch_follow(call, &along);
        branch_t leaf = first;
        if ((first.reason == NAV_REASON_NONE) && !first.is_at_goal &&
            (kept->second.length_m > EMPTY_M))
        {
            const walk_t onward = arc_walk(call, &first.end, &kept->second);
            leaf = branch_follow(call, &onward);
            cost_s += first.cost_s + steering_s(call, &along_first, &kept->second);
        }
        path_rank(call, tree, KEPT, cost_s, &leaf);
        call->candidate_count = (uint32_t) NAV_TREE_CANDIDATES;
    }
}

/** Costs of all paths; nothing is tested. */
static void rank(const call_t *call, nav_tree_t *tree)
{
    for (uint32_t turn = 0U; turn < TURNS; turn++)
    {
        const nav_arc_t turning = turn_arc(turn);
        const nav_steering_t in_place = nav_arc_steering(&turning);
        const nav_pose2_t turned = nav_arc_pose(&call->start, &turning, 1.0);
        double turn_s = 0.0;
        if (turn > 0U)
        {
            turn_s = steering_s(call, &call->in->steering, &turning) +
                     nav_arc_duration_s(call->params, &turning);
        }
        for (uint32_t k = 0U; k < ARCS; k++)
        {
            const nav_arc_t arc = tree_arc(call, k);
            const walk_t walk = tree_walk(call, &turned, k);
            const branch_t first = branch_follow(call, &walk);
            const nav_steering_t *steering = (turn > 0U) ? &in_place : &call->in->steering;
            const double before_s = turn_s + steering_s(call, steering, &arc);
            const uint32_t node = (turn * ARCS) + k;
            rank_seconds(call, tree, node, &first, before_s);
            (void) path_cost(call, before_s, &first, &tree->first_cost_s[node]);
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
static bool is_kept_sorted(const call_t *call, const nav_tree_t *tree)
{
    return (call->candidate_count > PATHS) &&
           ((tree->kept.first.length_m + tree->kept.second.length_m) >=
            call->params->keep_path_min_m);
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

/** Bounds that anything else is worse than. */
static nav_ace_bounds_t best_bounds(void)
{
    const nav_ace_bounds_t best = {.clearance_min_m = NAV_COST_INFINITE,
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
    return best;
}

/** Tests one pose, distance_m along the path, by zones and by ACE as the mode demands. */
static nav_reason_t test_pose(call_t *call,
                              const nav_pose2_t *pose,
                              double distance_m,
                              nav_ace_bounds_t *worst)
{
    nav_reason_t reason = NAV_REASON_NONE;
    if (nav_kioz_forbids(call->scene->kioz, pose->x_m, pose->y_m,
                         call->in->uncertainty.global_position_m))
    {
        reason = NAV_REASON_KIOZ;
    }
    else if (call->test_terrain)
    {
        const nav_uncertainty_t grown =
            nav_ace_grow(call->params, &call->in->uncertainty, distance_m);
        nav_ace_bounds_t bounds;
        nav_ace_evaluate(&call->scene->ace, pose, &grown, &bounds);
        call->ace_evaluations++;
        worsen(worst, &bounds);
        reason = nav_ace_refuse(call->params, &bounds,
                                call->is_leaving && (distance_m <= call->params->leave_length_m));
        nav_costmap_feedback(call->scene->costmap, pose, reason);
    }
    else
    {
        reason = NAV_REASON_NONE;
    }
    return reason;
}

/** Goes on with a test along an arc or turn that begins distance_m along the path, up to the waydisc,
 * unless it has failed already. */
static void test_walk(call_t *call, const walk_t *walk, double distance_m, test_t *test)
{
    const bool is_turn = fabs(walk->arc.length_m) <= EMPTY_M;
    bool is_at_goal = false;

    for (uint32_t place = 0U;
         (place < walk->pose_count) && (test->reason == NAV_REASON_NONE) && !is_at_goal; place++)
    {
        const nav_pose2_t pose = walk_pose(walk, place);
        test->reason = test_pose(
            call, &pose, distance_m + ((double) (place + 1U) * walk->spacing_m), &test->bounds);
        is_at_goal = !is_turn && (goal_distance_m(call, &pose) <= call->in->goal.radius_m);
    }
}

/** Tests the rest of the path selected before. */
static void test_kept(call_t *call, const nav_path_t *kept, test_t *test)
{
    const nav_pose2_t turned = nav_arc_pose(&call->start, &kept->turn, 1.0);
    const walk_t along = arc_walk(call, &turned, &kept->first);
    const branch_t first = branch_follow(call, &along);
    walk_t walk = arc_walk(call, &call->start, &kept->turn);
    test_walk(call, &walk, 0.0, test);
    test_walk(call, &along, 0.0, test);
    if (!first.is_at_goal)
    {
        walk = arc_walk(call, &first.end, &kept->second);
        test_walk(call, &walk, kept->first.length_m, test);
    }
}

/** Tests what of a turn and a first arc has not been tested before. */
static void test_first(call_t *call, nav_tree_t *tree, uint32_t node, test_t *test)
{
    const uint32_t turn = node / ARCS;
    const nav_arc_t turning = turn_arc(turn);
    const nav_pose2_t turned = nav_arc_pose(&call->start, &turning, 1.0);
    walk_t walk;

    if (tree->turn_verdict[turn] == (uint8_t) NAV_TREE_UNTESTED)
    {
        walk = arc_walk(call, &call->start, &turning);
        test_walk(call, &walk, 0.0, test);
        tree->turn_verdict[turn] = (uint8_t) test->reason;
        tree->turn_bounds[turn] = test->bounds;
    }
    test->reason = (nav_reason_t) tree->turn_verdict[turn];
    test->bounds = tree->turn_bounds[turn];
    if (test->reason == NAV_REASON_NONE)
    {
        if (tree->first_verdict[node] == (uint8_t) NAV_TREE_UNTESTED)
        {
            walk = tree_walk(call, &turned, node % ARCS);
            test_walk(call, &walk, 0.0, test);
            tree->first_verdict[node] = (uint8_t) test->reason;
            tree->first_bounds[node] = test->bounds;
        }
        test->reason = (nav_reason_t) tree->first_verdict[node];
        test->bounds = tree->first_bounds[node];
    }
}

/** Tests what of a path has not been tested before; bounds are the worst of the whole path. */
static void test_path(call_t *call, nav_tree_t *tree, uint32_t path, test_t *test)
{
    const uint32_t node = path / ARCS;

    test_first(call, tree, node, test);
    if (test->reason == NAV_REASON_NONE)
    {
        const nav_arc_t turning = turn_arc(node / ARCS);
        const nav_pose2_t turned = nav_arc_pose(&call->start, &turning, 1.0);
        walk_t walk = tree_walk(call, &turned, node % ARCS);
        const branch_t first = branch_follow(call, &walk);
        if (!first.is_at_goal)
        {
            walk = tree_walk(call, &first.end, path % ARCS);
            test_walk(call, &walk, call->params->tree_arc_length_m, test);
        }
        tree->second_verdict[path] = (uint8_t) test->reason;
    }
}

static void clear_verdicts(nav_tree_t *tree)
{
    for (uint32_t k = 0U; k < TURNS; k++)
    {
        tree->turn_verdict[k] = (uint8_t) NAV_TREE_UNTESTED;
        tree->turn_bounds[k] = best_bounds();
    }
    for (uint32_t k = 0U; k < (uint32_t) NAV_TREE_FIRST_ARCS; k++)
    {
        tree->first_verdict[k] = (uint8_t) NAV_TREE_UNTESTED;
        tree->first_bounds[k] = best_bounds();
    }
    for (uint32_t k = 0U; k < PATHS; k++)
    {
        tree->second_verdict[k] = (uint8_t) NAV_TREE_UNTESTED;
    }
}

/** Tests the tree's paths from the cheapest, then, if none passed, the rest of the path selected
 * before. Paths not reached are rejected by cost or by the budget. */
static void test_paths(call_t *call, nav_tree_t *tree, nav_select_arc_out_t *out)
{
    nav_reason_t rest = NAV_REASON_NONE;

    for (uint32_t k = 0U; k < call->candidate_count; k++)
    {
        const uint32_t path = tree->order[k];
        if (tree->path_reason[path] == (uint8_t) NAV_REASON_NONE)
        {
            /* the last resort is a few poses: the budget does not keep it from being tested */
            if ((rest == NAV_REASON_NONE) || ((rest == NAV_REASON_BUDGET) && (path == KEPT)))
            {
                test_t test = {NAV_REASON_NONE, best_bounds()};
                if (path == KEPT)
                {
                    test_kept(call, &tree->kept, &test);
                }
                else
                {
                    test_path(call, tree, path, &test);
                }
                out->paths_tested++;
                tree->path_reason[path] = (uint8_t) test.reason;
                if (test.reason == NAV_REASON_NONE)
                {
                    out->path_index = path;
                    out->bounds = test.bounds;
                    out->path_cost_s = tree->path_cost_s[path];
                    rest = NAV_REASON_COST;
                }
                else if (is_one_path(call))
                {
                    rest = NAV_REASON_COST;
                }
                else if (call->ace_evaluations >= call->budget_end)
                {
                    rest = NAV_REASON_BUDGET;
                }
                else
                {
                    rest = NAV_REASON_NONE;
                }
            }
            else
            {
                tree->path_reason[path] = (uint8_t) rest;
            }
        }
        out->rejections[tree->path_reason[path]]++;
    }
}

/** The cheapest first arc that may still pass; NAV_TREE_FIRST_ARCS when there is none. */
static uint32_t cheapest_first(const nav_tree_t *tree)
{
    uint32_t cheapest = (uint32_t) NAV_TREE_FIRST_ARCS;
    double least_s = NAV_COST_INFINITE;
    for (uint32_t node = 0U; node < (uint32_t) NAV_TREE_FIRST_ARCS; node++)
    {
        const uint8_t turn = tree->turn_verdict[node / ARCS];
        const uint8_t first = tree->first_verdict[node];
        const bool is_refused =
            ((turn != (uint8_t) NAV_REASON_NONE) && (turn != (uint8_t) NAV_TREE_UNTESTED)) ||
            ((first != (uint8_t) NAV_REASON_NONE) && (first != (uint8_t) NAV_TREE_UNTESTED));
        if (!is_refused && (tree->first_cost_s[node] < least_s))
        {
            least_s = tree->first_cost_s[node];
            cheapest = node;
        }
    }
    return cheapest;
}

/** Takes the cheapest first arc that passes, if one does. */
static void take_short(call_t *call, nav_tree_t *tree, nav_select_arc_out_t *out)
{
    uint32_t node = cheapest_first(tree);
    bool is_found = false;
    while ((node < (uint32_t) NAV_TREE_FIRST_ARCS) && !is_found)
    {
        test_t test = {NAV_REASON_NONE, best_bounds()};
        test_first(call, tree, node, &test);
        is_found = test.reason == NAV_REASON_NONE;
        if (is_found)
        {
            out->path_index = (uint32_t) NAV_TREE_SHORT + node;
            out->bounds = test.bounds;
            out->path_cost_s = tree->first_cost_s[node];
        }
        else
        {
            /* refused now: another one is the cheapest */
            node = cheapest_first(tree);
        }
    }
}

/** As far backwards as is driven before planning again. */
static nav_arc_t back_arc(const call_t *call, uint32_t k)
{
    const double length_m = call->params->execute_length_m;
    const double share = length_m / call->params->tree_arc_length_m;
    const nav_arc_t arc = {-length_m, -share * call->scene->shapes->heading_change_rad[k]};
    return arc;
}

/** Takes the cheapest arc backwards that passes, if one does. */
static void take_back(call_t *call, nav_select_arc_out_t *out)
{
    double least_s = NAV_COST_INFINITE;
    for (uint32_t k = 0U; k < ARCS; k++)
    {
        const nav_arc_t arc = back_arc(call, k);
        const walk_t walk = arc_walk(call, &call->start, &arc);
        const branch_t leaf = branch_follow(call, &walk);
        double cost_s = NAV_COST_INFINITE;
        (void) path_cost(call, steering_s(call, &call->in->steering, &arc), &leaf, &cost_s);
        if (cost_s < least_s)
        {
            test_t test = {NAV_REASON_NONE, best_bounds()};
            test_walk(call, &walk, 0.0, &test);
            if (test.reason == NAV_REASON_NONE)
            {
                least_s = cost_s;
                out->path_index = (uint32_t) NAV_TREE_BACK + k;
                out->bounds = test.bounds;
                out->path_cost_s = cost_s;
            }
        }
    }
}

/** Tests all candidates, then, where the mode looks for more than one path, the last resorts. */
static void test_all(call_t *call, nav_tree_t *tree, nav_select_arc_out_t *out)
{
    test_paths(call, tree, out);
    if ((out->path_index == (uint32_t) NAV_TREE_NONE) && !is_one_path(call))
    {
        take_short(call, tree, out);
    }
    if ((out->path_index == (uint32_t) NAV_TREE_NONE) && !is_one_path(call))
    {
        take_back(call, out);
    }
}

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
static nav_path_t selected_path(const call_t *call, const nav_tree_t *tree, uint32_t path)
{
    nav_path_t selected = tree->kept;
    if (path >= (uint32_t) NAV_TREE_BACK)
    {
        selected = (nav_path_t){.first = back_arc(call, path - (uint32_t) NAV_TREE_BACK)};
    }
    else if (path >= (uint32_t) NAV_TREE_SHORT)
    {
        const uint32_t node = path - (uint32_t) NAV_TREE_SHORT;
        selected =
            (nav_path_t){.turn = turn_arc(node / ARCS), .first = tree_arc(call, node % ARCS)};
    }
    else if (path != KEPT)
    {
        const uint32_t node = path / ARCS;
        selected.turn = turn_arc(node / ARCS);
        selected.first = tree_arc(call, node % ARCS);
        selected.second = tree_arc(call, path % ARCS);
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
static nav_arc_t executed_arc(const call_t *call, const nav_path_t *path, const branch_t *first)
{
    nav_arc_t arc = {0.0, 0.0};
    if (fabs(path->turn.heading_change_rad) > EMPTY_M)
    {
        arc.heading_change_rad = executed_turn_rad(call->params, path->turn.heading_change_rad);
    }
    else
    {
        const double share =
            (double) first->pose_count / (double) nav_arc_pose_count(call->params, &path->first);
        const double most_m = call->params->execute_length_m;
        arc = arc_front(&path->first, nav_clamp(path->first.length_m * share, -most_m, most_m));
    }
    return arc;
}

/** What is left of a path when its first part has been driven; nothing when that was all. */
static nav_path_t rest_of_path(const call_t *call, const nav_path_t *path, const nav_arc_t *driven)
{
    const nav_pose2_t end = nav_arc_pose(&call->start, driven, 1.0);
    nav_path_t rest = *path;
    rest.x_site_m = end.x_m;
    rest.y_site_m = end.y_m;
    rest.yaw_rad = end.yaw_rad;
    if (fabs(path->turn.heading_change_rad) > EMPTY_M)
    {
        rest.turn.heading_change_rad -= driven->heading_change_rad;
    }
    else if ((path->first.length_m - driven->length_m) > EMPTY_M)
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
    rest.is_kept = (rest.first.length_m > EMPTY_M) ? 1U : 0U;
    return rest;
}

/** Adds the poses that a branch drives to the shown path. */
static void show_walk(const walk_t *walk, const branch_t *branch, nav_select_arc_out_t *out)
{
    for (uint32_t place = 0U; place < branch->pose_count; place++)
    {
        const nav_pose2_t pose = walk_pose(walk, place);
        add_point(out, &pose);
    }
}

/** Describes the selected path, and keeps what is left of it for the next call. */
static void show_path(const call_t *call, nav_tree_t *tree, nav_select_arc_out_t *out)
{
    const nav_path_t path = selected_path(call, tree, out->path_index);
    const nav_pose2_t turned = nav_arc_pose(&call->start, &path.turn, 1.0);
    const walk_t along = arc_walk(call, &turned, &path.first);
    const branch_t first = branch_follow(call, &along);
    branch_t leaf = first;
    double to_go_s = 0.0;

    add_point(out, &call->start);
    show_walk(&along, &first, out);
    if (!first.is_at_goal)
    {
        const walk_t onward = arc_walk(call, &first.end, &path.second);
        leaf = branch_follow(call, &onward);
        show_walk(&onward, &leaf, out);
    }
    (void) leaf_cost(call, &leaf, &to_go_s);
    out->arc = executed_arc(call, &path, &first);
    out->cost_to_go_s = to_go_s;
    if (!leaf.is_at_goal && (call->use_terrain_cost || call->use_zone_cost))
    {
        out->global_point_count =
            nav_global_descend(call->scene->global, call->scene->costmap, leaf.end.x_m,
                               leaf.end.y_m, out->global_points, (uint32_t) NAV_GLOBAL_POINTS_MAX);
    }
    tree->kept = rest_of_path(call, &path, &out->arc);
}

/** Makes the paths that ACE refused untested again, for the leave limits. */
static void forget_tests(const call_t *call, nav_tree_t *tree, nav_select_arc_out_t *out)
{
    clear_verdicts(tree);
    for (uint32_t path = 0U; path < call->candidate_count; path++)
    {
        if (tree->path_cost_s[path] < NAV_COST_INFINITE)
        {
            tree->path_reason[path] = (uint8_t) NAV_REASON_NONE;
        }
    }
    for (uint32_t reason = 0U; reason < (uint32_t) NAV_REASON_COUNT; reason++)
    {
        out->rejections[reason] = 0U;
    }
}

void nav_tree_select(nav_tree_t *tree,
                     const nav_tree_scene_t *scene,
                     const nav_select_arc_in_t *in,
                     nav_select_arc_out_t *out)
{
    call_t call = {.scene = scene,
                   .params = scene->ace.params,
                   .in = in,
                   .start = {in->pose.x_site_m, in->pose.y_site_m, in->pose.yaw_rad}};
    call.start_distance_m = goal_distance_m(&call, &call.start);
    call.use_terrain_cost = in->mode == (uint32_t) NAV_MODE_AVOID_ALL;
    call.use_zone_cost = call.use_terrain_cost || (in->mode == (uint32_t) NAV_MODE_AVOID_KOZ);
    call.test_terrain = call.use_terrain_cost || (in->mode == (uint32_t) NAV_MODE_GUARDED);

    call.budget_end = (uint32_t) call.params->ace_budget_poses;

    out->path_index = (uint32_t) NAV_TREE_NONE;
    clear_verdicts(tree);
    rank(&call, tree);
    rank_kept(&call, tree);
    sort_paths(tree, is_kept_sorted(&call, tree) ? call.candidate_count : PATHS);
    test_all(&call, tree, out);
    if ((out->path_index == (uint32_t) NAV_TREE_NONE) && call.test_terrain && !is_one_path(&call))
    {
        call.is_leaving = true;
        call.budget_end += call.ace_evaluations;
        forget_tests(&call, tree, out);
        test_all(&call, tree, out);
        out->is_leaving = (out->path_index < (uint32_t) NAV_TREE_NONE) ? 1U : 0U;
    }
    out->ace_evaluations = call.ace_evaluations;
    out->status = (uint32_t) NAV_NO_PATH;
    if (out->path_index < (uint32_t) NAV_TREE_NONE)
    {
        out->status = (uint32_t) NAV_OK;
        show_path(&call, tree, out);
    }
    else
    {
        tree->kept.is_kept = 0U;
    }
}
