/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file raycast.c
 * @brief Rays from one point over a bilinear heightfield, exact, with a skyline per direction.
 *
 * Seen from above, all rays of an image leave one point. The plane around it is cut into sectors,
 * each sector into bins of distance. For every bin of a sector one number is kept: how steeply a ray
 * must at least descend to touch the highest ground in it. A ray skips all bins that ask for more,
 * and in the others it is intersected with the surface, cell by cell. Sectors are made when their
 * first ray comes; the next rays look for their first bin near that of the ray before.
 */
#include <math.h>
#include <stddef.h>

#include "sim_kernels.h"

/* bins of the first ring, each one cell long; every further ring doubles distance and bin length */
#define RING_BINS 128
#define BINS_MAX (RING_BINS + ((RING_BINS / 2) * (SIM_ROOF_LEVELS_MAX - 1)))
#define SECTORS (5 * RING_BINS)
/* bins marched in one go: beyond the hit all are candidates */
#define RUN_BINS_MAX 4
/* least descents are rounded down by this, far more than a float's rounding */
#define DESCENT_SLACK 1e-4F
/* a ray this close to vertical stays in one cell */
#define VERTICAL_SINE 1e-9
/* cells meet within this distance: no ray slips through between them */
#define EDGE_TOLERANCE 1e-9
/* inverse of a speed that is none: further than any distance */
#define STANDS_STILL 1e12

/* one level of the roof: blocks of 2^level cells, one more all around the map */
typedef struct
{
    int32_t rows;
    int32_t cols;
    const float *top_z_m;
} level_t;

/* a ray over the plane: at distance r it is at (row0 + r d_row, col0 + r d_col) and z0 + r descent */
typedef struct
{
    double row0;
    double col0;
    double z0;
    double d_row;
    double d_col;
    double descent;
    double inverse_row;
    double inverse_col;
} ray_t;

/* what the rays of one image share */
typedef struct
{
    const sim_terrain_t *terrain;
    level_t level[SIM_ROOF_LEVELS_MAX];
    double row0;
    double col0;
    double z0;
    double cells_per_m;
    /* no ray leaves the map */
    int inside;
    int32_t bins;
    double edge_m[BINS_MAX + 1];
    float *table;
} view_t;

/* ------------------------------------------------------------------ the roof */

static int32_t block_count(int32_t cells, int32_t level)
{
    return ((cells - 1) >> level) + 3;
}

int64_t sim_roof_size(int32_t rows, int32_t cols)
{
    int64_t size = 0;
    for (int32_t level = 0; level < SIM_ROOF_LEVELS_MAX; level++)
    {
        size += (int64_t) block_count(rows - 1, level) * block_count(cols - 1, level);
    }
    return size;
}

static void set_levels(const sim_terrain_t *terrain, const float *roof, level_t *level)
{
    for (int32_t i = 0; i < SIM_ROOF_LEVELS_MAX; i++)
    {
        level[i].rows = block_count(terrain->rows - 1, i);
        level[i].cols = block_count(terrain->cols - 1, i);
        level[i].top_z_m = roof;
        roof += (ptrdiff_t) level[i].rows * level[i].cols;
    }
}

static inline float higher(float a, float b)
{
    return (b < a) ? b : a;
}

/* level 0 before widening: the highest corner of each cell; NaN compares false and never wins */
static void build_cells(const sim_terrain_t *terrain, const level_t *level, float *top_z_m)
{
    for (int32_t i = 0; i < level->rows * level->cols; i++)
    {
        top_z_m[i] = (float) INFINITY;
    }
    for (int32_t row = 0; row < terrain->rows - 1; row++)
    {
        const float *south = &terrain->z_site_m[(ptrdiff_t) row * terrain->cols];
        const float *north = south + terrain->cols;
        float *line = &top_z_m[((ptrdiff_t) (row + 1) * level->cols) + 1];
        for (int32_t col = 0; col < terrain->cols - 1; col++)
        {
            float top = (float) INFINITY;
            top = higher(top, south[col]);
            top = higher(top, south[col + 1]);
            top = higher(top, north[col]);
            line[col] = higher(top, north[col + 1]);
        }
    }
}

static void build_level(const level_t *below, const level_t *level, float *top_z_m)
{
    for (int32_t i = 0; i < level->rows * level->cols; i++)
    {
        top_z_m[i] = (float) INFINITY;
    }
    for (int32_t row = 1; row < below->rows - 1; row++)
    {
        const float *from = &below->top_z_m[(ptrdiff_t) row * below->cols];
        float *line = &top_z_m[(ptrdiff_t) (((row - 1) >> 1) + 1) * level->cols];
        for (int32_t col = 1; col < below->cols - 1; col++)
        {
            float *block = &line[((col - 1) >> 1) + 1];
            *block = higher(*block, from[col]);
        }
    }
}

/* every block takes the highest ground of itself and its eight neighbours, in two passes */
static void widen(const level_t *level, float *top_z_m)
{
    const int32_t cols = level->cols;
    for (int32_t row = 0; row < level->rows; row++)
    {
        float *line = &top_z_m[(ptrdiff_t) row * cols];
        float before = (float) INFINITY;
        for (int32_t col = 0; col < cols - 1; col++)
        {
            const float here = line[col];
            line[col] = higher(higher(before, here), line[col + 1]);
            before = here;
        }
        line[cols - 1] = higher(before, line[cols - 1]);
    }
    for (int32_t col = 0; col < cols; col++)
    {
        float before = (float) INFINITY;
        float *line = &top_z_m[col];
        for (int32_t row = 0; row < level->rows - 1; row++)
        {
            const float here = line[0];
            line[0] = higher(higher(before, here), line[cols]);
            before = here;
            line += cols;
        }
        line[0] = higher(before, line[0]);
    }
}

void sim_roof_build(const sim_terrain_t *terrain, float *roof)
{
    level_t level[SIM_ROOF_LEVELS_MAX];
    set_levels(terrain, roof, level);
    build_cells(terrain, &level[0], roof);
    for (int32_t i = 1; i < SIM_ROOF_LEVELS_MAX; i++)
    {
        build_level(&level[i - 1], &level[i], roof + (level[i].top_z_m - roof));
    }
    for (int32_t i = 0; i < SIM_ROOF_LEVELS_MAX; i++)
    {
        widen(&level[i], roof + (level[i].top_z_m - roof));
    }
}

/* ------------------------------------------------------------------ bins and sectors */

/* near edge of a bin in cells; the ring is the bin's level of the roof */
static inline int32_t bin_edge(int32_t bin, int32_t *ring)
{
    if (bin < RING_BINS)
    {
        *ring = 0;
        return bin;
    }
    const int32_t beyond = bin - RING_BINS;
    const int32_t level = (beyond / (RING_BINS / 2)) + 1;
    *ring = level;
    return ((RING_BINS / 2) + (beyond % (RING_BINS / 2))) << level;
}

/* bins that reach as far as a ray can go */
static int32_t bin_count(const sim_terrain_t *terrain, double range_max_m)
{
    const double reach = range_max_m / terrain->resolution_m;
    int32_t bins = 0;
    int32_t ring = 0;
    while ((bins < BINS_MAX) && ((double) bin_edge(bins, &ring) < reach))
    {
        bins++;
    }
    return bins;
}

/*
 * Per sector: 1 + the bin where its last ray began, 0 when it is not made; the least descents of its
 * bins; the least of each bin and all before it.
 */
static ptrdiff_t sector_size(int32_t bins)
{
    return 1 + ((ptrdiff_t) 2 * bins);
}

int64_t sim_raycast_table_size(const sim_terrain_t *terrain, double range_max_m)
{
    return (int64_t) SECTORS * sector_size(bin_count(terrain, range_max_m));
}

/* sectors are equal in the angle of a diamond, which needs no arc tangent: 0 to 4 */
static inline int32_t sector_of(double d_row, double d_col)
{
    const double part = d_col / (fabs(d_row) + fabs(d_col));
    const double turn = (d_row < 0.0) ? 3.0 - part : 1.0 + part;
    const int32_t sector = (int32_t) (turn * (0.25 * SECTORS));
    return (sector < SECTORS) ? sector : SECTORS - 1;
}

static void sector_middle(int32_t sector, double *d_row, double *d_col)
{
    const double turn = (((double) sector + 0.5) / (0.25 * SECTORS)) - 1.0;
    const double part = (turn > 1.0) ? 2.0 - turn : turn;
    const double ahead = (turn > 1.0) ? fabs(part) - 1.0 : 1.0 - fabs(part);
    const double norm = sqrt((part * part) + (ahead * ahead));
    *d_row = ahead / norm;
    *d_col = part / norm;
}

static float highest_near(const level_t *level, int32_t ring, double row, double col)
{
    float top = (float) INFINITY;
    const double block_row = (row / (double) (1 << ring)) + 1.0;
    const double block_col = (col / (double) (1 << ring)) + 1.0;
    if ((block_row >= 0.0) && (block_col >= 0.0) && (block_row < (double) level->rows) &&
        (block_col < (double) level->cols))
    {
        top = level->top_z_m[((ptrdiff_t) block_row * level->cols) + (ptrdiff_t) block_col];
    }
    return top;
}

/* the widened roof at the middle of a bin covers the whole bin, for it is at most one block away */
static void build_sector(const view_t *view, int32_t sector, float *descent)
{
    double d_row;
    double d_col;
    sector_middle(sector, &d_row, &d_col);
    float *least_yet = &descent[view->bins];
    for (int32_t bin = 0; bin < view->bins; bin++)
    {
        int32_t ring;
        const double near = (double) bin_edge(bin, &ring);
        const double far = near + (double) (1 << ring);
        const double middle = 0.5 * (near + far);
        const float top = highest_near(&view->level[ring], ring, view->row0 + (middle * d_row),
                                       view->col0 + (middle * d_col));
        const double depth = (double) top - view->z0;
        /* the least descent that reaches this depth inside the bin; infinite without ground */
        const double cells = (depth >= 0.0) ? far : near;
        const float least = (float) (depth * view->cells_per_m / cells);
        descent[bin] = isinf(least) ? least : least - (DESCENT_SLACK * (1.0F + fabsf(least)));
        least_yet[bin] = (bin == 0) ? descent[bin] : higher(least_yet[bin - 1], descent[bin]);
    }
}

/* what is kept of the sector of a ray */
static inline float *sector_for(const view_t *view, const ray_t *ray)
{
    const int32_t sector = sector_of(ray->d_row, ray->d_col);
    float *table = &view->table[sector * sector_size(view->bins)];
    if (!(table[0] > 0.0F))
    {
        build_sector(view, sector, &table[1]);
        table[0] = 1.0F;
    }
    return table;
}

/* first bin that a ray can touch, or the number of bins; near that of its neighbour, the ray before */
static inline int32_t first_bin(float *table, int32_t bins, float descent)
{
    const float *least_yet = &table[1 + bins];
    int32_t bin = (int32_t) table[0] - 1;
    while ((bin < bins) && (descent < least_yet[bin]))
    {
        bin++;
    }
    while ((bin > 0) && !(descent < least_yet[bin - 1]))
    {
        bin--;
    }
    table[0] = (float) (bin + 1);
    return bin;
}

/* first bin from `bin` on that the ray can touch, or the number of bins */
static inline int32_t next_bin(const float *least, int32_t bins, int32_t bin, float descent)
{
    while ((bin < bins) && (descent < least[bin]))
    {
        bin++;
    }
    return bin;
}

/* ------------------------------------------------------------------ cells */

/*
 * First point in [r, r_out] where the ray meets the surface of one cell, or NaN. Along a straight
 * line the bilinear height is a quadratic: height above ground f(s) = f0 + b s + a s^2.
 */
static inline double meet_cell(
    const float *south, const float *north, const ray_t *ray, double row, double col, double z)
{
    const double z00 = (double) south[0];
    const double d_col = (double) south[1] - z00;
    const double d_row = (double) north[0] - z00;
    const double twist = ((double) north[1] - (double) north[0]) - d_col;
    const double f0 = z00 + (d_col * col) + (row * (d_row + (twist * col))) - z;
    const double a = twist * ray->d_row * ray->d_col;
    const double b = (d_col * ray->d_col) + (d_row * ray->d_row) +
                     (twist * ((row * ray->d_col) + (col * ray->d_row))) - ray->descent;
    const double root_of = (b * b) - (4.0 * a * f0);
    double s = NAN;
    if (f0 <= 0.0)
    {
        s = 0.0;
    }
    else if ((root_of >= 0.0) && ((b < 0.0) || (a < 0.0)))
    {
        /* smallest positive root, in the form that does not cancel */
        const double root = sqrt(root_of);
        s = (b < 0.0) ? (2.0 * f0) / (root - b) : (-b - root) / (2.0 * a);
    }
    return s;
}

/* index of a place that is inside the map but for rounding */
static inline int32_t cell_at(double value, int32_t count)
{
    const int32_t index = (int32_t) value;
    return (index < 0) ? 0 : ((index > count - 2) ? count - 2 : index);
}

/* distance at which a ray crosses a border; along an axis on which it stands still, never */
static inline double crossing(double start, double inverse, int32_t border)
{
    return (inverse < STANDS_STILL) ? ((double) border - start) * inverse : inverse;
}

/* first hit at distances [r, r_end], cell by cell, or NaN; both ends lie on the map */
static double march(const sim_terrain_t *terrain, const ray_t *ray, double r, double r_end)
{
    int32_t row = cell_at(ray->row0 + (r * ray->d_row), terrain->rows);
    int32_t col = cell_at(ray->col0 + (r * ray->d_col), terrain->cols);
    const int32_t step_row = (ray->d_row < 0.0) ? -1 : 1;
    const int32_t step_col = (ray->d_col < 0.0) ? -1 : 1;
    const double width_row = fabs(ray->inverse_row);
    const double width_col = fabs(ray->inverse_col);
    double r_row = crossing(ray->row0, ray->inverse_row, row + (step_row > 0));
    double r_col = crossing(ray->col0, ray->inverse_col, col + (step_col > 0));
    while ((r <= r_end) && (row >= 0) && (row < terrain->rows - 1) && (col >= 0) &&
           (col < terrain->cols - 1))
    {
        const float *south = &terrain->z_site_m[((ptrdiff_t) row * terrain->cols) + col];
        const float *north = south + terrain->cols;
        const double r_out = (r_row < r_col) ? r_row : r_col;
        const double z = ray->z0 + (r * ray->descent);
        const double low = (ray->descent > 0.0) ? ray->z0 + (r_out * ray->descent) : z;
        const float top = higher(higher(south[0], south[1]), higher(north[0], north[1]));
        if (!(low < (double) top))
        {
            const double s =
                meet_cell(south, north, ray, ray->row0 + (r * ray->d_row) - (double) row,
                          ray->col0 + (r * ray->d_col) - (double) col, z);
            if (s <= (r_out - r) + EDGE_TOLERANCE)
            {
                return r + s;
            }
        }
        if (r_row < r_col)
        {
            row += step_row;
            r_row += width_row;
        }
        else
        {
            col += step_col;
            r_col += width_col;
        }
        r = (r_out > r) ? r_out : r;
    }
    return NAN;
}

/* ------------------------------------------------------------------ rays */

/* narrows [r_in, r_out] to where start + r * rate lies in [0, limit]; 0 when empty */
static inline int clip_axis(double start, double inverse, double limit, double *r_in, double *r_out)
{
    if (!(inverse < STANDS_STILL))
    {
        return (start >= 0.0) && (start <= limit);
    }
    const double r_zero = -start * inverse;
    const double r_limit = (limit - start) * inverse;
    const double r_first = (r_zero < r_limit) ? r_zero : r_limit;
    const double r_last = (r_zero < r_limit) ? r_limit : r_zero;
    *r_in = (r_first > *r_in) ? r_first : *r_in;
    *r_out = (r_last < *r_out) ? r_last : *r_out;
    return *r_in <= *r_out;
}

static inline double inverse_of(double rate)
{
    return (fabs(rate) * STANDS_STILL > 1.0) ? 1.0 / rate : STANDS_STILL;
}

/* whether a place is on the map, that many cells from its edge */
static int is_inside(const sim_terrain_t *terrain, double row, double col, double margin)
{
    return (row - margin >= 0.0) && (row + margin <= (double) (terrain->rows - 1)) &&
           (col - margin >= 0.0) && (col + margin <= (double) (terrain->cols - 1));
}

/* horizontal distance of the first hit within r_max, or NaN */
static double trace(const view_t *view, const ray_t *ray, double r_max)
{
    const sim_terrain_t *terrain = view->terrain;
    double r_in = 0.0;
    double r_out = r_max;
    if (!view->inside &&
        (!clip_axis(ray->row0, ray->inverse_row, (double) (terrain->rows - 1), &r_in, &r_out) ||
         !clip_axis(ray->col0, ray->inverse_col, (double) (terrain->cols - 1), &r_in, &r_out)))
    {
        return NAN;
    }
    float *table = sector_for(view, ray);
    const float *least = &table[1];
    const float descent = (float) ray->descent;
    double r_hit = NAN;
    double r_near = r_in;
    int32_t bin = first_bin(table, view->bins, descent);
    while (isnan(r_hit) && (r_near <= r_out) && (bin <= view->bins))
    {
        bin = next_bin(least, view->bins, bin, descent);
        const double r_bin = view->edge_m[bin];
        r_near = (r_bin > r_in) ? r_bin : r_in;
        const int32_t last = bin + RUN_BINS_MAX;
        do
        {
            bin++;
        } while ((bin < view->bins) && (bin < last) && !(descent < least[bin]));
        /* beyond the last bin every cell is looked at */
        const double r_end = (bin <= view->bins) ? view->edge_m[bin] : r_out;
        if (r_near <= r_out)
        {
            r_hit = march(terrain, ray, r_near, (r_end < r_out) ? r_end : r_out);
        }
    }
    return (r_hit <= r_out + EDGE_TOLERANCE) ? r_hit : (double) NAN;
}

/* straight up or down: the ground at the origin */
static double plumb(const view_t *view, double down)
{
    const sim_terrain_t *terrain = view->terrain;
    double range_m = NAN;
    if ((view->row0 >= 0.0) && (view->col0 >= 0.0) &&
        (view->row0 <= (double) (terrain->rows - 1)) &&
        (view->col0 <= (double) (terrain->cols - 1)))
    {
        const int32_t row = cell_at(view->row0, terrain->rows);
        const int32_t col = cell_at(view->col0, terrain->cols);
        const float *south = &terrain->z_site_m[((ptrdiff_t) row * terrain->cols) + col];
        const float *north = south + terrain->cols;
        const double fr = view->row0 - (double) row;
        const double fc = view->col0 - (double) col;
        const double z_south = (double) south[0] + (fc * ((double) south[1] - (double) south[0]));
        const double z_north = (double) north[0] + (fc * ((double) north[1] - (double) north[0]));
        const double depth_m = z_south + (fr * (z_north - z_south)) - view->z0;
        range_m = (depth_m <= 0.0) ? 0.0 : ((down > 0.0) ? depth_m / down : (double) NAN);
    }
    return range_m;
}

static double cast(const view_t *view, const double *direction, double range_max_m)
{
    const double sine = sqrt((direction[0] * direction[0]) + (direction[1] * direction[1]));
    double range_m;
    if (sine > VERTICAL_SINE)
    {
        const double inverse = 1.0 / sine;
        ray_t ray = {.row0 = view->row0, .col0 = view->col0, .z0 = view->z0};
        ray.d_row = direction[0] * inverse * view->cells_per_m;
        ray.d_col = direction[1] * inverse * view->cells_per_m;
        ray.descent = direction[2] * inverse;
        ray.inverse_row = inverse_of(ray.d_row);
        ray.inverse_col = inverse_of(ray.d_col);
        range_m = trace(view, &ray, range_max_m * sine) * inverse;
    }
    else
    {
        range_m = plumb(view, direction[2]);
    }
    return (range_m <= range_max_m) ? range_m : (double) NAN;
}

void sim_raycast(const sim_terrain_t *terrain,
                 const float *roof,
                 const sim_rays_t *rays,
                 float *table,
                 float *range_m)
{
    view_t view;
    view.terrain = terrain;
    set_levels(terrain, roof, view.level);
    view.cells_per_m = 1.0 / terrain->resolution_m;
    view.row0 = (rays->origin_site_m[0] - terrain->north_min_m) * view.cells_per_m;
    view.col0 = (rays->origin_site_m[1] - terrain->east_min_m) * view.cells_per_m;
    view.z0 = rays->origin_site_m[2];
    view.inside =
        is_inside(terrain, view.row0, view.col0, 1.0 + (rays->range_max_m * view.cells_per_m));
    view.bins = bin_count(terrain, rays->range_max_m);
    view.table = table;
    for (int32_t bin = 0; bin <= view.bins; bin++)
    {
        int32_t ring;
        view.edge_m[bin] = (double) bin_edge(bin, &ring) * terrain->resolution_m;
    }
    for (int32_t sector = 0; sector < SECTORS; sector++)
    {
        table[sector * sector_size(view.bins)] = 0.0F;
    }
    for (int32_t i = 0; i < rays->count; i++)
    {
        const double *body = &rays->directions[(ptrdiff_t) 3 * i];
        double direction[3];
        for (int axis = 0; axis < 3; axis++)
        {
            const double *row = rays->attitude[axis];
            direction[axis] = (row[0] * body[0]) + (row[1] * body[1]) + (row[2] * body[2]);
        }
        range_m[i] = (float) cast(&view, direction, rays->range_max_m);
    }
}
