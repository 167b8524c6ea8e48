/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_costmap.c
 * @brief Plane fits, zones and ACE's failures, cell by cell.
 */
#include "nav_costmap.h"

#include <math.h>
#include <string.h>

#include "nav_guard.h"
#include "nav_math.h"
#include "nav_minmax.h"

#define NAV_SIZE ((int32_t) NAV_COSTMAP_SIZE)
#define NAV_BLOCK ((int32_t) NAV_CELLS_PER_COST_CELL)
#define NAV_CELLS (NAV_SIZE * NAV_SIZE)
#define NAV_SURFACE_SIZE ((int32_t) NAV_HEIGHTMAP_SIZE)

/* The reference of heights is a multiple of this: it hardly ever changes. */
#define NAV_REFERENCE_STEP_M 128.0
#define NAV_SIDE ((int32_t) NAV_BLOCKS_SIDE)
#define NAV_HEADING_COUNT ((uint32_t) NAV_HEADINGS)
#define NAV_ALL_HEADINGS (((uint32_t) 1U << NAV_HEADING_COUNT) - 1U)

/* Known cells on one line leave a determinant of rounding errors only. */
#define NAV_SINGULAR_SHARE 1.0e-9

/* The blocks of a surface: row and column 0 are those of its corner. */
typedef struct
{
    const nav_surface_t *surface;
    const nav_surface_state_t *changes;
    uint32_t seen_count; /* blocks with a greater number changed; 0: all */
    int32_t first_row;   /* global index of the first block, in costmap cells */
    int32_t first_col;
    int32_t table_row; /* where the first row stands in tables */
    int32_t table_col;
    int32_t patch_half; /* blocks to either side of the middle one */
} nav_window_t;

typedef struct
{
    double z_m;
    double dz_dx;
    double dz_dy;
    double roughness_m2;
} nav_plane_t;

static int32_t floor_quotient(int32_t index)
{
    return (index - nav_wrap_index(index, NAV_BLOCK)) / NAV_BLOCK;
}

static bool is_known(float z_m)
{
    return (z_m > -NAV_SURFACE_UNKNOWN_M) && (z_m < NAV_SURFACE_UNKNOWN_M);
}

/* Of the first known height among one in each block, rounded: a function of the surface alone. */
static double reference_height(const nav_surface_t *surface)
{
    double z_m = 0.0;
    bool is_found = false;

    for (int32_t row = 0; (row < NAV_SURFACE_SIZE) && (!is_found); row += NAV_BLOCK)
    {
        for (int32_t col = 0; (col < NAV_SURFACE_SIZE) && (!is_found); col += NAV_BLOCK)
        {
            const float first_m = surface->z_site_m[(row * NAV_SURFACE_SIZE) + col];

            is_found = is_known(first_m);
            z_m = is_found ? (double) first_m : 0.0;
        }
    }
    return NAV_REFERENCE_STEP_M * floor(z_m / NAV_REFERENCE_STEP_M);
}

static int32_t table_index(const nav_window_t *window, int32_t row, int32_t col)
{
    const int32_t table_row = window->table_row + row;
    const int32_t table_col = window->table_col + col;

    return (((table_row < NAV_SIDE) ? table_row : (table_row - NAV_SIDE)) * NAV_SIDE) +
           ((table_col < NAV_SIDE) ? table_col : (table_col - NAV_SIDE));
}

static bool is_changed(const nav_window_t *window, int32_t block)
{
    return window->changes->changed_at[block] > window->seen_count;
}

static void add_height(nav_moments_t *sum, double u, double v, double z)
{
    sum->count += 1.0;
    sum->u += u;
    sum->v += v;
    sum->z += z;
    sum->uu += u * u;
    sum->uv += u * v;
    sum->vv += v * v;
    sum->uz += u * z;
    sum->vz += v * z;
    sum->zz += z * z;
}

/* Adds sums whose middle lies u, v from the middle of the total. */
static void add_moved(nav_moments_t *total, const nav_moments_t *part, double u, double v)
{
    total->count += part->count;
    total->u += part->u + (u * part->count);
    total->v += part->v + (v * part->count);
    total->z += part->z;
    total->uu += part->uu + (u * ((2.0 * part->u) + (u * part->count)));
    total->uv += part->uv + (u * part->v) + (v * part->u) + (u * v * part->count);
    total->vv += part->vv + (v * ((2.0 * part->v) + (v * part->count)));
    total->uz += part->uz + (u * part->z);
    total->vz += part->vz + (v * part->z);
    total->zz += part->zz;
}

static nav_moments_t sum_block(const nav_window_t *window,
                               double z_reference_m,
                               int32_t block_row,
                               int32_t block_col)
{
    const double middle = ((double) NAV_BLOCK - 1.0) / 2.0;
    const int32_t first_row =
        ((window->first_row + block_row) * NAV_BLOCK) - window->surface->origin_row;
    const int32_t first_col =
        ((window->first_col + block_col) * NAV_BLOCK) - window->surface->origin_col;
    nav_moments_t sum = {0};

    for (int32_t row = 0; row < NAV_BLOCK; row++)
    {
        for (int32_t col = 0; col < NAV_BLOCK; col++)
        {
            const int32_t at_row = first_row + row;
            const int32_t at_col = first_col + col;

            if ((at_row >= 0) && (at_row < NAV_SURFACE_SIZE) && (at_col >= 0) &&
                (at_col < NAV_SURFACE_SIZE))
            {
                const float z_m = window->surface->z_site_m[(at_row * NAV_SURFACE_SIZE) + at_col];

                if (is_known(z_m))
                {
                    add_height(&sum, (double) row - middle, (double) col - middle,
                               (double) z_m - z_reference_m);
                }
            }
        }
    }
    return sum;
}

static void sum_blocks(const nav_window_t *window, nav_costmap_state_t *state)
{
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            const int32_t block = table_index(window, row, col);

            if (is_changed(window, block))
            {
                state->blocks[block] = sum_block(window, state->z_reference_m, row, col);
            }
        }
    }
}

/* Places from low to high that lie within half a patch of a place, and in the window. */
typedef struct
{
    int32_t low;
    int32_t high;
} nav_reach_t;

static nav_reach_t reach_of(const nav_window_t *window, int32_t place)
{
    const int32_t low = place - window->patch_half;
    const int32_t high = place + window->patch_half;
    const nav_reach_t reach = {(low > 0) ? low : 0, (high < NAV_SIDE) ? high : (NAV_SIDE - 1)};

    return reach;
}

/* Strips: for each block, the sum over the blocks beside it that belong to its patch. */
static void sum_strip(const nav_window_t *window,
                      nav_costmap_state_t *state,
                      int32_t row,
                      int32_t col)
{
    const nav_reach_t reach = reach_of(window, col);
    const int32_t strip = table_index(window, row, col);
    bool is_new = false;

    for (int32_t other = reach.low; (other <= reach.high) && (!is_new); other++)
    {
        is_new = is_changed(window, table_index(window, row, other));
    }
    state->is_strip_new[strip] = is_new ? 1U : 0U;
    if (is_new)
    {
        nav_moments_t sum = {0};

        for (int32_t other = reach.low; other <= reach.high; other++)
        {
            add_moved(&sum, &state->blocks[table_index(window, row, other)], 0.0,
                      ((double) other - (double) col) * (double) NAV_BLOCK);
        }
        state->strips[strip] = sum;
    }
}

static void sum_strips(const nav_window_t *window, nav_costmap_state_t *state)
{
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            sum_strip(window, state, row, col);
        }
    }
}

static bool is_patch_new(const nav_window_t *window,
                         const nav_costmap_state_t *state,
                         int32_t row,
                         int32_t col)
{
    const nav_reach_t reach = reach_of(window, row);
    bool is_new = false;

    for (int32_t other = reach.low; (other <= reach.high) && (!is_new); other++)
    {
        is_new = state->is_strip_new[table_index(window, other, col)] != 0U;
    }
    return is_new;
}

static nav_moments_t sum_patch(const nav_window_t *window,
                               const nav_costmap_state_t *state,
                               int32_t row,
                               int32_t col)
{
    const nav_reach_t reach = reach_of(window, row);
    nav_moments_t patch = {0};

    for (int32_t other = reach.low; other <= reach.high; other++)
    {
        add_moved(&patch, &state->strips[table_index(window, other, col)],
                  ((double) other - (double) row) * (double) NAV_BLOCK, 0.0);
    }
    return patch;
}

/*
 * Least squares for z = z0 + a u + b v: the normal equations, with z0 eliminated.
 * @return false when the known cells lie on one line
 */
static bool fit_plane(const nav_moments_t *sum, double cell_m, nav_plane_t *plane)
{
    const double uu = (sum->count * sum->uu) - (sum->u * sum->u);
    const double uv = (sum->count * sum->uv) - (sum->u * sum->v);
    const double vv = (sum->count * sum->vv) - (sum->v * sum->v);
    const double uz = (sum->count * sum->uz) - (sum->u * sum->z);
    const double vz = (sum->count * sum->vz) - (sum->v * sum->z);
    const double zz = (sum->count * sum->zz) - (sum->z * sum->z);
    const double determinant = (uu * vv) - (uv * uv);
    const bool is_fitted = determinant > (NAV_SINGULAR_SHARE * uu * vv);

    if (is_fitted)
    {
        const double a = ((vv * uz) - (uv * vz)) / determinant;
        const double b = ((uu * vz) - (uv * uz)) / determinant;
        const double residual = (zz - (a * uz) - (b * vz)) / (sum->count * sum->count);

        plane->z_m = (sum->z - (a * sum->u) - (b * sum->v)) / sum->count;
        plane->dz_dx = a / cell_m;
        plane->dz_dy = b / cell_m;
        plane->roughness_m2 = nav_max(residual, 0.0);
    }
    return is_fitted;
}

static double unknown_cost_s_per_m(const nav_params_t *params)
{
    return params->cost_unknown_factor / params->speed_max_m_per_s;
}

/* The cell as it is without any ground known; what ACE and the zones said stays. */
static void forget_ground(nav_cost_cell_t *cell, const nav_params_t *params)
{
    cell->plane_z_site_m = 0.0F;
    cell->plane_dz_dx = 0.0F;
    cell->plane_dz_dy = 0.0F;
    cell->tilt_rad = 0.0F;
    cell->roughness_m2 = 0.0F;
    cell->cost_s_per_m = (float) unknown_cost_s_per_m(params);
    cell->terrain_reason = (uint8_t) NAV_REASON_NONE;
    cell->is_known = 0U;
}

static void set_plane(nav_cost_cell_t *cell, const nav_params_t *params, const nav_plane_t *plane)
{
    const double slope = sqrt((plane->dz_dx * plane->dz_dx) + (plane->dz_dy * plane->dz_dy));
    const double tilt_rad = nav_atan2(slope, 1.0);
    const double cost_s_per_m = (1.0 / params->speed_max_m_per_s) +
                                (params->cost_tilt_s_per_m_rad * tilt_rad) +
                                (params->cost_roughness_s_per_m3 * plane->roughness_m2);

    if (NAV_NEVER((!nav_isfinite(plane->z_m)) || (!nav_isfinite(cost_s_per_m))))
    {
        forget_ground(cell, params);
        cell->terrain_reason = (uint8_t) NAV_REASON_UNEXPECTED;
    }
    else
    {
        cell->plane_z_site_m = (float) plane->z_m;
        cell->plane_dz_dx = (float) plane->dz_dx;
        cell->plane_dz_dy = (float) plane->dz_dy;
        cell->tilt_rad = (float) tilt_rad;
        cell->roughness_m2 = (float) plane->roughness_m2;
        cell->cost_s_per_m = (float) cost_s_per_m;
        cell->terrain_reason = (tilt_rad > params->tilt_max_rad) ? (uint8_t) NAV_REASON_TILT
                                                                 : (uint8_t) NAV_REASON_NONE;
        cell->is_known = 1U;
    }
}

static void judge_patch(nav_cost_cell_t *cell,
                        const nav_params_t *params,
                        const nav_window_t *window,
                        double z_reference_m,
                        const nav_moments_t *patch)
{
    const double side = ((2.0 * (double) window->patch_half) + 1.0) * (double) NAV_BLOCK;
    nav_plane_t plane = {0.0, 0.0, 0.0, 0.0};

    if (patch->count < (params->costmap_patch_known_min * side * side))
    {
        forget_ground(cell, params);
    }
    else if (!fit_plane(patch, window->surface->cell_m, &plane))
    {
        forget_ground(cell, params);
        cell->terrain_reason = (uint8_t) NAV_REASON_UNEXPECTED;
    }
    else
    {
        plane.z_m += z_reference_m;
        set_plane(cell, params, &plane);
    }
}

/* Does a block lie wholly on the surface? All in heightmap cells, along one axis. */
static bool is_covered(int32_t block, int32_t surface_origin)
{
    const int32_t first = block * NAV_BLOCK;

    return (first >= surface_origin) &&
           ((first + NAV_BLOCK) <= (surface_origin + NAV_SURFACE_SIZE));
}

static void judge_row(nav_costmap_t *map,
                      nav_costmap_state_t *state,
                      const nav_params_t *params,
                      const nav_window_t *window,
                      int32_t row)
{
    const int32_t map_row = (window->first_row + row) - map->origin_row;

    if ((map_row >= 0) && (map_row < NAV_SIZE) &&
        is_covered(window->first_row + row, window->surface->origin_row))
    {
        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            const int32_t map_col = (window->first_col + col) - map->origin_col;

            if ((map_col >= 0) && (map_col < NAV_SIZE) &&
                is_covered(window->first_col + col, window->surface->origin_col) &&
                is_patch_new(window, state, row, col))
            {
                const nav_moments_t patch = sum_patch(window, state, row, col);
                const int32_t index = (map_row * NAV_SIZE) + map_col;

                judge_patch(&map->cells[index], params, window, state->z_reference_m, &patch);
                state->fitted_at[index] = window->changes->surface_count;
            }
        }
    }
}

/* Cells that came when the map was recentred, and sums with another reference, are not kept. */
static bool is_state_usable(const nav_costmap_state_t *state,
                            const nav_costmap_t *map,
                            double z_reference_m)
{
    return (state->origin_row == map->origin_row) && (state->origin_col == map->origin_col) &&
           (fabs(state->z_reference_m - z_reference_m) < NAV_REFERENCE_STEP_M);
}

static void open_cell(nav_cost_cell_t *cell)
{
    cell->ace_failed_headings = 0U;
    cell->ace_reason = (uint8_t) NAV_REASON_NONE;
}

static nav_cost_cell_t unknown_cell(const nav_params_t *params)
{
    nav_cost_cell_t cell = {0};

    forget_ground(&cell, params);
    return cell;
}

/* Moves the content of the map in place, in the order that overwrites nothing before its use. */
static void shift_cells(nav_costmap_t *map, const nav_params_t *params, int64_t rows, int64_t cols)
{
    const nav_cost_cell_t empty = unknown_cell(params);
    const bool is_forward = ((rows * (int64_t) NAV_SIZE) + cols) > 0;

    for (int32_t step = 0; step < NAV_CELLS; step++)
    {
        const int32_t index = is_forward ? step : ((NAV_CELLS - 1) - step);
        const int64_t row = ((int64_t) index / NAV_SIZE) + rows;
        const int64_t col = ((int64_t) index % NAV_SIZE) + cols;

        if ((row >= 0) && (row < (int64_t) NAV_SIZE) && (col >= 0) && (col < (int64_t) NAV_SIZE))
        {
            map->cells[index] = map->cells[(row * (int64_t) NAV_SIZE) + col];
        }
        else
        {
            map->cells[index] = empty;
        }
    }
}

static bool is_near_edge(const nav_costmap_t *map,
                         double margin_m,
                         double x_site_m,
                         double y_site_m)
{
    const double south_m = x_site_m - ((double) map->origin_row * map->cell_m);
    const double west_m = y_site_m - ((double) map->origin_col * map->cell_m);
    const double side_m = (double) NAV_SIZE * map->cell_m;
    const double edge_x_m = nav_min(south_m, side_m - south_m);
    const double edge_y_m = nav_min(west_m, side_m - west_m);

    return (map->is_placed == 0U) || (nav_min(edge_x_m, edge_y_m) < margin_m);
}

/* @return false when the position has no global index */
static bool find_global(
    const nav_costmap_t *map, double x_site_m, double y_site_m, int32_t *row, int32_t *col)
{
    const double cells_per_m = 1.0 / map->cell_m;
    const bool is_row_valid = nav_floor_index(x_site_m * cells_per_m, row);
    const bool is_col_valid = nav_floor_index(y_site_m * cells_per_m, col);

    return is_row_valid && is_col_valid;
}

void nav_costmap_init(nav_costmap_t *map, const nav_params_t *params)
{
    const nav_cost_cell_t empty = unknown_cell(params);

    (void) memset(map, 0, sizeof(*map));
    map->cell_m = params->heightmap_cell_m * (double) NAV_CELLS_PER_COST_CELL;
    for (int32_t cell = 0; cell < NAV_CELLS; cell++)
    {
        map->cells[cell] = empty;
    }
}

bool nav_costmap_recenter(nav_costmap_t *map,
                          const nav_params_t *params,
                          double x_site_m,
                          double y_site_m)
{
    int32_t row = 0;
    int32_t col = 0;
    const bool is_found = find_global(map, x_site_m, y_site_m, &row, &col);
    const bool is_moved =
        is_found && is_near_edge(map, params->costmap_recenter_margin_m, x_site_m, y_site_m);

    if (is_moved)
    {
        const int32_t origin_row = row - (NAV_SIZE / 2);
        const int32_t origin_col = col - (NAV_SIZE / 2);

        if (map->is_placed != 0U)
        {
            shift_cells(map, params, (int64_t) origin_row - (int64_t) map->origin_row,
                        (int64_t) origin_col - (int64_t) map->origin_col);
        }
        map->origin_row = origin_row;
        map->origin_col = origin_col;
        map->is_placed = 1U;
    }
    return is_moved;
}

void nav_costmap_update(nav_costmap_t *map,
                        nav_costmap_state_t *state,
                        const nav_params_t *params,
                        const nav_surface_t *surface,
                        const nav_surface_state_t *changes)
{
    const double z_reference_m = reference_height(surface);
    nav_window_t window = {surface, changes, 0U, 0, 0, 0, 0, 0};

    window.seen_count = is_state_usable(state, map, z_reference_m) ? state->surface_count : 0U;
    window.first_row = floor_quotient(surface->origin_row);
    window.first_col = floor_quotient(surface->origin_col);
    window.table_row = nav_wrap_index(window.first_row, NAV_SIDE);
    window.table_col = nav_wrap_index(window.first_col, NAV_SIDE);
    (void) nav_floor_index(params->costmap_patch_cells / 2.0, &window.patch_half);
    state->z_reference_m = z_reference_m;
    state->surface_count = changes->surface_count;
    state->origin_row = map->origin_row;
    state->origin_col = map->origin_col;
    sum_blocks(&window, state);
    sum_strips(&window, state);
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        judge_row(map, state, params, &window, row);
    }
}

void nav_costmap_mark(nav_costmap_t *map,
                      const nav_params_t *params,
                      const nav_kioz_t *kioz,
                      double zone_margin_m)
{
    map->cycle += 1U;
    for (int32_t row = 0; row < NAV_SIZE; row++)
    {
        const double x_m = ((double) map->origin_row + (double) row + 0.5) * map->cell_m;

        for (int32_t col = 0; col < NAV_SIZE; col++)
        {
            const double y_m = ((double) map->origin_col + (double) col + 0.5) * map->cell_m;
            nav_cost_cell_t *cell = &map->cells[(row * NAV_SIZE) + col];
            const uint32_t age_cycles = map->cycle - cell->ace_cycle;

            if ((double) age_cycles > params->ace_feedback_cycles)
            {
                open_cell(cell);
            }
            cell->is_forbidden = nav_kioz_forbids(kioz, x_m, y_m, zone_margin_m) ? 1U : 0U;
        }
    }
}

bool nav_costmap_find(const nav_costmap_t *map, double x_site_m, double y_site_m, uint32_t *index)
{
    const int64_t size = (int64_t) NAV_SIZE;
    int32_t global_row = 0;
    int32_t global_col = 0;
    const bool is_found = find_global(map, x_site_m, y_site_m, &global_row, &global_col);
    const int64_t row = (int64_t) global_row - (int64_t) map->origin_row;
    const int64_t col = (int64_t) global_col - (int64_t) map->origin_col;
    const bool is_inside = is_found && (row >= 0) && (row < size) && (col >= 0) && (col < size);

    const int64_t found = (row * size) + col;

    *index = is_inside ? (uint32_t) found : 0U;
    return is_inside;
}

nav_reason_t nav_costmap_reason(const nav_cost_cell_t *cell, bool use_terrain, bool use_zones)
{
    nav_reason_t reason = NAV_REASON_NONE;

    if (use_zones && (cell->is_forbidden != 0U))
    {
        reason = NAV_REASON_KIOZ;
    }
    else if (use_terrain && (cell->terrain_reason != (uint8_t) NAV_REASON_NONE))
    {
        reason = (nav_reason_t) cell->terrain_reason;
    }
    else if (use_terrain && ((uint32_t) cell->ace_failed_headings == NAV_ALL_HEADINGS))
    {
        reason = (nav_reason_t) cell->ace_reason;
    }
    else
    {
        reason = NAV_REASON_NONE;
    }
    return reason;
}

uint32_t nav_costmap_heading(double yaw_rad)
{
    const double steps = nav_wrap_angle(yaw_rad) * ((double) NAV_HEADINGS / NAV_PI);
    int32_t heading = 0;

    (void) nav_floor_index(steps + 0.5, &heading);
    return (uint32_t) nav_wrap_index(heading, (int32_t) NAV_HEADINGS);
}

uint32_t nav_costmap_barred(const nav_cost_cell_t *cell)
{
    return (uint32_t) cell->barred_headings | (uint32_t) cell->ace_failed_headings;
}

void nav_costmap_feedback(nav_costmap_t *map, const nav_pose2_t *pose, nav_reason_t reason)
{
    uint32_t index = 0U;

    if (nav_costmap_find(map, pose->x_m, pose->y_m, &index))
    {
        nav_cost_cell_t *cell = &map->cells[index];
        const uint32_t heading = (uint32_t) 1U << nav_costmap_heading(pose->yaw_rad);
        const uint32_t failed = (uint32_t) cell->ace_failed_headings;

        if (reason == NAV_REASON_NONE)
        {
            cell->ace_failed_headings = (uint8_t) (failed & ~heading);
        }
        else
        {
            cell->ace_cycle = map->cycle;
            cell->ace_reason = (uint8_t) reason;
            cell->ace_failed_headings = (uint8_t) (failed | heading);
        }
    }
}

void nav_costmap_clear_feedback(nav_costmap_t *map)
{
    for (int32_t cell = 0; cell < NAV_CELLS; cell++)
    {
        open_cell(&map->cells[cell]);
    }
}
