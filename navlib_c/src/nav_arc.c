/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_arc.c
 * @brief Poses and times of constant-curvature arcs.
 */
#include "nav_arc.h"

#include <math.h>

#include "nav_math.h"
#include "nav_minmax.h"

/* An arc shorter than this is a turn in place. */
#define NAV_ARC_LENGTH_MIN_M 1.0e-6

/* Below this half angle, sin(h) / h = 1 - h^2 / 6 to the last bit. */
#define NAV_SMALL_HALF_ANGLE_RAD 1.0e-4

/* Quotients this little above a whole number are taken for it. */
#define NAV_QUOTIENT_SLACK 1.0e-9

#define NAV_CORNER_WHEELS 4U

typedef struct
{
    double x_m;
    double y_m;
} nav_hub_t;

static bool has_length(const nav_arc_t *arc)
{
    return fabs(arc->length_m) >= NAV_ARC_LENGTH_MIN_M;
}

static double distance_of_hub(const nav_hub_t *hub, double curvature_per_m)
{
    const double ahead = hub->x_m * curvature_per_m;
    const double aside = 1.0 - (hub->y_m * curvature_per_m);

    return sqrt((ahead * ahead) + (aside * aside));
}

/* distance of the fastest wheel for each metre of the origin */
static double fastest_wheel_ratio(const nav_params_t *params, double curvature_per_m)
{
    const nav_hub_t hubs[NAV_WHEELS] = {
        {params->front_x_m, -params->front_y_m},  {params->middle_x_m, -params->middle_y_m},
        {params->rear_x_m, -params->rear_y_m},    {params->front_x_m, params->front_y_m},
        {params->middle_x_m, params->middle_y_m}, {params->rear_x_m, params->rear_y_m}};
    double ratio = 0.0;

    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        ratio = nav_max(ratio, distance_of_hub(&hubs[wheel], curvature_per_m));
    }
    return ratio;
}

static double largest_wheel_distance_m(const nav_params_t *params)
{
    const double front_m =
        sqrt((params->front_x_m * params->front_x_m) + (params->front_y_m * params->front_y_m));
    const double middle_m =
        sqrt((params->middle_x_m * params->middle_x_m) + (params->middle_y_m * params->middle_y_m));
    const double rear_m =
        sqrt((params->rear_x_m * params->rear_x_m) + (params->rear_y_m * params->rear_y_m));

    return nav_max(front_m, nav_max(middle_m, rear_m));
}

/* A wheel rolls both ways: it never turns by more than a quarter to either side. */
static double wheel_angle_rad(const nav_hub_t *hub, const nav_steering_t *steering)
{
    double angle_rad = 0.0;

    if (steering->in_place != 0U)
    {
        angle_rad = nav_atan2(hub->x_m, -hub->y_m);
    }
    else
    {
        angle_rad = nav_atan2(hub->x_m * steering->curvature_per_m,
                              1.0 - (hub->y_m * steering->curvature_per_m));
    }
    if (angle_rad > (NAV_PI / 2.0))
    {
        angle_rad -= NAV_PI;
    }
    else if (angle_rad < (-NAV_PI / 2.0))
    {
        angle_rad += NAV_PI;
    }
    else
    {
        /* within a quarter turn */
    }
    return angle_rad;
}

nav_pose2_t nav_arc_pose(const nav_pose2_t *start, const nav_arc_t *arc, double fraction)
{
    const double turned_rad = arc->heading_change_rad * fraction;
    const double half_rad = turned_rad * 0.5;
    const double chord_yaw_rad = start->yaw_rad + half_rad;
    double chord_m = arc->length_m * fraction;
    nav_pose2_t pose = *start;

    if (fabs(half_rad) < NAV_SMALL_HALF_ANGLE_RAD)
    {
        chord_m *= 1.0 - (half_rad * half_rad / 6.0);
    }
    else
    {
        chord_m *= nav_sin(half_rad) / half_rad;
    }
    pose.x_m += chord_m * nav_cos(chord_yaw_rad);
    pose.y_m += chord_m * nav_sin(chord_yaw_rad);
    pose.yaw_rad = nav_wrap_angle(start->yaw_rad + turned_rad);
    return pose;
}

nav_steering_t nav_arc_steering(const nav_arc_t *arc)
{
    nav_steering_t steering = {0.0, 0U, 0U};

    if (has_length(arc))
    {
        steering.curvature_per_m = arc->heading_change_rad / arc->length_m;
    }
    else if (fabs(arc->heading_change_rad) > 0.0)
    {
        steering.in_place = 1U;
    }
    else
    {
        /* nothing to drive: straight wheels */
    }
    return steering;
}

double nav_arc_duration_s(const nav_params_t *params, const nav_arc_t *arc)
{
    double distance_m = 0.0;

    if (has_length(arc))
    {
        const double curvature_per_m = arc->heading_change_rad / arc->length_m;

        distance_m = fabs(arc->length_m) * fastest_wheel_ratio(params, curvature_per_m);
    }
    else
    {
        distance_m = fabs(arc->heading_change_rad) * largest_wheel_distance_m(params);
    }
    return distance_m / params->speed_max_m_per_s;
}

double nav_arc_steering_duration_s(const nav_params_t *params,
                                   const nav_steering_t *from,
                                   const nav_steering_t *to)
{
    const nav_hub_t corners[NAV_CORNER_WHEELS] = {{params->front_x_m, -params->front_y_m},
                                                  {params->rear_x_m, -params->rear_y_m},
                                                  {params->front_x_m, params->front_y_m},
                                                  {params->rear_x_m, params->rear_y_m}};
    double change_rad = 0.0;

    for (uint32_t wheel = 0U; wheel < NAV_CORNER_WHEELS; wheel++)
    {
        const double from_rad = wheel_angle_rad(&corners[wheel], from);
        const double to_rad = wheel_angle_rad(&corners[wheel], to);

        change_rad = nav_max(change_rad, fabs(to_rad - from_rad));
    }
    return change_rad / params->steering_rate_rad_per_s;
}

uint32_t nav_arc_pose_count(const nav_params_t *params, const nav_arc_t *arc)
{
    const double along = fabs(arc->length_m) / params->pose_spacing_m;
    const double around = fabs(arc->heading_change_rad) / params->pose_spacing_rad;
    const double steps = nav_max(along, around) - NAV_QUOTIENT_SLACK;
    int32_t count = 0;

    (void) nav_floor_index(-nav_clamp(steps, 1.0, (double) NAV_ARC_POSES_MAX), &count);
    return (uint32_t) -count;
}
