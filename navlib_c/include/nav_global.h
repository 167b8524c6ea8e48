/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_global.h
 * @brief Cost-to-go from every costmap cell to the goal: Dijkstra, 8-connected, exact.
 *
 * An edge costs its length times the mean cost per metre of its two cells. A goal outside the map is
 * reached through the edge cells that face it, each with the straight line from there to the goal at
 * the cost of unknown ground.
 */
#ifndef NAV_GLOBAL_H
#define NAV_GLOBAL_H

#include "nav_passage.h"

/** Cost of what cannot be reached, s. */
#define NAV_COST_INFINITE 1.0e12
/** Cost of blocked ground, s/m: any edge to it costs more than what cannot be reached. */
#define NAV_COST_BLOCKED_S_PER_M 1.0e30

/** The costmap's cells with a border of blocked ones, so that every cell has eight neighbours. */
#define NAV_GLOBAL_SIZE (NAV_COSTMAP_SIZE + 2)
#define NAV_GLOBAL_NODES (NAV_GLOBAL_SIZE * NAV_GLOBAL_SIZE)

/** Lists of nodes in work, each for an interval of cost, and one for all beyond. */
#ifndef NAV_GLOBAL_BUCKETS
#define NAV_GLOBAL_BUCKETS 256
#endif
#define NAV_GLOBAL_LINKS (NAV_GLOBAL_NODES + NAV_GLOBAL_BUCKETS + 1)

/** A node is a costmap cell or border; that of row and column stands at (row + 1), (column + 1). */
typedef struct
{
    double cost_to_go_s[NAV_GLOBAL_NODES]; /* NAV_COST_INFINITE where unreachable */
    double
        cost_s_per_m[NAV_GLOBAL_NODES]; /* of the last plan; NAV_COST_BLOCKED_S_PER_M if blocked */
    uint8_t barred_headings[NAV_GLOBAL_NODES];
    int32_t next[NAV_GLOBAL_LINKS]; /* rings; behind the nodes stand the heads of the lists */
    int32_t previous[NAV_GLOBAL_LINKS];
    double first_s;          /* where the interval of the first list begins */
    double barred_factor;    /* of an edge along a barred heading */
    double buckets_per_s;    /* 1 / length of an interval, half the least edge at most */
    int32_t bucket;          /* all before it are empty */
    uint32_t is_goal_inside; /* of the last plan */
} nav_global_t;

/**
 * Computes cost_to_go_s for a goal, blocked by terrain and/or zones. Cells inside the waydisc cost
 * nothing to go; if none of them is free, the free cell nearest to its centre is the seed.
 * The costs are the one solution of cost = least of (neighbour's cost + edge), to the last bit: they do
 * not depend on the order of work.
 */
void nav_global_plan(nav_global_t *global,
                     const nav_costmap_t *map,
                     const nav_params_t *params,
                     const nav_waydisc_t *goal,
                     bool use_terrain,
                     bool use_zones);

/**
 * Cost-to-go from a position: the least over its cell and the 8 around it of the cell's cost-to-go
 * plus the way to its centre; a cell that is itself blocked makes it infinite. Outside the map: the
 * straight line to the goal at the cost of unknown ground.
 */
double nav_global_cost_to_go_s(const nav_global_t *global,
                               const nav_costmap_t *map,
                               const nav_params_t *params,
                               const nav_waydisc_t *goal,
                               double x_site_m,
                               double y_site_m);

/**
 * Steepest descent from a position to a seed, as cell centres (z is 0).
 * @return number of points written, at most capacity
 */
uint32_t nav_global_descend(const nav_global_t *global,
                            const nav_costmap_t *map,
                            double x_site_m,
                            double y_site_m,
                            nav_point_t *points,
                            uint32_t capacity);

#endif
