/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ace.h
 * @brief Approximate Clearance Evaluation: bounds on the state of the settled rover at one pose.
 *
 * After Otsu et al., arXiv 1808.00031 (bounds without iteration), with the exact 3-D linkage in place
 * of the published planar one and with everything measured relative to the local ground plane, so that
 * a plain slope is not a hazard. navlib_c/DESIGN.md derives it; the guarantee is: on the terrain of the
 * surface, with its cells as nodes of a bilinear surface, the rover settled anywhere within the stated
 * uncertainty lies inside the bounds, if is_certified.
 */
#ifndef NAV_ACE_H
#define NAV_ACE_H

#include "nav_places.h"
#include "nav_states.h"

#define NAV_ACE_BOUNDS_FIELDS(S, A, N, M)                                                          \
    S(double, clearance_min_m, "m",                                                                \
      "lower bound of belly clearance along the body z axis, exact only near its limit")           \
    S(double, wheel_drop_max_m, "m",                                                               \
      "upper bound of the height span in a wheel's box, from whole costmap cells while these "     \
      "keep the limit")                                                                            \
    S(double, tilt_max_rad, "rad", "upper bound of the tilt against gravity")                      \
    S(double, z_min_site_m, "m", "highest the ROVER origin can be (z is down)")                    \
    S(double, z_max_site_m, "m", "lowest the ROVER origin can be")                                 \
    S(double, roll_min_rad, "rad", "")                                                             \
    S(double, roll_max_rad, "rad", "")                                                             \
    S(double, pitch_min_rad, "rad", "")                                                            \
    S(double, pitch_max_rad, "rad", "")                                                            \
    S(double, rocker_min_rad, "rad", "left rocker")                                                \
    S(double, rocker_max_rad, "rad", "left rocker")                                                \
    S(double, bogie_left_min_rad, "rad", "")                                                       \
    S(double, bogie_left_max_rad, "rad", "")                                                       \
    S(double, bogie_right_min_rad, "rad", "")                                                      \
    S(double, bogie_right_max_rad, "rad", "")                                                      \
    S(double, wheel_unknown, "1", "largest unknown share of a wheel box")                          \
    S(double, belly_unknown, "1", "unknown share of the belly box")                                \
    S(uint32_t, reason, "1", "nav_reason_t: NONE when every bound is within its limit")            \
    S(uint32_t, is_certified, "1",                                                                 \
      "1 when the bounds are consistent with the growth they assume; 0 also where a wheel drop "   \
      "alone refused")
NAV_RECORD(NAV_ACE_BOUNDS_FIELDS, nav_ace_bounds_t);

/** The limits that bounds are held against. */
typedef struct
{
    double clearance_min_m;
    double tilt_max_rad;
    double rocker_max_rad;
    double bogie_max_rad;
    double wheel_drop_max_m;
} nav_ace_limits_t;

/** All that stays the same during one evaluation. */
typedef struct
{
    const nav_params_t *params;
    const nav_vehicle_t *vehicle;
    bool is_leaving;
    nav_ace_limits_t limits;
    nav_uncertainty_t uncertainty;
    nav_ground_t ground;
} nav_ace_view_t;

/** What the ground says of one wheel. */
typedef struct
{
    nav_box_t places; /* where the wheel was taken to be */
    nav_interval_t height;
} nav_ace_look_t;

/** What an evaluation works on, too large for the stack. It means nothing between evaluations. */
typedef struct
{
    nav_ace_view_t view;
    /* by an attempt; when those that follow lie inside, these are certified: the map from places to places
     * then has its fixed point, the settled rover, inside (Brouwer) */
    nav_places_t assumed;
    nav_ace_look_t looks[NAV_WHEELS]; /* the last at each wheel */
    nav_interval_t heights[NAV_WHEELS];
    nav_places_t places; /* that follow from the heights */
    nav_spanned_t spanned;
} nav_ace_work_t;

/** What ACE reads, and what it works on. */
typedef struct
{
    const nav_params_t *params;
    const nav_vehicle_t *vehicle;
    const nav_surface_t *surface;
    const nav_costmap_t *costmap; /* for the planes only */
    const nav_relief_t *relief;
    nav_ace_work_t *work;
} nav_ace_scene_t;

/**
 * Bounds at one pose, and the first limit that they exceed. They are no tighter than the answer needs: of an
 * accepted pose they are within the limits, but wheel drop and clearance may be far better than they say;
 * of a pose refused for a wheel drop the others may be missing, which is_certified 0 tells.
 * @param uncertainty  the rover is within this radius and yaw error of the pose
 * @param is_leaving   true: the leave limits, for a rover that finds no other way on
 */
void nav_ace_evaluate(const nav_ace_scene_t *scene,
                      const nav_pose2_t *pose,
                      const nav_uncertainty_t *uncertainty,
                      bool is_leaving,
                      nav_ace_bounds_t *bounds);

/**
 * The first limit that bounds exceed, NONE when there is none.
 * @param is_leaving  true: the leave limits
 */
nav_reason_t nav_ace_refuse(const nav_params_t *params,
                            const nav_ace_bounds_t *bounds,
                            bool is_leaving);

/** The uncertainty after a distance along a path: grown, but never beyond its bounds. */
nav_uncertainty_t nav_ace_grow(const nav_params_t *params,
                               const nav_uncertainty_t *uncertainty,
                               double distance_m);

#endif
