/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_passage.c
 * @brief Obstacles of costmap cells as bits, held against the bits of a footprint.
 */
#include "nav_passage.h"

#include <math.h>

#include "nav_math.h"

#define SIZE ((int32_t) NAV_COSTMAP_SIZE)
#define SIDE ((int32_t) NAV_CELLS_PER_COST_CELL)
#define HEADINGS ((uint32_t) NAV_HEADINGS)
#define MIDDLE (0.5 * ((double) NAV_CELLS_PER_COST_CELL - 1.0))

_Static_assert((NAV_CELLS_PER_COST_CELL * NAV_CELLS_PER_COST_CELL) <= 32, "one bit for each cell");
_Static_assert(NAV_HEADINGS <= 8, "one bit for each heading");

/** A place in the rover's frame. */
typedef struct
{
    double forward_m;
    double right_m;
} place_t;

static place_t place_at(double north_m, double east_m, uint32_t heading)
{
    const double yaw_rad = (NAV_PI / (double) HEADINGS) * (double) heading;
    const double cos_yaw = nav_cos(yaw_rad);
    const double sin_yaw = nav_sin(yaw_rad);
    const place_t place = {(north_m * cos_yaw) + (east_m * sin_yaw),
                           (east_m * cos_yaw) - (north_m * sin_yaw)};
    return place;
}

static bool is_under_belly(const nav_params_t *params, place_t place)
{
    const double grown_m = params->barred_growth_m;
    return (place.forward_m <= (params->belly_front_x_m + grown_m)) &&
           (place.forward_m >= (params->belly_rear_x_m - grown_m)) &&
           (fabs(place.right_m) <= (params->belly_half_width_m + grown_m));
}

static bool is_under_wheel(const nav_params_t *params, place_t place)
{
    const double hubs_m[NAV_WHEELS / 2][2] = {{params->front_x_m, params->front_y_m},
                                              {params->middle_x_m, params->middle_y_m},
                                              {params->rear_x_m, params->rear_y_m}};
    const double half_length_m = params->wheel_radius_m + params->barred_growth_m;
    const double half_width_m = (0.5 * params->wheel_width_m) + params->barred_growth_m;
    bool is_under = false;
    for (uint32_t k = 0U; k < ((uint32_t) NAV_WHEELS / 2U); k++)
    {
        is_under = is_under || ((fabs(place.forward_m - hubs_m[k][0]) <= half_length_m) &&
                                (fabs(fabs(place.right_m) - hubs_m[k][1]) <= half_width_m));
    }
    return is_under;
}

/** Lays one heading of the footprint over a costmap cell. */
static void lay_heading(const nav_params_t *params,
                        nav_rover_footprint_cell_t *cell,
                        uint32_t heading)
{
    cell->belly[heading] = 0U;
    cell->wheels[heading] = 0U;
    for (int32_t row = 0; row < SIDE; row++)
    {
        const double north = ((double) (cell->row * SIDE) + (double) row) - MIDDLE;
        for (int32_t col = 0; col < SIDE; col++)
        {
            const double east = ((double) (cell->col * SIDE) + (double) col) - MIDDLE;
            const place_t place = place_at(north * params->heightmap_cell_m,
                                           east * params->heightmap_cell_m, heading);
            const uint32_t bit = (uint32_t) 1U << (uint32_t) ((row * SIDE) + col);
            cell->belly[heading] |= is_under_belly(params, place) ? bit : 0U;
            cell->wheels[heading] |= is_under_wheel(params, place) ? bit : 0U;
        }
    }
}

void nav_passage_init(const nav_params_t *params, nav_rover_footprint_t *footprint)
{
    const int32_t reach = NAV_PASSAGE_REACH;
    footprint->count = 0U;
    for (int32_t row = -reach; row <= reach; row++)
    {
        for (int32_t col = -reach; col <= reach; col++)
        {
            nav_rover_footprint_cell_t *cell = &footprint->cells[footprint->count];
            uint32_t touched = 0U;
            cell->row = row;
            cell->col = col;
            for (uint32_t heading = 0U; heading < HEADINGS; heading++)
            {
                lay_heading(params, cell, heading);
                touched |= cell->belly[heading] | cell->wheels[heading];
            }
            footprint->count += (touched != 0U) ? 1U : 0U;
        }
    }
}

/** From the plane to what is an obstacle. */
typedef struct
{
    double belly_m; /* up */
    double wheel_m; /* up or down */
} nav_obstacle_limits_t;

static nav_obstacle_limits_t obstacle_limits(const nav_params_t *params)
{
    const nav_obstacle_limits_t limits = {(params->belly_height_m - params->clearance_min_m) -
                                              params->barred_margin_m,
                                          params->wheel_drop_max_m - params->barred_margin_m};
    return limits;
}

/** Marks what stands in the way in a costmap cell, whose first heightmap cell is the given one. */
static void find_obstacles(nav_cost_cell_t *cell,
                           const nav_params_t *params,
                           const float *z_site_m,
                           double cell_m)
{
    const nav_obstacle_limits_t limits = obstacle_limits(params);
    const double per_row_m = (double) cell->plane_dz_dx * cell_m;
    const double per_col_m = (double) cell->plane_dz_dy * cell_m;
    uint32_t belly = 0U;
    uint32_t wheel = 0U;
    for (int32_t row = 0; row < SIDE; row++)
    {
        for (int32_t col = 0; col < SIDE; col++)
        {
            const double z_m = (double) z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col];
            const double up_m = (double) cell->plane_z_site_m +
                                (((double) row - MIDDLE) * per_row_m) +
                                (((double) col - MIDDLE) * per_col_m) - z_m;
            const uint32_t bit = (uint32_t) 1U << (uint32_t) ((row * SIDE) + col);
            const uint32_t known_bit = (z_m < (double) NAV_SURFACE_UNKNOWN_M) ? bit : 0U;
            belly |= (up_m > limits.belly_m) ? known_bit : 0U;
            wheel |= (fabs(up_m) > limits.wheel_m) ? known_bit : 0U;
        }
    }
    cell->belly_obstacles = belly;
    cell->wheel_obstacles = wheel;
}

/** Is all ground of a cell so near to its plane that nothing in it is an obstacle? */
static bool is_plain(const nav_params_t *params, const nav_relief_cell_t *relief)
{
    const nav_obstacle_limits_t limits = obstacle_limits(params);
    const double above_m = (double) relief->above_m;
    return (relief->is_whole != 0U) && (above_m <= limits.belly_m) && (above_m <= limits.wheel_m) &&
           ((double) relief->below_m >= -limits.wheel_m);
}

static void update_obstacles(nav_costmap_t *map,
                             const nav_costmap_state_t *state,
                             const nav_params_t *params,
                             const nav_relief_t *relief,
                             const nav_surface_t *surface)
{
    for (int32_t index = 0; index < (SIZE * SIZE); index++)
    {
        if (state->fitted_at[index] == state->surface_count)
        {
            const int32_t row = ((map->origin_row + (index / SIZE)) * SIDE) - surface->origin_row;
            const int32_t col = ((map->origin_col + (index % SIZE)) * SIDE) - surface->origin_col;
            nav_cost_cell_t *cell = &map->cells[index];
            if ((cell->is_known == 0U) || is_plain(params, &relief->cells[index]))
            {
                cell->belly_obstacles = 0U;
                cell->wheel_obstacles = 0U;
            }
            else
            {
                find_obstacles(cell, params, &surface->z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col],
                               surface->cell_m);
            }
        }
    }
}

/** Headings along which one cell of the footprint would touch an obstacle. */
static uint32_t touched_headings(const nav_rover_footprint_cell_t *part,
                                 const nav_cost_cell_t *obstacle)
{
    uint32_t headings = 0U;
    for (uint32_t heading = 0U; heading < HEADINGS; heading++)
    {
        const uint32_t touched = (part->belly[heading] & obstacle->belly_obstacles) |
                                 (part->wheels[heading] & obstacle->wheel_obstacles);
        headings |= (touched != 0U) ? ((uint32_t) 1U << heading) : 0U;
    }
    return headings;
}

/** Bars the cells in which the rover would touch the obstacles of a cell. */
static void bar_around(nav_costmap_t *map,
                       const nav_rover_footprint_t *footprint,
                       int32_t row,
                       int32_t col)
{
    const nav_cost_cell_t obstacle = map->cells[(row * SIZE) + col];
    for (uint32_t k = 0U; k < footprint->count; k++)
    {
        const nav_rover_footprint_cell_t *part = &footprint->cells[k];
        const int32_t rover_row = row - part->row;
        const int32_t rover_col = col - part->col;
        if ((rover_row >= 0) && (rover_row < SIZE) && (rover_col >= 0) && (rover_col < SIZE))
        {
            nav_cost_cell_t *cell = &map->cells[(rover_row * SIZE) + rover_col];
            cell->barred_headings =
                (uint8_t) (cell->barred_headings | touched_headings(part, &obstacle));
        }
    }
}

void nav_passage_update(nav_costmap_t *map,
                        const nav_costmap_state_t *state,
                        const nav_params_t *params,
                        const nav_rover_footprint_t *footprint,
                        const nav_relief_t *relief,
                        const nav_surface_t *surface)
{
    update_obstacles(map, state, params, relief, surface);
    for (int32_t index = 0; index < (SIZE * SIZE); index++)
    {
        map->cells[index].barred_headings = 0U;
    }
    for (int32_t row = 0; row < SIZE; row++)
    {
        for (int32_t col = 0; col < SIZE; col++)
        {
            const nav_cost_cell_t *cell = &map->cells[(row * SIZE) + col];
            if ((cell->belly_obstacles | cell->wheel_obstacles) != 0U)
            {
                bar_around(map, footprint, row, col);
            }
        }
    }
}
