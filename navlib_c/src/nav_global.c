/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_global.c
 * @brief Dijkstra over the costmap with an indexed binary heap.
 */
#include "nav_global.h"

#include <math.h>

#include "nav_guard.h"
#include "nav_math.h"
#include "nav_minmax.h"

#define NAV_SIZE ((int32_t) NAV_COSTMAP_SIZE)
#define NAV_CELLS ((uint32_t) NAV_COSTMAP_SIZE * (uint32_t) NAV_COSTMAP_SIZE)
#define NAV_NEIGHBORS 8U
#define NAV_SQRT_2 1.41421356237309504880169

/* More than the levels of a heap of any number of cells. */
#define NAV_HEAP_LEVELS_MAX 32U

typedef struct
{
    int32_t row;
    int32_t col;
} nav_step_t;

static nav_step_t step_to(uint32_t neighbor)
{
    static const nav_step_t steps[NAV_NEIGHBORS] = {{-1, -1}, {-1, 0}, {-1, 1}, {0, -1},
                                                    {0, 1},   {1, -1}, {1, 0},  {1, 1}};

    return steps[neighbor];
}

static bool is_blocked(const nav_global_t *global, uint32_t cell)
{
    return global->cost_s_per_m[cell] >= NAV_COST_INFINITE;
}

static bool is_before(const nav_global_t *global, uint32_t cell, uint32_t other)
{
    const double cost_s = global->cost_to_go_s[cell];
    const double other_s = global->cost_to_go_s[other];

    return (cost_s < other_s) || ((cost_s <= other_s) && (cell < other));
}

/* Places are 1-based: the children of p are 2p and 2p + 1. */
static void put(nav_global_t *global, uint32_t place, uint32_t cell)
{
    global->heap[place - 1U] = cell;
    global->heap_place[cell] = place;
}

static void sift_up(nav_global_t *global, uint32_t cell)
{
    uint32_t place = global->heap_place[cell];
    bool is_placed = false;

    for (uint32_t level = 0U; NAV_ALWAYS(level < NAV_HEAP_LEVELS_MAX) && (!is_placed); level++)
    {
        is_placed = (place == 1U) || is_before(global, global->heap[(place / 2U) - 1U], cell);
        if (!is_placed)
        {
            put(global, place, global->heap[(place / 2U) - 1U]);
            place /= 2U;
        }
    }
    put(global, place, cell);
}

static uint32_t first_child(const nav_global_t *global, uint32_t place)
{
    uint32_t child = 2U * place;

    if ((child < global->heap_count) &&
        is_before(global, global->heap[child], global->heap[child - 1U]))
    {
        child += 1U;
    }
    return child;
}

static void sift_down_from_top(nav_global_t *global, uint32_t cell)
{
    uint32_t place = 1U;
    bool is_placed = false;

    for (uint32_t level = 0U; NAV_ALWAYS(level < NAV_HEAP_LEVELS_MAX) && (!is_placed); level++)
    {
        const uint32_t child = first_child(global, place);

        is_placed =
            (child > global->heap_count) || is_before(global, cell, global->heap[child - 1U]);
        if (!is_placed)
        {
            put(global, place, global->heap[child - 1U]);
            place = child;
        }
    }
    put(global, place, cell);
}

static uint32_t take_least(nav_global_t *global)
{
    const uint32_t least = global->heap[0];
    const uint32_t last = global->heap[global->heap_count - 1U];

    global->heap_place[least] = 0U;
    global->heap_count -= 1U;
    if (global->heap_count > 0U)
    {
        sift_down_from_top(global, last);
    }
    return least;
}

/* Lowers the cost-to-go of a cell, and queues it if it was not. */
static void lower(nav_global_t *global, uint32_t cell, double cost_s)
{
    if (cost_s < global->cost_to_go_s[cell])
    {
        global->cost_to_go_s[cell] = cost_s;
        if (global->heap_place[cell] == 0U)
        {
            global->heap_count += 1U;
            global->heap_place[cell] = global->heap_count;
        }
        sift_up(global, cell);
    }
}

/* @return whether one can go to the neighbour, and which cell it is */
static bool find_neighbor(const nav_global_t *global,
                          uint32_t cell,
                          nav_step_t step,
                          uint32_t *neighbor)
{
    const int32_t row = (int32_t) cell / NAV_SIZE;
    const int32_t col = (int32_t) cell % NAV_SIZE;
    const int32_t to_row = row + step.row;
    const int32_t to_col = col + step.col;
    bool is_open = (to_row >= 0) && (to_row < NAV_SIZE) && (to_col >= 0) && (to_col < NAV_SIZE);

    *neighbor = cell;
    if (is_open)
    {
        const int32_t beside_row = (row * NAV_SIZE) + to_col;
        const int32_t beside_col = (to_row * NAV_SIZE) + col;
        const int32_t to_cell = (to_row * NAV_SIZE) + to_col;

        *neighbor = (uint32_t) to_cell;
        /* no squeezing through between two blocked cells that touch at a corner */
        is_open =
            (!is_blocked(global, *neighbor)) && (!(is_blocked(global, (uint32_t) beside_row) &&
                                                   is_blocked(global, (uint32_t) beside_col)));
    }
    return is_open;
}

static double edge_cost_s(const nav_global_t *global,
                          uint32_t cell,
                          uint32_t neighbor,
                          double length_m)
{
    return length_m * ((global->cost_s_per_m[cell] + global->cost_s_per_m[neighbor]) * 0.5);
}

static double step_length_m(nav_step_t step, double cell_m)
{
    const bool is_diagonal = (step.row != 0) && (step.col != 0);

    return is_diagonal ? (cell_m * NAV_SQRT_2) : cell_m;
}

static void relax_neighbors(nav_global_t *global, uint32_t cell, double cell_m)
{
    for (uint32_t index = 0U; index < NAV_NEIGHBORS; index++)
    {
        const nav_step_t step = step_to(index);
        uint32_t neighbor = 0U;

        if (find_neighbor(global, cell, step, &neighbor))
        {
            const double length_m = step_length_m(step, cell_m);

            lower(global, neighbor,
                  global->cost_to_go_s[cell] + edge_cost_s(global, cell, neighbor, length_m));
        }
    }
}

static nav_waydisc_t center_of_cell(const nav_costmap_t *map, uint32_t cell)
{
    const int32_t row = (int32_t) cell / NAV_SIZE;
    const int32_t col = (int32_t) cell % NAV_SIZE;
    const nav_waydisc_t center = {((double) map->origin_row + (double) row + 0.5) * map->cell_m,
                                  ((double) map->origin_col + (double) col + 0.5) * map->cell_m,
                                  0.0};

    return center;
}

static double distance_to_cell_m(const nav_costmap_t *map,
                                 uint32_t cell,
                                 double x_site_m,
                                 double y_site_m)
{
    const nav_waydisc_t center = center_of_cell(map, cell);
    const double dx = center.x_site_m - x_site_m;
    const double dy = center.y_site_m - y_site_m;

    return sqrt((dx * dx) + (dy * dy));
}

static double unknown_ground_s_per_m(const nav_params_t *params)
{
    return params->cost_unknown_factor / params->speed_max_m_per_s;
}

static void reset(nav_global_t *global,
                  const nav_costmap_t *map,
                  const nav_params_t *params,
                  bool use_terrain,
                  bool use_zones)
{
    for (uint32_t cell = 0U; cell < NAV_CELLS; cell++)
    {
        double cost_s_per_m = 1.0 / params->speed_max_m_per_s;

        if (nav_costmap_reason(&map->cells[cell], params, use_terrain, use_zones) !=
            NAV_REASON_NONE)
        {
            cost_s_per_m = NAV_COST_INFINITE;
        }
        else if (use_terrain)
        {
            cost_s_per_m = (double) map->cells[cell].cost_s_per_m;
        }
        else
        {
            /* all free ground costs the same */
        }
        global->cost_s_per_m[cell] = cost_s_per_m;
        global->cost_to_go_s[cell] = NAV_COST_INFINITE;
        global->heap_place[cell] = 0U;
    }
    global->heap_count = 0U;
}

/* Goal on the map: the free cells inside the waydisc, or else the free cell nearest to it. */
static void seed_inside(nav_global_t *global,
                        const nav_costmap_t *map,
                        const nav_waydisc_t *goal,
                        uint32_t goal_cell)
{
    uint32_t nearest = NAV_CELLS;
    double nearest_m = NAV_COST_INFINITE;

    for (uint32_t cell = 0U; cell < NAV_CELLS; cell++)
    {
        if (!is_blocked(global, cell))
        {
            const double distance_m = distance_to_cell_m(map, cell, goal->x_site_m, goal->y_site_m);

            if ((cell == goal_cell) || (distance_m <= goal->radius_m))
            {
                lower(global, cell, 0.0);
            }
            if (distance_m < nearest_m)
            {
                nearest = cell;
                nearest_m = distance_m;
            }
        }
    }
    if ((global->heap_count == 0U) && (nearest < NAV_CELLS))
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

    for (uint32_t cell = 0U; cell < NAV_CELLS; cell++)
    {
        const int32_t row = (int32_t) cell / NAV_SIZE;
        const int32_t col = (int32_t) cell % NAV_SIZE;
        const bool is_facing = (row == edge_row) || (col == edge_col);

        if (is_facing && (!is_blocked(global, cell)))
        {
            const double way_m = distance_to_cell_m(map, cell, goal->x_site_m, goal->y_site_m);

            lower(global, cell, way_m * unknown_ground_s_per_m(params));
        }
    }
}

/* The first neighbour through which a cell reaches the goal; the cell itself when it is a seed. */
static uint32_t next_cell(const nav_global_t *global, uint32_t cell, double cell_m)
{
    uint32_t next = cell;

    for (uint32_t index = 0U; (index < NAV_NEIGHBORS) && (next == cell); index++)
    {
        const nav_step_t step = step_to(index);
        uint32_t neighbor = 0U;

        if (find_neighbor(global, cell, step, &neighbor))
        {
            const double length_m = step_length_m(step, cell_m);
            const double cost_s =
                global->cost_to_go_s[neighbor] + edge_cost_s(global, neighbor, cell, length_m);

            /* the plan made the cell's cost by this very sum: it is met to the last bit */
            if (cost_s <= global->cost_to_go_s[cell])
            {
                next = neighbor;
            }
        }
    }
    return next;
}

static double least_over_neighbors_s(const nav_global_t *global,
                                     const nav_costmap_t *map,
                                     uint32_t cell,
                                     double x_site_m,
                                     double y_site_m)
{
    const double own_m = distance_to_cell_m(map, cell, x_site_m, y_site_m);
    double least_s = global->cost_to_go_s[cell] + edge_cost_s(global, cell, cell, own_m);

    for (uint32_t index = 0U; index < NAV_NEIGHBORS; index++)
    {
        uint32_t neighbor = 0U;

        if (find_neighbor(global, cell, step_to(index), &neighbor))
        {
            const double way_m = distance_to_cell_m(map, neighbor, x_site_m, y_site_m);

            least_s = nav_min(least_s, global->cost_to_go_s[neighbor] +
                                           edge_cost_s(global, cell, neighbor, way_m));
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
    uint32_t goal_cell = 0U;
    const bool is_inside = nav_costmap_find(map, goal->x_site_m, goal->y_site_m, &goal_cell);

    reset(global, map, params, use_terrain, use_zones);
    global->is_goal_inside = is_inside ? 1U : 0U;
    if (is_inside)
    {
        seed_inside(global, map, goal, goal_cell);
    }
    else
    {
        seed_outside(global, map, params, goal);
    }
    /* costs are positive: each cell is taken once, with its final cost */
    for (uint32_t taken = 0U; (taken < NAV_CELLS) && (global->heap_count > 0U); taken++)
    {
        relax_neighbors(global, take_least(global), map->cell_m);
    }
}

double nav_global_cost_to_go_s(const nav_global_t *global,
                               const nav_costmap_t *map,
                               const nav_params_t *params,
                               const nav_waydisc_t *goal,
                               double x_site_m,
                               double y_site_m)
{
    uint32_t cell = 0U;
    double cost_s = NAV_COST_INFINITE;

    if (!nav_costmap_find(map, x_site_m, y_site_m, &cell))
    {
        const double dx = goal->x_site_m - x_site_m;
        const double dy = goal->y_site_m - y_site_m;

        cost_s = nav_min(sqrt((dx * dx) + (dy * dy)) * unknown_ground_s_per_m(params),
                         NAV_COST_INFINITE);
    }
    else if (!is_blocked(global, cell))
    {
        cost_s = least_over_neighbors_s(global, map, cell, x_site_m, y_site_m);
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
    uint32_t cell = 0U;
    uint32_t point_count = 0U;
    bool is_going = nav_costmap_find(map, x_site_m, y_site_m, &cell) &&
                    (global->cost_to_go_s[cell] < NAV_COST_INFINITE);

    for (uint32_t step = 0U; NAV_ALWAYS(step < NAV_CELLS) && is_going && (point_count < capacity);
         step++)
    {
        const nav_waydisc_t center = center_of_cell(map, cell);
        const uint32_t next = next_cell(global, cell, map->cell_m);

        points[point_count].x_m = (float) center.x_site_m;
        points[point_count].y_m = (float) center.y_site_m;
        points[point_count].z_m = 0.0F;
        point_count += 1U;
        is_going = next != cell;
        cell = next;
    }
    return point_count;
}
