/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file linkage.h
 * @brief Where the rocker-bogie puts body and hubs: forward kinematics and its derivatives.
 */
#ifndef SIM_LINKAGE_H
#define SIM_LINKAGE_H

#include "sim_kernels.h"

/** The unknowns of settling. */
enum
{
    Q_Z,
    Q_ROLL,
    Q_PITCH,
    Q_ROCKER,
    Q_BOGIE_LEFT,
    Q_BOGIE_RIGHT,
    UNKNOWN_COUNT
};

/** Where the rover shall stand. */
typedef struct
{
    double north_m;
    double east_m;
    double yaw_rad;
    double cos_yaw;
    double sin_yaw;
} place_t;

/** One posture: origin and axes of the body in SITE (columns of R), hubs, and how joints move them. */
typedef struct
{
    double origin_m[3];
    double ex[3];
    double ey[3];
    double ez[3];
    double hub_body_m[SIM_WHEEL_COUNT][3];
    double d_rocker[SIM_WHEEL_COUNT][3];
    double d_bogie[SIM_WHEEL_COUNT][3];
} linkage_t;

void place_set(const double *pose, place_t *place);

void linkage_set(const sim_vehicle_t *vehicle,
                 const place_t *place,
                 const double *q,
                 linkage_t *linkage);

static inline double dot(const double *a, const double *b)
{
    return (a[0] * b[0]) + (a[1] * b[1]) + (a[2] * b[2]);
}

static inline void body_to_site(const linkage_t *linkage, const double *body, double *site)
{
    for (int axis = 0; axis < 3; axis++)
    {
        site[axis] = linkage->origin_m[axis] + (linkage->ex[axis] * body[0]) +
                     (linkage->ey[axis] * body[1]) + (linkage->ez[axis] * body[2]);
    }
}

static inline void site_to_body(const linkage_t *linkage, const double *site, double *body)
{
    const double d[3] = {site[0] - linkage->origin_m[0], site[1] - linkage->origin_m[1],
                         site[2] - linkage->origin_m[2]};
    body[0] = dot(linkage->ex, d);
    body[1] = dot(linkage->ey, d);
    body[2] = dot(linkage->ez, d);
}

#endif
