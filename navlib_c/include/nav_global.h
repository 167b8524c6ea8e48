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

#include "nav_costmap.h"

/** Cost of what cannot be reached, s. */
#define NAV_COST_INFINITE 1.0e12

typedef struct
{
    double cost_to_go_s[NAV_COSTMAP_CELLS]; /* NAV_COST_INFINITE where unreachable */
    double cost_s_per_m[NAV_COSTMAP_CELLS]; /* of the last plan; NAV_COST_INFINITE where blocked */
    uint32_t heap[NAV_COSTMAP_CELLS];       /* cells; a binary heap on cost_to_go_s */
    uint32_t
        heap_place[NAV_COSTMAP_CELLS]; /* where a cell stands in the heap, 1-based; 0: not in it */
    uint32_t heap_count;
    uint32_t is_goal_inside; /* of the last plan */
} nav_global_t;

/**
 * Computes cost_to_go_s for a goal, blocked by terrain and/or zones. Cells inside the waydisc cost
 * nothing to go; if none of them is free, the free cell nearest to its centre is the seed.
 * Ties are broken by cell index: the result does not depend on the order of work.
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
