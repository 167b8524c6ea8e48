/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file contact.h
 * @brief Where a wheel is nearest to the ground.
 */
#ifndef SIM_CONTACT_H
#define SIM_CONTACT_H

#include <stddef.h>

#include "linkage.h"

#define RIM_SAMPLES 25

/** What the wheels stand on: a terrain, or fixed hub heights (SITE z) where there is none. */
typedef struct
{
    const sim_terrain_t *terrain;
    const double *hub_z_m;
    double nodes_per_m;
    float rim_sine[RIM_SAMPLES];
    float rim_cosine[RIM_SAMPLES];
    double rim_h[RIM_SAMPLES];
} support_t;

/** The ground under one place: bilinear in its cell. */
typedef struct
{
    double z_m;
    double slope_north;
    double slope_east;
} ground_t;

/** One wheel's nearest point: the vertical gap under it, and the ground's slopes felt there. */
typedef struct
{
    double gap_m;
    double point_m[3];
    double slope_north;
    double slope_east;
} contact_t;

void support_set(const sim_terrain_t *terrain, const double *hub_z_m, support_t *support);

/** The gap is NaN where the wheel is off the map or over a hole in the terrain. */
void wheel_contact(const support_t *support,
                   const sim_vehicle_t *vehicle,
                   const linkage_t *linkage,
                   int wheel,
                   contact_t *contact);

/**
 * The ground felt now at a point where that wheel touched it in this posture; the gap is NaN where
 * there is none.
 */
void known_contact(const support_t *support,
                   const sim_vehicle_t *vehicle,
                   const linkage_t *linkage,
                   int wheel,
                   const double *point_m,
                   contact_t *contact);

/** Whether a place is on the map, that far from its edge; NaN is outside. */
static inline int is_inside(const support_t *support,
                            double north_m,
                            double east_m,
                            double margin_m)
{
    const sim_terrain_t *terrain = support->terrain;
    const double row = (north_m - terrain->north_min_m) * support->nodes_per_m;
    const double col = (east_m - terrain->east_min_m) * support->nodes_per_m;
    const double margin = margin_m * support->nodes_per_m;
    /* short of the last node, so that a cell always follows */
    return (row - margin >= 0.0) && (row + margin < (double) (terrain->rows - 1)) &&
           (col - margin >= 0.0) && (col + margin < (double) (terrain->cols - 1));
}

/** The caller guarantees is_inside(). */
static inline void sample_ground(const support_t *support,
                                 double north_m,
                                 double east_m,
                                 ground_t *ground)
{
    const sim_terrain_t *terrain = support->terrain;
    const double scale = support->nodes_per_m;
    const double u = (north_m - terrain->north_min_m) * scale;
    const double v = (east_m - terrain->east_min_m) * scale;
    const int32_t row = (int32_t) u;
    const int32_t col = (int32_t) v;
    const float *south = &terrain->z_site_m[((ptrdiff_t) row * terrain->cols) + col];
    const float *north = south + terrain->cols;
    const double fu = u - (double) row;
    const double fv = v - (double) col;
    const double z00 = (double) south[0];
    const double d_east = (double) south[1] - z00;
    const double d_north = (double) north[0] - z00;
    const double twist = ((double) north[1] - (double) north[0]) - d_east;
    ground->slope_north = (d_north + (twist * fv)) * scale;
    ground->slope_east = (d_east + (twist * fu)) * scale;
    ground->z_m = z00 + (d_east * fv) + (fu * (d_north + (twist * fv)));
}

#endif
