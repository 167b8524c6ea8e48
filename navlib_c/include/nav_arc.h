/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_arc.h
 * @brief Constant-curvature arcs and turns in place: poses, driving time, steering time.
 *
 * Steering while driving is not possible: a path is a chain of arcs with steering stops between.
 */
#ifndef NAV_ARC_H
#define NAV_ARC_H

#include "nav_params.h"

/** Position and heading on the ground, SITE. */
typedef struct
{
    double x_m;
    double y_m;
    double yaw_rad;
} nav_pose2_t;

/** How the wheels are turned: for a turn in place, or for driving with a curvature. */
#define NAV_STEERING_FIELDS(S, A, N, M)                                                            \
    S(double, curvature_per_m, "1/m", "heading change per metre, positive clockwise; 0 in place")  \
    S(uint32_t, in_place, "1", "1 when steered for a turn in place")                               \
    S(uint32_t, pad_0, "1", "zero")
NAV_RECORD(NAV_STEERING_FIELDS, nav_steering_t);

/** The pose after the given fraction of an arc, 0 to 1. */
nav_pose2_t nav_arc_pose(const nav_pose2_t *start, const nav_arc_t *arc, double fraction);

/** The steering an arc needs. An arc without length and without heading change needs straight wheels. */
nav_steering_t nav_arc_steering(const nav_arc_t *arc);

/** Driving time when the fastest wheel runs at speed_max_m_per_s. Steering is not included. */
double nav_arc_duration_s(const nav_params_t *params, const nav_arc_t *arc);

/** Time the four corner wheels need from one steering to another. */
double nav_arc_steering_duration_s(const nav_params_t *params,
                                   const nav_steering_t *from,
                                   const nav_steering_t *to);

/**
 * Number of poses at which an arc is evaluated, spaced by at most pose_spacing_m (pose_spacing_rad
 * in place); the last one is the end of the arc, the start is not counted. 1 to NAV_ARC_POSES_MAX.
 */
uint32_t nav_arc_pose_count(const nav_params_t *params, const nav_arc_t *arc);

#endif
