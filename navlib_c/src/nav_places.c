/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_places.c
 * @brief Where the parts of a rover can be while its wheel heights lie within intervals.
 */
#include "nav_places.h"

#include <math.h>

#include "nav_minmax.h"

/* Share of a turn in the plane that its linear formula can be wrong by, slopes up to 30 deg. */
#define TURN_ERROR 0.2

/* Wheel heights are bounded while half of what they span together is no more than this. */
#define HALF_MAX_M 0.35

/* In the middle of the intervals the linkage is settled to this when it is far from flat. */
#define SETTLE_TOLERANCE_M 5.0e-5

/** What is left out of places and attitude as linear functions of the wheel heights, per square of heights,
 * 1/m or 1/m^2. Measured, and enlarged by a quarter. */
typedef struct
{
    double u;
    double v;
    double height;
    double roll;
    double pitch;
} left_out_t;

/* Of the linear functions on flat ground, per square of half of what the heights span together. */
static const left_out_t LEFT_OUT_FLAT = {2.0, 1.2, 0.85, 0.36, 0.58};

/* Of their changes from the middle of the intervals, per half of the widest interval times that and twice
 * half of all. */
static const left_out_t LEFT_OUT = {2.45, 1.46, 0.97, 0.73, 0.78};

/* The linkage is not settled for less than this, of places. */
#define SETTLE_FROM_M 0.05

/** The six intervals. */
typedef struct
{
    double middle_m[NAV_WHEELS];
    double half_m[NAV_WHEELS];
    double half_max_m; /* of the widest */
    double all_half_m; /* half of what they span together */
} heights_t;

/** The rover in the middle of the intervals. */
typedef struct
{
    double state[NAV_LINKAGE_STATES];
    double forward_m[NAV_WHEELS];
    double right_m[NAV_WHEELS];
} middle_t;

static heights_t heights_of(const nav_interval_t intervals[NAV_WHEELS])
{
    heights_t heights = {.half_max_m = 0.0};
    double low_m = NAV_ETA_NONE;
    double high_m = -NAV_ETA_NONE;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        heights.middle_m[wheel] = 0.5 * (intervals[wheel].low_m + intervals[wheel].high_m);
        /* a settled linkage is that near to its heights */
        heights.half_m[wheel] =
            (0.5 * (intervals[wheel].high_m - intervals[wheel].low_m)) + SETTLE_TOLERANCE_M;
        heights.half_max_m = nav_max(heights.half_max_m, heights.half_m[wheel]);
        low_m = nav_min(low_m, intervals[wheel].low_m);
        high_m = nav_max(high_m, intervals[wheel].high_m);
    }
    heights.all_half_m = 0.5 * (high_m - low_m);
    return heights;
}

/** The linear function of the wheel heights, in their middle. */
static double middle_of(const heights_t *heights, const double per_height[NAV_WHEELS])
{
    double sum = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        sum += per_height[wheel] * heights->middle_m[wheel];
    }
    return sum;
}

/** How far it can be from there, over the intervals. */
static double extent_of(const heights_t *heights, const double per_height[NAV_WHEELS])
{
    double sum = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        sum += fabs(per_height[wheel]) * heights->half_m[wheel];
    }
    return sum;
}

/** The middle by linear functions: near flat ground. */
static void place_flat(const nav_vehicle_t *vehicle, const heights_t *heights, middle_t *middle)
{
    nav_vehicle_flat_state(vehicle, heights->middle_m, middle->state);
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        middle->forward_m[wheel] =
            vehicle->hub_x_m[wheel] + middle_of(heights, vehicle->forward_per_height[wheel]);
        middle->right_m[wheel] = vehicle->hub_y_m[wheel];
    }
}

/** The middle by the linkage. @return false when it cannot have such heights */
static bool place_settled(const nav_vehicle_t *vehicle, const heights_t *heights, middle_t *middle)
{
    nav_linkage_t linkage;
    nav_vehicle_flat_state(vehicle, heights->middle_m, linkage.state);
    const bool is_settled =
        nav_vehicle_settle(vehicle, heights->middle_m, SETTLE_TOLERANCE_M, &linkage);
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        middle->state[k] = linkage.state[k];
    }
    nav_vehicle_wheel_places(vehicle, middle->state, middle->forward_m, middle->right_m);
    return is_settled;
}

double nav_places_turn(const nav_ground_t *ground, double pitch_rad)
{
    return pitch_rad * ground->rise_right;
}

nav_reach_t nav_places_reach(const nav_ground_t *ground,
                             const nav_uncertainty_t *uncertainty,
                             double height_half_m,
                             double pitch_rad,
                             double pitch_half_rad)
{
    const double middle_turn = fabs(nav_places_turn(ground, pitch_rad));
    const double half_turn = fabs(nav_places_turn(ground, pitch_half_rad));
    const double turn = uncertainty->yaw_rad + half_turn + (TURN_ERROR * middle_turn);
    const double far_turn = turn + middle_turn;
    const nav_reach_t reach = {
        turn,
        0.5 * far_turn * far_turn,
        uncertainty->position_m + (height_half_m * fabs(ground->rise_forward)),
        uncertainty->position_m + (height_half_m * fabs(ground->rise_right)),
        uncertainty->yaw_rad + middle_turn + half_turn,
    };
    return reach;
}

void nav_places_grow(const nav_reach_t *reach, double u_m, double v_m, nav_box_t *box)
{
    box->half_u_m += reach->u_m + (reach->turn * fabs(v_m)) + (reach->bend * fabs(u_m));
    box->half_v_m += reach->v_m + (reach->turn * fabs(u_m)) + (reach->bend * fabs(v_m));
}

/** The places around the middle. */
static void place_wheels(const nav_ground_t *ground,
                         const nav_vehicle_t *vehicle,
                         const heights_t *heights,
                         const middle_t *middle,
                         const left_out_t *left_out_m,
                         nav_places_t *places)
{
    const double turn = nav_places_turn(ground, places->pitch_rad);
    const double lifted_m = middle->state[NAV_LINKAGE_HEIGHT] / ground->cos_slope;
    /* what a leaning wheel touches above its lowest point is beside it, up to the height of its hub */
    const double hub_m = vehicle->hub_height_m;
    const double lean_min_m = nav_min(places->roll_rad - places->roll_half_rad, 0.0) * hub_m;
    const double lean_max_m = nav_max(places->roll_rad + places->roll_half_rad, 0.0) * hub_m;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const double u_m = middle->forward_m[wheel];
        const double v_m = middle->right_m[wheel];
        nav_box_t *box = &places->wheels[wheel];
        box->u_m = (lifted_m * ground->forward_up) + (u_m - (turn * v_m));
        box->v_m = (lifted_m * ground->right_up) + (v_m + (turn * u_m));
        box->half_u_m = extent_of(heights, vehicle->forward_per_height[wheel]) + left_out_m->u;
        /* the ends of the disc swing sideways as the rover turns */
        box->half_v_m = left_out_m->v + (places->reach.box_turn * hub_m);
        box->v_m += 0.5 * (lean_max_m + lean_min_m);
        box->half_v_m += 0.5 * (lean_max_m - lean_min_m);
        nav_places_grow(&places->reach, u_m, v_m, box);
        places->height_m[wheel] = heights->middle_m[wheel];
    }
}

/** What the linear functions leave out, in all. */
static left_out_t left_out_in(const left_out_t *per_m2, double square_m2)
{
    const left_out_t left_out = {per_m2->u * square_m2, per_m2->v * square_m2,
                                 per_m2->height * square_m2, per_m2->roll * square_m2,
                                 per_m2->pitch * square_m2};
    return left_out;
}

void nav_places_find(const nav_ground_t *ground,
                     const nav_vehicle_t *vehicle,
                     const nav_uncertainty_t *uncertainty,
                     const nav_interval_t heights[NAV_WHEELS],
                     nav_places_t *places)
{
    const double (*inverse)[NAV_WHEELS] = vehicle->flat_inverse;
    const heights_t spans = heights_of(heights);
    const left_out_t settled =
        left_out_in(&LEFT_OUT, spans.half_max_m * (spans.half_max_m + (2.0 * spans.all_half_m)));
    left_out_t left_out = left_out_in(&LEFT_OUT_FLAT, spans.all_half_m * spans.all_half_m);
    middle_t middle;

    places->is_bounded = spans.all_half_m <= HALF_MAX_M;
    if ((left_out.u > SETTLE_FROM_M) && (left_out.u > settled.u))
    {
        places->is_bounded = place_settled(vehicle, &spans, &middle) && places->is_bounded;
        left_out = settled;
    }
    else
    {
        place_flat(vehicle, &spans, &middle);
    }
    places->roll_rad = middle.state[NAV_LINKAGE_ROLL];
    places->pitch_rad = middle.state[NAV_LINKAGE_PITCH];
    places->roll_half_rad = extent_of(&spans, inverse[NAV_LINKAGE_ROLL]) + left_out.roll;
    places->pitch_half_rad = extent_of(&spans, inverse[NAV_LINKAGE_PITCH]) + left_out.pitch;
    places->reach = nav_places_reach(
        ground, uncertainty, extent_of(&spans, inverse[NAV_LINKAGE_HEIGHT]) + left_out.height,
        places->pitch_rad, places->pitch_half_rad);
    place_wheels(ground, vehicle, &spans, &middle, &left_out, places);
}

bool nav_places_cover(const nav_box_t *outer, const nav_box_t *inner)
{
    return ((fabs(inner->u_m - outer->u_m) + inner->half_u_m) <= outer->half_u_m) &&
           ((fabs(inner->v_m - outer->v_m) + inner->half_v_m) <= outer->half_v_m);
}

bool nav_places_hold(const nav_places_t *outer, const nav_places_t *inner)
{
    bool is_inside = outer->is_bounded && inner->is_bounded;
    for (uint32_t wheel = 0U; (wheel < (uint32_t) NAV_WHEELS) && is_inside; wheel++)
    {
        is_inside = nav_places_cover(&outer->wheels[wheel], &inner->wheels[wheel]);
    }
    return is_inside;
}
