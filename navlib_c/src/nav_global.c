/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_global.c
 * @brief Dijkstra over the costmap with lists of nodes by cost.
 */
#include "nav_global.h"

#include <math.h>

#include "nav_guard.h"
#include "nav_math.h"
#include "nav_minmax.h"

#define NAV_SIZE ((int32_t) NAV_COSTMAP_SIZE)
#define NAV_STRIDE ((int32_t) NAV_GLOBAL_SIZE)
#define NAV_NODES (NAV_STRIDE * NAV_STRIDE)
#define NAV_BUCKETS ((int32_t) NAV_GLOBAL_BUCKETS)
#define NAV_NEIGHBORS 8
#define NAV_NO_NODE (-1)
#define NAV_SQRT_2 1.41421356237309504880169

/* Ground may not be cheaper: keeps the number of lists per second finite. */
#define NAV_COST_LEAST_S_PER_M 1.0e-60

typedef struct
{
    int32_t row;
    int32_t col;
} nav_step_t;

/* The node of a row and column of the costmap. */
static int32_t node_at(int32_t row, int32_t col)
{
    return ((row + 1) * NAV_STRIDE) + (col + 1);
}

static nav_step_t step_to(int32_t neighbor)
{
    static const nav_step_t steps[NAV_NEIGHBORS] = {{-1, -1}, {-1, 0}, {-1, 1}, {0, -1},
                                                    {0, 1},   {1, -1}, {1, 0},  {1, 1}};

    return steps[neighbor];
}

static bool is_blocked(const nav_global_t *global, int32_t node)
{
    return global->cost_s_per_m[node] >= NAV_COST_INFINITE;
}

static void unlink_node(nav_global_t *global, int32_t node)
{
    const int32_t before = global->previous[node];
    const int32_t after = global->next[node];

    global->next[before] = after;
    global->previous[after] = before;
    global->next[node] = node;
    global->previous[node] = node;
}

/* Puts a node that is in no list into the one of its cost. */
static void link_node(nav_global_t *global, int32_t node)
{
    const double place = (global->cost_to_go_s[node] - global->first_s) * global->buckets_per_s;
    int32_t head = NAV_NODES + NAV_BUCKETS;

    if (place < (double) NAV_BUCKETS)
    {
        /* no node costs less than first_s: not negative, below the number of lists */
        head = NAV_NODES + (int32_t) place;
    }
    const int32_t after = global->next[head];

    global->next[node] = after;
    global->previous[node] = head;
    global->next[head] = node;
    global->previous[after] = node;
}

/* Lowers the cost-to-go of a node, and puts it to work. */
static void lower(nav_global_t *global, int32_t node, double cost_s)
{
    if (cost_s < global->cost_to_go_s[node])
    {
        global->cost_to_go_s[node] = cost_s;
        unlink_node(global, node);
        link_node(global, node);
    }
}

/* With all lists but the one beyond them empty: makes them start at the least cost there. */
static void open_window(nav_global_t *global)
{
    const int32_t head = NAV_NODES + NAV_BUCKETS;
    double least_s = NAV_COST_INFINITE;
    int32_t node = global->next[head];

    for (int32_t count = 0; NAV_ALWAYS(count < NAV_NODES) && (node != head); count++)
    {
        least_s = nav_min(least_s, global->cost_to_go_s[node]);
        node = global->next[node];
    }
    global->first_s = least_s;
    global->bucket = 0;
    node = global->next[head];
    global->next[head] = head;
    global->previous[head] = head;
    for (int32_t count = 0; NAV_ALWAYS(count < NAV_NODES) && (node != head); count++)
    {
        const int32_t after = global->next[node];

        link_node(global, node);
        node = after;
    }
}

static bool find_list(nav_global_t *global)
{
    while ((global->bucket < NAV_BUCKETS) &&
           (global->next[NAV_NODES + global->bucket] == (NAV_NODES + global->bucket)))
    {
        global->bucket += 1;
    }
    return global->bucket < NAV_BUCKETS;
}

/*
 * Takes a node of the first list that has one. An interval is shorter than any edge, so that no node of
 * the list can lower another: which of them is taken does not matter.
 * @return NAV_NO_NODE when there are none
 */
static int32_t take_next(nav_global_t *global)
{
    int32_t node = NAV_NO_NODE;
    bool is_found = find_list(global);

    if (!is_found)
    {
        open_window(global);
        is_found = find_list(global);
    }
    if (is_found)
    {
        node = global->next[NAV_NODES + global->bucket];
        unlink_node(global, node);
    }
    return node;
}

static int32_t neighbor_at(int32_t node, nav_step_t step)
{
    return node + (step.row * NAV_STRIDE) + step.col;
}

/* No squeezing through between two blocked cells that touch at a corner. */
static bool is_step_open(const nav_global_t *global, int32_t node, nav_step_t step)
{
    return (!is_blocked(global, neighbor_at(node, step))) &&
           (!(is_blocked(global, node + (step.row * NAV_STRIDE)) &&
              is_blocked(global, node + step.col)));
}

/* The heading along which a step is driven, one way or the other. */
static uint32_t step_heading(int32_t neighbor)
{
    static const uint8_t headings[NAV_NEIGHBORS] = {1, 0, 3, 2, 2, 3, 0, 1};

    return headings[neighbor];
}

/* Barred at either end, or squeezing through between two barred cells that touch at a corner. */
static bool is_step_barred(const nav_global_t *global, int32_t node, int32_t index)
{
    const nav_step_t step = step_to(index);
    const uint32_t ends = (uint32_t) global->barred_headings[node] |
                          (uint32_t) global->barred_headings[neighbor_at(node, step)];
    const uint32_t sides = (uint32_t) global->barred_headings[node + (step.row * NAV_STRIDE)] &
                           (uint32_t) global->barred_headings[node + step.col];

    return (((ends | sides) >> step_heading(index)) & 1U) != 0U;
}

/* Of a part of a step to a neighbour, driven one way or the other. */
static double step_cost_s(const nav_global_t *global, int32_t node, int32_t index, double length_m)
{
    const int32_t neighbor = neighbor_at(node, step_to(index));
    const double cost_s =
        length_m * ((global->cost_s_per_m[node] + global->cost_s_per_m[neighbor]) * 0.5);

    return is_step_barred(global, node, index) ? (cost_s * global->barred_factor) : cost_s;
}

static double step_length_m(nav_step_t step, double cell_m)
{
    const bool is_diagonal = (step.row != 0) && (step.col != 0);

    return is_diagonal ? (cell_m * NAV_SQRT_2) : cell_m;
}

static void relax_neighbors(nav_global_t *global, int32_t node, double cell_m)
{
    for (int32_t index = 0; index < NAV_NEIGHBORS; index++)
    {
        const nav_step_t step = step_to(index);
        const int32_t neighbor = neighbor_at(node, step);
        const double cost_s = global->cost_to_go_s[node] +
                              step_cost_s(global, node, index, step_length_m(step, cell_m));

        if ((cost_s < global->cost_to_go_s[neighbor]) && is_step_open(global, node, step))
        {
            lower(global, neighbor, cost_s);
        }
    }
}

static nav_waydisc_t center_of_node(const nav_costmap_t *map, int32_t node)
{
    const int32_t row = (node / NAV_STRIDE) - 1;
    const int32_t col = (node % NAV_STRIDE) - 1;
    const nav_waydisc_t center = {((double) map->origin_row + (double) row + 0.5) * map->cell_m,
                                  ((double) map->origin_col + (double) col + 0.5) * map->cell_m,
                                  0.0};

    return center;
}

static double distance_to_node_m(const nav_costmap_t *map,
                                 int32_t node,
                                 double x_site_m,
                                 double y_site_m)
{
    const nav_waydisc_t center = center_of_node(map, node);
    const double dx = center.x_site_m - x_site_m;
    const double dy = center.y_site_m - y_site_m;

    return sqrt((dx * dx) + (dy * dy));
}

/* @return whether a position lies on the map, and its node */
static bool find_node(const nav_costmap_t *map, double x_site_m, double y_site_m, int32_t *node)
{
    uint32_t cell = 0U;
    const bool is_found = nav_costmap_find(map, x_site_m, y_site_m, &cell);

    *node = node_at((int32_t) cell / NAV_SIZE, (int32_t) cell % NAV_SIZE);
    return is_found;
}

static double unknown_ground_s_per_m(const nav_params_t *params)
{
    return params->cost_unknown_factor / params->speed_max_m_per_s;
}

static double free_cost_s_per_m(const nav_cost_cell_t *cell,
                                const nav_params_t *params,
                                bool use_terrain,
                                bool use_zones)
{
    double cost_s_per_m = 1.0 / params->speed_max_m_per_s;

    if (nav_costmap_reason(cell, use_terrain, use_zones) != NAV_REASON_NONE)
    {
        cost_s_per_m = NAV_COST_BLOCKED_S_PER_M;
    }
    else if (use_terrain)
    {
        cost_s_per_m = (double) cell->cost_s_per_m;
    }
    else
    {
        /* all free ground costs the same */
    }
    return cost_s_per_m;
}

static void reset(nav_global_t *global,
                  const nav_costmap_t *map,
                  const nav_params_t *params,
                  bool use_terrain,
                  bool use_zones)
{
    double least_s_per_m = NAV_COST_BLOCKED_S_PER_M;

    for (int32_t node = 0; node < NAV_NODES; node++)
    {
        global->cost_s_per_m[node] = NAV_COST_BLOCKED_S_PER_M;
        global->barred_headings[node] = 0U;
        global->cost_to_go_s[node] = NAV_COST_INFINITE;
    }
    for (int32_t link = 0; link < (int32_t) NAV_GLOBAL_LINKS; link++)
    {
        global->next[link] = link;
        global->previous[link] = link;
    }
    for (int32_t row = 0; row < NAV_SIZE; row++)
    {
        for (int32_t col = 0; col < NAV_SIZE; col++)
        {
            const nav_cost_cell_t *cell = &map->cells[(row * NAV_SIZE) + col];
            const double cost_s_per_m = free_cost_s_per_m(cell, params, use_terrain, use_zones);

            global->cost_s_per_m[node_at(row, col)] = cost_s_per_m;
            global->barred_headings[node_at(row, col)] =
                use_terrain ? (uint8_t) nav_costmap_barred(cell) : 0U;
            least_s_per_m = nav_min(least_s_per_m, cost_s_per_m);
        }
    }
    global->first_s = 0.0;
    global->barred_factor = params->cost_barred_factor;
    global->buckets_per_s = 2.0 / (nav_max(least_s_per_m, NAV_COST_LEAST_S_PER_M) * map->cell_m);
    global->bucket = 0;
}

/* Goal on the map: the free cells inside the waydisc, or else the free cell nearest to it. */
static void seed_inside(nav_global_t *global,
                        const nav_costmap_t *map,
                        const nav_waydisc_t *goal,
                        int32_t goal_node)
{
    int32_t nearest = NAV_NO_NODE;
    double nearest_m = NAV_COST_INFINITE;
    bool is_seeded = false;

    for (int32_t node = 0; node < NAV_NODES; node++)
    {
        if (!is_blocked(global, node))
        {
            const double distance_m = distance_to_node_m(map, node, goal->x_site_m, goal->y_site_m);

            if ((node == goal_node) || (distance_m <= goal->radius_m))
            {
                lower(global, node, 0.0);
                is_seeded = true;
            }
            if (distance_m < nearest_m)
            {
                nearest = node;
                nearest_m = distance_m;
            }
        }
    }
    if ((!is_seeded) && (nearest != NAV_NO_NODE))
    {
        lower(global, nearest, 0.0);
    }
}

/* The row or column of the edge that faces a goal beyond it; -1 when the goal is not beyond. */
static int32_t facing_edge(double goal_m, double cell_m, int32_t origin)
{
    /* as nav_costmap_find sees it: a goal that it does not find faces an edge for certain */
    const double index = floor(goal_m * (1.0 / cell_m));
    int32_t edge = -1;

    if (index < (double) origin)
    {
        edge = 0;
    }
    else if (index >= ((double) origin + (double) NAV_SIZE))
    {
        edge = NAV_SIZE - 1;
    }
    else
    {
        /* beside the map in the other direction */
    }
    return edge;
}

/* Goal off the map: the free cells of the edges that face it. */
static void seed_outside(nav_global_t *global,
                         const nav_costmap_t *map,
                         const nav_params_t *params,
                         const nav_waydisc_t *goal)
{
    const int32_t edge_row = facing_edge(goal->x_site_m, map->cell_m, map->origin_row);
    const int32_t edge_col = facing_edge(goal->y_site_m, map->cell_m, map->origin_col);

    for (int32_t row = 0; row < NAV_SIZE; row++)
    {
        for (int32_t col = 0; col < NAV_SIZE; col++)
        {
            const int32_t node = node_at(row, col);
            const bool is_facing = (row == edge_row) || (col == edge_col);

            if (is_facing && (!is_blocked(global, node)))
            {
                const double way_m = distance_to_node_m(map, node, goal->x_site_m, goal->y_site_m);

                lower(global, node, way_m * unknown_ground_s_per_m(params));
            }
        }
    }
}

/* The first neighbour through which a node reaches the goal; the node itself when it is a seed. */
static int32_t next_node(const nav_global_t *global, int32_t node, double cell_m)
{
    int32_t next = node;

    for (int32_t index = 0; (index < NAV_NEIGHBORS) && (next == node); index++)
    {
        const nav_step_t step = step_to(index);
        const int32_t neighbor = neighbor_at(node, step);
        const double cost_s = global->cost_to_go_s[neighbor] +
                              step_cost_s(global, node, index, step_length_m(step, cell_m));

        /* the plan made the node's cost by this very sum: it is met to the last bit */
        if ((cost_s <= global->cost_to_go_s[node]) && is_step_open(global, node, step))
        {
            next = neighbor;
        }
    }
    return next;
}

static double least_over_neighbors_s(const nav_global_t *global,
                                     const nav_costmap_t *map,
                                     int32_t node,
                                     double x_site_m,
                                     double y_site_m)
{
    const double own_m = distance_to_node_m(map, node, x_site_m, y_site_m);
    double least_s = global->cost_to_go_s[node] + (own_m * global->cost_s_per_m[node]);

    for (int32_t index = 0; index < NAV_NEIGHBORS; index++)
    {
        const nav_step_t step = step_to(index);
        const int32_t neighbor = neighbor_at(node, step);

        if (is_step_open(global, node, step))
        {
            const double way_m = distance_to_node_m(map, neighbor, x_site_m, y_site_m);

            least_s = nav_min(least_s, global->cost_to_go_s[neighbor] +
                                           step_cost_s(global, node, index, way_m));
        }
    }
    return nav_min(least_s, NAV_COST_INFINITE);
}

void nav_global_plan(nav_global_t *global,
                     const nav_costmap_t *map,
                     const nav_params_t *params,
                     const nav_waydisc_t *goal,
                     bool use_terrain,
                     bool use_zones)
{
    int32_t node = NAV_NO_NODE;
    const bool is_inside = find_node(map, goal->x_site_m, goal->y_site_m, &node);

    reset(global, map, params, use_terrain, use_zones);
    global->is_goal_inside = is_inside ? 1U : 0U;
    if (is_inside)
    {
        seed_inside(global, map, goal, node);
    }
    else
    {
        seed_outside(global, map, params, goal);
    }
    /* each node is taken once, with its final cost */
    node = take_next(global);
    for (int32_t taken = 0; NAV_ALWAYS(taken < NAV_NODES) && (node != NAV_NO_NODE); taken++)
    {
        relax_neighbors(global, node, map->cell_m);
        node = take_next(global);
    }
}

double nav_global_cost_to_go_s(const nav_global_t *global,
                               const nav_costmap_t *map,
                               const nav_params_t *params,
                               const nav_waydisc_t *goal,
                               double x_site_m,
                               double y_site_m)
{
    int32_t node = NAV_NO_NODE;
    double cost_s = NAV_COST_INFINITE;

    if (!find_node(map, x_site_m, y_site_m, &node))
    {
        const double dx = goal->x_site_m - x_site_m;
        const double dy = goal->y_site_m - y_site_m;

        cost_s = nav_min(sqrt((dx * dx) + (dy * dy)) * unknown_ground_s_per_m(params),
                         NAV_COST_INFINITE);
    }
    else if (!is_blocked(global, node))
    {
        cost_s = least_over_neighbors_s(global, map, node, x_site_m, y_site_m);
    }
    else
    {
        cost_s = NAV_COST_INFINITE;
    }
    return cost_s;
}

uint32_t nav_global_descend(const nav_global_t *global,
                            const nav_costmap_t *map,
                            double x_site_m,
                            double y_site_m,
                            nav_point_t *points,
                            uint32_t capacity)
{
    int32_t node = NAV_NO_NODE;
    uint32_t point_count = 0U;
    bool is_going = find_node(map, x_site_m, y_site_m, &node) &&
                    (global->cost_to_go_s[node] < NAV_COST_INFINITE);

    for (uint32_t step = 0U;
         NAV_ALWAYS(step < (uint32_t) NAV_NODES) && is_going && (point_count < capacity); step++)
    {
        const nav_waydisc_t center = center_of_node(map, node);
        const int32_t next = next_node(global, node, map->cell_m);

        points[point_count].x_m = (float) center.x_site_m;
        points[point_count].y_m = (float) center.y_site_m;
        points[point_count].z_m = 0.0F;
        point_count += 1U;
        is_going = next != node;
        node = next;
    }
    return point_count;
}
