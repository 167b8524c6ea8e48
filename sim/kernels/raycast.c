/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file raycast.c
 * @brief Rays over a bilinear heightfield, skipping empty space with a pyramid of block maxima.
 */
#include <math.h>
#include <stddef.h>

#include "sim_kernels.h"

/* one pyramid level: block rows and columns, and where it starts */
typedef struct
{
    int32_t rows;
    int32_t cols;
    int32_t shift;
    const float *top_z_m;
} level_t;

/* a ray in node coordinates: row(t) = row0 + t d_row, likewise col; z(t) in metres; t in metres */
typedef struct
{
    double row0;
    double col0;
    double z0;
    double d_row;
    double d_col;
    double d_z;
    double inverse_row;
    double inverse_col;
} ray_t;

/* where the ray is: parameter t, and the cell it is about to cross */
typedef struct
{
    double t;
    int32_t row;
    int32_t col;
} place_t;

static int32_t block_count(int32_t cells, int32_t shift)
{
    return ((cells - 1) >> shift) + 1;
}

int64_t sim_pyramid_size(int32_t rows, int32_t cols, int32_t *level_count)
{
    int64_t size = 0;
    int32_t level = 0;
    int32_t block_rows = rows - 1;
    int32_t block_cols = cols - 1;
    do
    {
        size += (int64_t) block_rows * block_cols;
        level++;
        block_rows = block_count(rows - 1, SIM_PYRAMID_SHIFT * level);
        block_cols = block_count(cols - 1, SIM_PYRAMID_SHIFT * level);
    } while ((level < SIM_PYRAMID_LEVELS_MAX) && ((block_rows > 2) || (block_cols > 2)));
    *level_count = level;
    return size;
}

static float higher(float a, float b)
{
    return (b < a) ? b : a;
}

/* level 0: the highest corner of each cell; NaN compares false, so it never wins */
static void build_cells(const sim_terrain_t *terrain, float *top_z_m)
{
    for (int32_t row = 0; row < terrain->rows - 1; row++)
    {
        const float *south = &terrain->z_site_m[(ptrdiff_t) row * terrain->cols];
        const float *north = south + terrain->cols;
        for (int32_t col = 0; col < terrain->cols - 1; col++)
        {
            float top = (float) INFINITY;
            top = higher(top, south[col]);
            top = higher(top, south[col + 1]);
            top = higher(top, north[col]);
            top = higher(top, north[col + 1]);
            *top_z_m = top;
            top_z_m++;
        }
    }
}

static void build_level(const float *below, int32_t below_rows, int32_t below_cols, float *top_z_m)
{
    const int32_t rows = block_count(below_rows, SIM_PYRAMID_SHIFT);
    const int32_t cols = block_count(below_cols, SIM_PYRAMID_SHIFT);
    for (int32_t i = 0; i < rows * cols; i++)
    {
        top_z_m[i] = (float) INFINITY;
    }
    for (int32_t row = 0; row < below_rows; row++)
    {
        float *line = &top_z_m[(ptrdiff_t) (row >> SIM_PYRAMID_SHIFT) * cols];
        for (int32_t col = 0; col < below_cols; col++)
        {
            const int32_t block = col >> SIM_PYRAMID_SHIFT;
            line[block] = higher(line[block], below[((ptrdiff_t) row * below_cols) + col]);
        }
    }
}

static int32_t set_levels(const sim_terrain_t *terrain, const float *pyramid, level_t *levels)
{
    int32_t count;
    (void) sim_pyramid_size(terrain->rows, terrain->cols, &count);
    for (int32_t i = 0; i < count; i++)
    {
        levels[i].shift = SIM_PYRAMID_SHIFT * i;
        levels[i].rows = block_count(terrain->rows - 1, levels[i].shift);
        levels[i].cols = block_count(terrain->cols - 1, levels[i].shift);
        levels[i].top_z_m = pyramid;
        pyramid += (ptrdiff_t) levels[i].rows * levels[i].cols;
    }
    return count;
}

void sim_pyramid_build(const sim_terrain_t *terrain, float *pyramid)
{
    level_t levels[SIM_PYRAMID_LEVELS_MAX];
    const int32_t count = set_levels(terrain, pyramid, levels);
    build_cells(terrain, pyramid);
    for (int32_t i = 1; i < count; i++)
    {
        const level_t *below = &levels[i - 1];
        build_level(below->top_z_m, below->rows, below->cols,
                    pyramid + (levels[i].top_z_m - pyramid));
    }
}

/* narrows [t_in, t_out] to where start + t * rate lies in [0, limit]; 0 when empty */
static int clip_axis(double start, double rate, double limit, double *t_in, double *t_out)
{
    if (fabs(rate) < 1e-12)
    {
        return (start >= 0.0) && (start <= limit);
    }
    const double t_zero = -start / rate;
    const double t_limit = (limit - start) / rate;
    const double t_first = (t_zero < t_limit) ? t_zero : t_limit;
    const double t_last = (t_zero < t_limit) ? t_limit : t_zero;
    *t_in = (t_first > *t_in) ? t_first : *t_in;
    *t_out = (t_last < *t_out) ? t_last : *t_out;
    return *t_in <= *t_out;
}

/* index of a place that is inside low..high but for rounding; low is never negative */
static int32_t clamp_cell(double value, int32_t low, int32_t high)
{
    const int32_t index = (int32_t) value;
    return (index < low) ? low : ((index > high) ? high : index);
}

/*
 * First point in [t, t_out] where the ray meets the surface of one cell, or NaN. Along a straight
 * line the bilinear height is a quadratic: height above ground f(s) = f0 + b s + a s^2.
 */
static double meet_cell(const sim_terrain_t *terrain,
                        const ray_t *ray,
                        const place_t *place,
                        double t_out)
{
    const float *south = &terrain->z_site_m[((ptrdiff_t) place->row * terrain->cols) + place->col];
    const float *north = south + terrain->cols;
    const double z00 = (double) south[0];
    const double d_col = (double) south[1] - z00;
    const double d_row = (double) north[0] - z00;
    const double twist = ((double) north[1] - (double) north[0]) - d_col;
    const double row = ray->row0 + (place->t * ray->d_row) - (double) place->row;
    const double col = ray->col0 + (place->t * ray->d_col) - (double) place->col;
    const double f0 =
        z00 + (d_col * col) + (row * (d_row + (twist * col))) - (ray->z0 + (place->t * ray->d_z));
    const double a = twist * ray->d_row * ray->d_col;
    const double b = (d_col * ray->d_col) + (d_row * ray->d_row) +
                     (twist * ((row * ray->d_col) + (col * ray->d_row))) - ray->d_z;
    const double span = t_out - place->t;
    if (f0 <= 0.0)
    {
        return place->t;
    }
    const double root_of = (b * b) - (4.0 * a * f0);
    if (!(root_of >= 0.0) || ((b >= 0.0) && (a >= 0.0)))
    {
        return NAN;
    }
    /* smallest positive root, in the form that does not cancel */
    const double root = sqrt(root_of);
    const double s = (b < 0.0) ? (2.0 * f0) / (root - b) : (-b - root) / (2.0 * a);
    return (s <= span + 1e-9) ? place->t + s : (double) NAN;
}

/* parameter at which the ray leaves the block of cells that share all bits above the mask */
static inline double exit_at(double start, double inverse, int32_t cell, int32_t mask)
{
    const int32_t border = (inverse > 0.0) ? (cell | mask) + 1 : (cell & ~mask);
    return ((double) border - start) * inverse;
}

/* moves the place across the border of its block at this level */
static inline void cross_block(
    const ray_t *ray, int32_t mask, double t_row, double t_col, place_t *place)
{
    if (t_row < t_col)
    {
        const int32_t first = place->col & ~mask;
        place->t = (t_row > place->t) ? t_row : place->t;
        place->row = (ray->d_row > 0.0) ? (place->row | mask) + 1 : (place->row & ~mask) - 1;
        place->col = clamp_cell(ray->col0 + (place->t * ray->d_col), first, first + mask);
    }
    else
    {
        const int32_t first = place->row & ~mask;
        place->t = (t_col > place->t) ? t_col : place->t;
        place->col = (ray->d_col > 0.0) ? (place->col | mask) + 1 : (place->col & ~mask) - 1;
        place->row = clamp_cell(ray->row0 + (place->t * ray->d_row), first, first + mask);
    }
}

static int is_on_map(const sim_terrain_t *terrain, const place_t *place)
{
    return (place->row >= 0) && (place->row < terrain->rows - 1) && (place->col >= 0) &&
           (place->col < terrain->cols - 1);
}

static double trace(const sim_terrain_t *terrain,
                    const level_t *levels,
                    int32_t level_count,
                    const ray_t *ray,
                    place_t place,
                    double t_max)
{
    int32_t level = (level_count > 2) ? 2 : level_count - 1;
    while ((place.t <= t_max) && is_on_map(terrain, &place))
    {
        const level_t *here = &levels[level];
        const int32_t mask = (1 << here->shift) - 1;
        const double t_row = exit_at(ray->row0, ray->inverse_row, place.row, mask);
        const double t_col = exit_at(ray->col0, ray->inverse_col, place.col, mask);
        const double t_near = (t_row < t_col) ? t_row : t_col;
        const double t_out = (t_near < t_max) ? t_near : t_max;
        const double t_low = (ray->d_z > 0.0) ? t_out : place.t;
        const ptrdiff_t block =
            ((ptrdiff_t) (place.row >> here->shift) * here->cols) + (place.col >> here->shift);
        if (ray->z0 + (t_low * ray->d_z) >= (double) here->top_z_m[block])
        {
            if (level > 0)
            {
                level--;
                continue;
            }
            const double t_hit = meet_cell(terrain, ray, &place, t_out);
            if (t_hit <= t_max)
            {
                return t_hit;
            }
        }
        const int32_t row = place.row;
        const int32_t col = place.col;
        cross_block(ray, mask, t_row, t_col, &place);
        /* out of the parent block too: look from one level further up */
        const int32_t changed = (place.row ^ row) | (place.col ^ col);
        const int is_new_parent = (changed & ~(((mask + 1) << SIM_PYRAMID_SHIFT) - 1)) != 0;
        level += (is_new_parent && (level < level_count - 1)) ? 1 : 0;
    }
    return NAN;
}

void sim_raycast(const sim_terrain_t *terrain,
                 const float *pyramid,
                 const double *origin_site_m,
                 const double *attitude,
                 const double *directions,
                 int32_t count,
                 double range_max_m,
                 float *range_m)
{
    level_t levels[SIM_PYRAMID_LEVELS_MAX];
    const int32_t level_count = set_levels(terrain, pyramid, levels);
    const double scale = 1.0 / terrain->resolution_m;
    ray_t ray;
    ray.row0 = (origin_site_m[0] - terrain->north_min_m) * scale;
    ray.col0 = (origin_site_m[1] - terrain->east_min_m) * scale;
    ray.z0 = origin_site_m[2];
    for (int32_t i = 0; i < count; i++)
    {
        const double *body = &directions[(ptrdiff_t) 3 * i];
        double direction[3];
        for (int axis = 0; axis < 3; axis++)
        {
            const double *row = &attitude[3 * axis];
            direction[axis] = (row[0] * body[0]) + (row[1] * body[1]) + (row[2] * body[2]);
        }
        double t_in = 0.0;
        double t_out = range_max_m;
        ray.d_row = direction[0] * scale;
        ray.d_col = direction[1] * scale;
        ray.d_z = direction[2];
        /* an axis along which the ray stands still is never crossed */
        ray.inverse_row = (fabs(ray.d_row) < 1e-12) ? 1e300 : 1.0 / ray.d_row;
        ray.inverse_col = (fabs(ray.d_col) < 1e-12) ? 1e300 : 1.0 / ray.d_col;
        double t_hit = NAN;
        if (clip_axis(ray.row0, ray.d_row, (double) (terrain->rows - 1), &t_in, &t_out) &&
            clip_axis(ray.col0, ray.d_col, (double) (terrain->cols - 1), &t_in, &t_out))
        {
            const place_t place = {t_in,
                                   clamp_cell(ray.row0 + (t_in * ray.d_row), 0, terrain->rows - 2),
                                   clamp_cell(ray.col0 + (t_in * ray.d_col), 0, terrain->cols - 2)};
            t_hit = trace(terrain, levels, level_count, &ray, place, t_out);
        }
        range_m[i] = (float) t_hit;
    }
}
