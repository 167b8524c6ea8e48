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

_Static_assert(NAV_BLOCKS_SIDE <= 64, "sets of blocks in a row have a bit for each");

/* The blocks of a surface: row and column 0 are those of its corner. */
typedef struct
{
    const nav_surface_t *surface;
    int32_t first_row; /* global index of the first block, in costmap cells */
    int32_t first_col;
    int32_t table_row; /* where the first row stands in tables */
    int32_t table_col;
    int32_t patch_half; /* blocks to either side of the middle one */
    /* by row of blocks; bit k is the one in column k */
    uint64_t new_blocks[NAV_BLOCKS_SIDE];
    uint64_t new_strips[NAV_BLOCKS_SIDE];
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
    /* the nearest multiple: ground near the SITE origin's height does not change it back and forth */
    return NAV_REFERENCE_STEP_M * floor((z_m / NAV_REFERENCE_STEP_M) + 0.5);
}

static int32_t table_index(const nav_window_t *window, int32_t row, int32_t col)
{
    const int32_t table_row = window->table_row + row;
    const int32_t table_col = window->table_col + col;

    return (((table_row < NAV_SIDE) ? table_row : (table_row - NAV_SIDE)) * NAV_SIDE) +
           ((table_col < NAV_SIDE) ? table_col : (table_col - NAV_SIDE));
}

static bool has(uint64_t set, int32_t place)
{
    return ((set >> (uint32_t) place) & 1U) != 0U;
}

/* Finds the blocks with a greater number than one, and the strips that they are in. */
static void find_new(nav_window_t *window, const nav_surface_state_t *changes, uint32_t seen_count)
{
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        uint64_t blocks = 0U;
        uint64_t strips = 0U;

        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            const uint32_t changed_at = changes->changed_at[table_index(window, row, col)];

            blocks |= ((changed_at > seen_count) ? (uint64_t) 1U : 0U) << (uint32_t) col;
        }
        strips = blocks;
        for (int32_t step = 0; step < window->patch_half; step++)
        {
            strips |= (strips << 1U) | (strips >> 1U);
        }
        window->new_blocks[row] = blocks;
        window->new_strips[row] = strips;
    }
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

/* Adds sums whose middle lies u cells north of the middle of the total. */
static void add_north(nav_moments_t *total, const nav_moments_t *part, double u)
{
    total->count += part->count;
    total->u += part->u + (u * part->count);
    total->v += part->v;
    total->z += part->z;
    total->uu += part->uu + (u * ((2.0 * part->u) + (u * part->count)));
    total->uv += part->uv + (u * part->v);
    total->vv += part->vv;
    total->uz += part->uz + (u * part->z);
    total->vz += part->vz;
    total->zz += part->zz;
}

/* The same v cells east. */
static void add_east(nav_moments_t *total, const nav_moments_t *part, double v)
{
    total->count += part->count;
    total->u += part->u;
    total->v += part->v + (v * part->count);
    total->z += part->z;
    total->uu += part->uu;
    total->uv += part->uv + (v * part->u);
    total->vv += part->vv + (v * ((2.0 * part->v) + (v * part->count)));
    total->uz += part->uz;
    total->vz += part->vz + (v * part->z);
    total->zz += part->zz;
}

/* Place of a row or column of a block from its middle. */
static double from_middle(int32_t place)
{
    return (double) place - (((double) NAV_BLOCK - 1.0) / 2.0);
}

/* Known cells of a block wholly on the surface, given its first height. */
static int32_t count_known(const float *z_site_m)
{
    int32_t known_count = 0;

    for (int32_t row = 0; row < NAV_BLOCK; row++)
    {
        for (int32_t col = 0; col < NAV_BLOCK; col++)
        {
            known_count += is_known(z_site_m[(row * NAV_SURFACE_SIZE) + col]) ? 1 : 0;
        }
    }
    return known_count;
}

/* Of a block wholly on the surface and known, given its first height. */
static nav_moments_t sum_whole(const float *z_site_m, double z_reference_m)
{
    const double count = (double) NAV_BLOCK * (double) NAV_BLOCK;
    const double square_sum = count * (count - 1.0) / 12.0;
    nav_moments_t sum = {0};

    sum.count = count;
    sum.uu = square_sum;
    sum.vv = square_sum;
    for (int32_t row = 0; row < NAV_BLOCK; row++)
    {
        for (int32_t col = 0; col < NAV_BLOCK; col++)
        {
            const double z = (double) z_site_m[(row * NAV_SURFACE_SIZE) + col] - z_reference_m;

            sum.z += z;
            sum.uz += from_middle(row) * z;
            sum.vz += from_middle(col) * z;
            sum.zz += z * z;
        }
    }
    return sum;
}

/* Of the known cells of a patch of a block, given the place of its first cell on the surface. */
static nav_moments_t sum_known(const nav_surface_t *surface,
                               double z_reference_m,
                               int32_t first_row,
                               int32_t first_col)
{
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
                const float z_m = surface->z_site_m[(at_row * NAV_SURFACE_SIZE) + at_col];

                if (is_known(z_m))
                {
                    add_height(&sum, from_middle(row), from_middle(col),
                               (double) z_m - z_reference_m);
                }
            }
        }
    }
    return sum;
}

/* Does a block lie wholly on the surface? All in heightmap cells, along one axis. */
static bool is_covered(int32_t first)
{
    return (first >= 0) && ((first + NAV_BLOCK) <= NAV_SURFACE_SIZE);
}

static nav_moments_t sum_block(const nav_window_t *window,
                               double z_reference_m,
                               int32_t block_row,
                               int32_t block_col)
{
    const nav_surface_t *surface = window->surface;
    const int32_t row = ((window->first_row + block_row) * NAV_BLOCK) - surface->origin_row;
    const int32_t col = ((window->first_col + block_col) * NAV_BLOCK) - surface->origin_col;
    nav_moments_t sum = {0};

    if (is_covered(row) && is_covered(col))
    {
        const float *z_site_m = &surface->z_site_m[(row * NAV_SURFACE_SIZE) + col];
        const int32_t known_count = count_known(z_site_m);

        if (known_count == (NAV_BLOCK * NAV_BLOCK))
        {
            sum = sum_whole(z_site_m, z_reference_m);
        }
        else if (known_count > 0)
        {
            sum = sum_known(surface, z_reference_m, row, col);
        }
        else
        {
            /* nothing to add up */
        }
    }
    else
    {
        sum = sum_known(surface, z_reference_m, row, col);
    }
    return sum;
}

static void sum_blocks(const nav_window_t *window, nav_costmap_state_t *state)
{
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            if (has(window->new_blocks[row], col))
            {
                state->blocks[table_index(window, row, col)] =
                    sum_block(window, state->z_reference_m, row, col);
            }
        }
    }
}

/* Places from low to high that lie within half a patch of a place, and in the window. */
typedef struct
{
    int32_t low;
    int32_t high;
} nav_range_t;

static nav_range_t reach_of(const nav_window_t *window, int32_t place)
{
    const int32_t low = place - window->patch_half;
    const int32_t high = place + window->patch_half;
    const nav_range_t reach = {(low > 0) ? low : 0, (high < NAV_SIDE) ? high : (NAV_SIDE - 1)};

    return reach;
}

/* Strips: for each block, the sum over the blocks beside it that belong to its patch. */
static nav_moments_t sum_strip(const nav_window_t *window,
                               const nav_costmap_state_t *state,
                               int32_t row,
                               int32_t col)
{
    const nav_range_t reach = reach_of(window, col);
    nav_moments_t strip = {0};

    for (int32_t other = reach.low; other <= reach.high; other++)
    {
        add_east(&strip, &state->blocks[table_index(window, row, other)],
                 ((double) other - (double) col) * (double) NAV_BLOCK);
    }
    return strip;
}

static void sum_strips(const nav_window_t *window, nav_costmap_state_t *state)
{
    for (int32_t row = 0; row < NAV_SIDE; row++)
    {
        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            if (has(window->new_strips[row], col))
            {
                state->strips[table_index(window, row, col)] = sum_strip(window, state, row, col);
            }
        }
    }
}

/* In a row of blocks, those in whose patch there is a new block. */
static uint64_t find_new_patches(const nav_window_t *window, int32_t row)
{
    const nav_range_t reach = reach_of(window, row);
    uint64_t patches = 0U;

    for (int32_t other = reach.low; other <= reach.high; other++)
    {
        patches |= window->new_strips[other];
    }
    return patches;
}

static double count_patch(const nav_window_t *window,
                          const nav_costmap_state_t *state,
                          int32_t row,
                          int32_t col)
{
    const nav_range_t reach = reach_of(window, row);
    double known_count = 0.0;

    for (int32_t other = reach.low; other <= reach.high; other++)
    {
        known_count += state->strips[table_index(window, other, col)].count;
    }
    return known_count;
}

static nav_moments_t sum_patch(const nav_window_t *window,
                               const nav_costmap_state_t *state,
                               int32_t row,
                               int32_t col)
{
    const nav_range_t reach = reach_of(window, row);
    nav_moments_t patch = {0};

    for (int32_t other = reach.low; other <= reach.high; other++)
    {
        add_north(&patch, &state->strips[table_index(window, other, col)],
                  ((double) other - (double) row) * (double) NAV_BLOCK);
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

/* Known cells that a patch must have for a plane. */
static double known_min(const nav_window_t *window, const nav_params_t *params)
{
    const double side = ((2.0 * (double) window->patch_half) + 1.0) * (double) NAV_BLOCK;

    return params->costmap_patch_known_min * side * side;
}

static void judge_patch(nav_cost_cell_t *cell,
                        const nav_params_t *params,
                        double cell_m,
                        double z_reference_m,
                        const nav_moments_t *patch)
{
    nav_plane_t plane = {0.0, 0.0, 0.0, 0.0};

    if (!fit_plane(patch, cell_m, &plane))
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

static void judge_row(nav_costmap_t *map,
                      nav_costmap_state_t *state,
                      const nav_params_t *params,
                      const nav_window_t *window,
                      int32_t row)
{
    const nav_surface_t *surface = window->surface;
    const uint64_t new_patches = find_new_patches(window, row);
    const int32_t map_row = (window->first_row + row) - map->origin_row;

    if ((map_row >= 0) && (map_row < NAV_SIZE) &&
        is_covered(((window->first_row + row) * NAV_BLOCK) - surface->origin_row))
    {
        for (int32_t col = 0; col < NAV_SIDE; col++)
        {
            const int32_t map_col = (window->first_col + col) - map->origin_col;

            if (has(new_patches, col) && (map_col >= 0) && (map_col < NAV_SIZE) &&
                is_covered(((window->first_col + col) * NAV_BLOCK) - surface->origin_col))
            {
                const int32_t index = (map_row * NAV_SIZE) + map_col;

                if (count_patch(window, state, row, col) < known_min(window, params))
                {
                    forget_ground(&map->cells[index], params);
                }
                else
                {
                    const nav_moments_t patch = sum_patch(window, state, row, col);

                    judge_patch(&map->cells[index], params, surface->cell_m, state->z_reference_m,
                                &patch);
                }
                state->fitted_at[index] = state->surface_count;
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
    const uint32_t seen_count =
        is_state_usable(state, map, z_reference_m) ? state->surface_count : 0U;
    nav_window_t window = {surface, 0, 0, 0, 0, 0, {0U}, {0U}};

    window.first_row = floor_quotient(surface->origin_row);
    window.first_col = floor_quotient(surface->origin_col);
    window.table_row = nav_wrap_index(window.first_row, NAV_SIDE);
    window.table_col = nav_wrap_index(window.first_col, NAV_SIDE);
    (void) nav_floor_index(params->costmap_patch_cells / 2.0, &window.patch_half);
    find_new(&window, changes, seen_count);
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
    const bool is_any_zone = kioz->zone_count > 0U;

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
            cell->is_forbidden =
                (is_any_zone && nav_kioz_forbids(kioz, x_m, y_m, zone_margin_m)) ? 1U : 0U;
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
