/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file linkage.c
 * @brief Forward kinematics of the rocker-bogie with its differential.
 */
#include "linkage.h"

#include <math.h>

void place_set(const double *pose, place_t *place)
{
    place->north_m = pose[0];
    place->east_m = pose[1];
    place->yaw_rad = pose[2];
    place->cos_yaw = cos(pose[2]);
    place->sin_yaw = sin(pose[2]);
}

/* turns (x, z) of a link by an angle, positive nose-down */
static void turn_link(
    double sine, double cosine, const double *from, const double *to, double *out_x, double *out_z)
{
    const double x = to[0] - from[0];
    const double z = to[2] - from[2];
    *out_x = (cosine * x) - (sine * z);
    *out_z = (sine * x) + (cosine * z);
}

static void link_side(const sim_vehicle_t *vehicle,
                      int side,
                      double rocker,
                      double bogie,
                      double rocker_sign,
                      linkage_t *linkage)
{
    const double *pivot = vehicle->rocker_pivot_m[side];
    const double *bogie_pivot = vehicle->bogie_pivot_m[side];
    const int front = side * 3;
    const double sine = sin(rocker);
    const double cosine = cos(rocker);
    double x;
    double z;
    turn_link(sine, cosine, pivot, vehicle->hub_m[front], &x, &z);
    linkage->hub_body_m[front][0] = pivot[0] + x;
    linkage->hub_body_m[front][1] = vehicle->hub_m[front][1];
    linkage->hub_body_m[front][2] = pivot[2] + z;
    linkage->d_rocker[front][0] = -z * rocker_sign;
    linkage->d_rocker[front][2] = x * rocker_sign;
    linkage->d_bogie[front][0] = 0.0;
    linkage->d_bogie[front][2] = 0.0;

    double bogie_x;
    double bogie_z;
    turn_link(sine, cosine, pivot, bogie_pivot, &bogie_x, &bogie_z);
    const double bogie_sine = sin(rocker + bogie);
    const double bogie_cosine = cos(rocker + bogie);
    for (int wheel = front + 1; wheel < front + 3; wheel++)
    {
        turn_link(bogie_sine, bogie_cosine, bogie_pivot, vehicle->hub_m[wheel], &x, &z);
        linkage->hub_body_m[wheel][0] = pivot[0] + bogie_x + x;
        linkage->hub_body_m[wheel][1] = vehicle->hub_m[wheel][1];
        linkage->hub_body_m[wheel][2] = pivot[2] + bogie_z + z;
        linkage->d_rocker[wheel][0] = -(bogie_z + z) * rocker_sign;
        linkage->d_rocker[wheel][2] = (bogie_x + x) * rocker_sign;
        linkage->d_bogie[wheel][0] = -z;
        linkage->d_bogie[wheel][2] = x;
    }
}

void linkage_set(const sim_vehicle_t *vehicle,
                 const place_t *place,
                 const double *q,
                 linkage_t *linkage)
{
    const double cr = cos(q[Q_ROLL]);
    const double sr = sin(q[Q_ROLL]);
    const double cp = cos(q[Q_PITCH]);
    const double sp = sin(q[Q_PITCH]);
    const double cy = place->cos_yaw;
    const double sy = place->sin_yaw;
    linkage->origin_m[0] = place->north_m;
    linkage->origin_m[1] = place->east_m;
    linkage->origin_m[2] = q[Q_Z];
    linkage->ex[0] = cy * cp;
    linkage->ex[1] = sy * cp;
    linkage->ex[2] = -sp;
    linkage->ey[0] = (cy * sp * sr) - (sy * cr);
    linkage->ey[1] = (sy * sp * sr) + (cy * cr);
    linkage->ey[2] = cp * sr;
    linkage->ez[0] = (cy * sp * cr) + (sy * sr);
    linkage->ez[1] = (sy * sp * cr) - (cy * sr);
    linkage->ez[2] = cp * cr;
    link_side(vehicle, 0, q[Q_ROCKER], q[Q_BOGIE_LEFT], 1.0, linkage);
    link_side(vehicle, 1, -q[Q_ROCKER], q[Q_BOGIE_RIGHT], -1.0, linkage);
}
