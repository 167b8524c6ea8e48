/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_walk.h
 * @brief Private to Navlib: arcs pose by pose, and what following one costs.
 */
#ifndef NAV_WALK_H
#define NAV_WALK_H

#include "nav_tree.h"

/* Shorter arcs and smaller turns, m or rad, are none. */
#define NAV_WALK_EMPTY 1.0e-6

/** What one selection of an arc works with. */
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
    bool is_one_path; /* Unguarded and Guarded take the fastest path or none */
} nav_request_t;

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
} nav_walk_t;

/** Where following an arc ends, and what it cost. */
typedef struct
{
    nav_pose2_t end;
    double cost_s;
    uint32_t pose_count; /* poses driven: all, or up to the waydisc */
    bool is_at_goal;
    nav_reason_t reason; /* of an infinite cell on the way */
} nav_branch_t;

/** What a selection works with: its modes and its start. */
nav_request_t nav_walk_request(const nav_tree_scene_t *scene, const nav_select_arc_in_t *in);

/** A turn in place of the tree. */
nav_arc_t nav_walk_turn(uint32_t turn);

/** An arc of the tree. */
nav_arc_t nav_walk_tree_arc(const nav_request_t *request, uint32_t k);

/** An arc backwards, as far as is driven before planning again. */
nav_arc_t nav_walk_back_arc(const nav_request_t *request, uint32_t k);

/** Walks an arc of the tree. */
nav_walk_t nav_walk_tree(const nav_request_t *request, const nav_pose2_t *start, uint32_t k);

/** Walks any arc or turn in place. */
nav_walk_t nav_walk_arc(const nav_request_t *request,
                        const nav_pose2_t *start,
                        const nav_arc_t *arc);

/** A pose of a walk, place below its pose_count. */
nav_pose2_t nav_walk_pose(const nav_walk_t *walk, uint32_t place);

/** From a pose to the middle of the waydisc. */
double nav_walk_goal_distance_m(const nav_request_t *request, const nav_pose2_t *pose);

/** Follows an arc: time, terrain, end at the waydisc. An empty arc costs nothing. */
nav_branch_t nav_walk_follow(const nav_request_t *request, const nav_walk_t *walk);

/** Follows any arc. */
nav_branch_t nav_walk_follow_arc(const nav_request_t *request,
                                 const nav_pose2_t *start,
                                 const nav_arc_t *arc);

/** Follows a turn in place and a first arc of the tree; the turn costs nothing here. */
nav_branch_t nav_walk_follow_first(const nav_request_t *request, uint32_t node);

#endif
