/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ace.c
 * @brief Approximate Clearance Evaluation relative to the local ground plane.
 *
 * All in the plane frame of nav_ground.h. The rover is assumed to stay within a range of states; from
 * that follow the places of its wheels, from those the intervals of their heights, and from those,
 * through the exact linkage, the states it can take. If these lie within the assumed range, they bound
 * the settled rover.
 */
#include "nav_ace.h"

#include <math.h>
#include <stddef.h>

#include "nav_belly.h"
#include "nav_ground.h"
#include "nav_math.h"
#include "nav_minmax.h"
#include "nav_rough.h"
#include "nav_wheel.h"

/* Attempts to find a range of states that is consistent: first around where the nearest cells put the
 * wheels, then each around the solution of the one before. */
#define ATTEMPTS 6U
#define GROWTH_MIN_M 0.02
#define GROWTH_MAX_M 0.8 /* a range that grows a wheel's places to this certifies nothing */
#define WHEELS_PER_SIDE 3U

/* Share of a turn in the plane that its linear formula can be wrong by, slopes up to 30 deg. */
#define TURN_ERROR 0.2

/* How far a wheel can be above or below the body's ground level, and its change per bogie angle. */
#define WHEEL_TRAVEL_M 0.35
#define WHEEL_SWAY 0.8

/* From a point of the surface to the cells it hangs on, on any heading: a diagonal. */
#define CELLS_AROUND 1.42

/* Single heightmap cells are looked at where coarse heights would move a wheel's places on a slope by
 * more than this. */
#define COARSE_SHIFT_M 0.01

/* Attempt by attempt: wheels whose rough heights span more are looked at closely. */
static const double CLOSE_FROM_M[ATTEMPTS] = {NAV_ETA_NONE, 0.1, 0.05, 0.0, 0.0, 0.0};

/* Where rough heights span more than this, wheel drop is looked at first, within this part of the range. */
#define SUSPECT_M 0.15
#define DROP_PART 0.3

/* Bounds that refuse a pose are tightened this often at most, while clearance and wheel drop are no further
 * from their limits than this the first time, then than what the last time has gained, and than this. */
#define TIGHTENINGS 3U
#define FIRST_GAIN_M 0.1
#define FIRST_DROP_GAIN_M 0.4
#define LEAST_GAIN_M 0.02
#define LEAST_DROP_GAIN_M 0.05

/* Half widths that a range has at least: m, and rad for roll, pitch, rocker, bogies. Between walls a
 * rover can stand in more than one way; a range holds all of those that are near. */
static const double LEAST_HALF[NAV_LINKAGE_STATES] = {0.05, 0.04, 0.05, 0.04, 0.12, 0.12};

/* A new range is wider than the solution it is made from, so that it can hold the next: little at
 * first, for tight bounds, then more, for bounds at all. */
#define WIDENING_FIRST 0.95
#define WIDENING_STEP 0.15

/* The nearest cells say little where they are this far off the plane. */
#define FIRST_HEIGHT_MAX_M 0.3

/** How far a part of the rover can be from its nominal place in the plane. */
typedef struct
{
    double u_m;
    double v_m;
} growth_t;

/** What is the same for all parts: turns and leans of a range. */
typedef struct
{
    double turn; /* half width of the turn in the plane */
    double bend; /* second-order share of turning */
    double u_m;  /* growth of a part at the origin */
    double v_m;
    double box_turn; /* how far a wheel and its box can be turned from the heading */
} common_t;

static double squared(double x)
{
    return x * x;
}

static nav_ace_limits_t limits_of(const nav_params_t *params, bool is_leaving)
{
    const nav_ace_limits_t planned = {params->clearance_min_m, params->tilt_max_rad,
                                      params->rocker_max_rad, params->bogie_max_rad,
                                      params->wheel_drop_max_m};
    /* never stricter than what is planned with */
    const nav_ace_limits_t leaving = {
        nav_min(params->leave_clearance_min_m, params->clearance_min_m),
        nav_max(params->leave_tilt_max_rad, params->tilt_max_rad),
        nav_max(params->leave_rocker_max_rad, params->rocker_max_rad),
        nav_max(params->leave_bogie_max_rad, params->bogie_max_rad),
        nav_max(params->leave_wheel_drop_max_m, params->wheel_drop_max_m),
    };
    return is_leaving ? leaving : planned;
}

/* ------------------------------------------------------------------ places of the wheels */

/** The turn in the plane that keeps a pitched rover's yaw, which is measured in the horizontal. */
static double turn_of_pitch(const nav_ace_view_t *view, double pitch_rad)
{
    return pitch_rad * view->ground.rise_right;
}

/** Growth that all parts share: uncertainty, and what slopes make of the range. */
static common_t common_of(const nav_ace_view_t *view, const double middle[], const double half[])
{
    const double p = view->uncertainty.position_m;
    const double lift_m = half[NAV_LINKAGE_HEIGHT];
    const double middle_turn = fabs(turn_of_pitch(view, middle[NAV_LINKAGE_PITCH]));
    const double half_turn = fabs(turn_of_pitch(view, half[NAV_LINKAGE_PITCH]));
    const double turn = view->uncertainty.yaw_rad + half_turn + (TURN_ERROR * middle_turn);
    const common_t common = {
        turn,
        0.5 * squared(turn + middle_turn),
        p + (lift_m * fabs(view->ground.rise_forward)),
        p + (lift_m * fabs(view->ground.rise_right)),
        view->uncertainty.yaw_rad + middle_turn + half_turn,
    };
    return common;
}

static growth_t growth_of(const common_t *common, double u_m, double v_m)
{
    const growth_t growth = {
        common->u_m + (common->turn * fabs(v_m)) + (common->bend * fabs(u_m)),
        common->v_m + (common->turn * fabs(u_m)) + (common->bend * fabs(v_m)),
    };
    return growth;
}

/** How far the suspension swings a hub fore and aft of its place in the middle of a range. */
static double wheel_swing_m(const nav_vehicle_t *vehicle,
                            const nav_ace_range_t *range,
                            uint32_t wheel)
{
    const double u_m = vehicle->hub_x_m[wheel];
    const double pivot_m = vehicle->rocker_pivot_x_m;
    const uint32_t bogie = (uint32_t) NAV_LINKAGE_BOGIE_LEFT + (wheel / WHEELS_PER_SIDE);
    const double pitch = range->half[NAV_LINKAGE_PITCH];
    const double middle_pitch = fabs(range->middle[NAV_LINKAGE_PITCH]);
    const double turn_1 = pitch + range->half[NAV_LINKAGE_ROCKER];
    const double turn_2 = turn_1 + range->half[bogie];
    const double at_1 = middle_pitch + fabs(range->middle[NAV_LINKAGE_ROCKER]) + (0.5 * turn_1);
    const double at_2 = at_1 + fabs(range->middle[bogie]) + (0.5 * range->half[bogie]);
    double swing_m = (vehicle->hub_height_m * pitch) +
                     ((vehicle->rocker_pivot_height_m - vehicle->hub_height_m) *
                      range->half[NAV_LINKAGE_ROCKER]) +
                     (fabs(pivot_m) * pitch * (middle_pitch + (0.5 * pitch)));
    if ((wheel % WHEELS_PER_SIDE) == 0U)
    {
        swing_m += fabs(u_m - pivot_m) * turn_1 * at_1;
    }
    else
    {
        swing_m += ((vehicle->bogie_pivot_height_m - vehicle->hub_height_m) * range->half[bogie]) +
                   (fabs(vehicle->bogie_pivot_x_m - pivot_m) * turn_1 * at_1) +
                   (fabs(u_m - vehicle->bogie_pivot_x_m) * turn_2 * at_2);
    }
    return swing_m;
}

static growth_t growth_wheel(const nav_ace_view_t *view,
                             const nav_ace_range_t *range,
                             const common_t *common,
                             uint32_t wheel)
{
    const double v_m = view->vehicle->hub_y_m[wheel];
    const double roll = range->half[NAV_LINKAGE_ROLL];
    const double roll_far = fabs(range->middle[NAV_LINKAGE_ROLL]) + roll;
    growth_t growth = growth_of(common, view->vehicle->hub_x_m[wheel], v_m);
    growth.u_m = nav_clamp(growth.u_m + wheel_swing_m(view->vehicle, range, wheel), GROWTH_MIN_M,
                           GROWTH_MAX_M);
    /* the ends of the disc swing sideways as the rover turns; a wheel above or below the body's ground
     * level leans sideways with roll */
    growth.v_m = nav_min(growth.v_m + (common->box_turn * view->params->wheel_radius_m) +
                             (WHEEL_TRAVEL_M * roll) + (fabs(v_m) * roll * roll_far) +
                             (roll_far * WHEEL_SWAY * range->half[NAV_LINKAGE_BOGIE_LEFT]),
                         GROWTH_MAX_M);
    return growth;
}

/** The middle of a wheel's places, in the plane frame. */
static void wheel_middle(const nav_ace_view_t *view,
                         const nav_ace_range_t *range,
                         uint32_t wheel,
                         nav_box_t *box)
{
    const double turn = turn_of_pitch(view, range->middle[NAV_LINKAGE_PITCH]);
    const double lifted_m = range->middle[NAV_LINKAGE_HEIGHT] / view->ground.cos_slope;
    const double u_m = range->forward_m[wheel];
    const double v_m = range->right_m[wheel];
    box->u_m = (lifted_m * view->ground.forward_up) + (u_m - (turn * v_m));
    box->v_m = (lifted_m * view->ground.right_up) + (v_m + (turn * u_m));
}

static nav_footprint_t wheel_footprint(const nav_ace_view_t *view,
                                       const nav_ace_range_t *range,
                                       const common_t *common,
                                       const growth_t *growth,
                                       uint32_t wheel)
{
    const nav_params_t *params = view->params;
    nav_footprint_t footprint = {
        .radius_m = params->wheel_radius_m,
        .hub_m = range->height_m[wheel] + params->wheel_radius_m,
        .pitch_rad = range->middle[NAV_LINKAGE_PITCH],
        .roll_rad = range->middle[NAV_LINKAGE_ROLL],
    };
    wheel_middle(view, range, wheel, &footprint.box);
    footprint.box.half_u_m = params->wheel_radius_m + growth->u_m +
                             (range->half[NAV_LINKAGE_PITCH] * NAV_STAND_MAX_M) +
                             (common->box_turn * 0.5 * params->wheel_width_m);
    footprint.box.half_v_m = (0.5 * params->wheel_width_m) + growth->v_m +
                             (range->half[NAV_LINKAGE_ROLL] * NAV_STAND_MAX_M);
    return footprint;
}

/* ------------------------------------------------------------------ heights of the wheels */

/** The ground in a wheel's box: coarse where that is enough, cell by cell where it is not. */
static nav_span_t wheel_ground(const nav_ace_view_t *view,
                               const nav_footprint_t *footprint,
                               double coarse_span_max_m)
{
    const nav_box_t feet = nav_wheel_feet(&view->ground, footprint);
    nav_span_t span = {{0.0, 0.0}, 1U, 0U};
    if (!nav_ground_range(&view->ground, &feet, &span.above) ||
        ((span.above.high_m - span.above.low_m) > coarse_span_max_m))
    {
        span = nav_wheel_span(&view->ground, footprint);
    }
    return span;
}

static bool is_any_known(const nav_span_t *span)
{
    return span->above.high_m >= span->above.low_m;
}

/** Heights of one wheel by its disc. @return false when nothing is known under it */
static bool wheel_closely(const nav_ace_view_t *view,
                          const nav_ace_range_t *range,
                          const common_t *common,
                          const growth_t *growth,
                          uint32_t wheel,
                          nav_interval_t *hub)
{
    nav_footprint_t footprint = wheel_footprint(view, range, common, growth, wheel);
    const double right_up = view->ground.right_up;
    const double around_m = CELLS_AROUND * view->ground.surface->cell_m;
    /* on a slope the heights around move the feet of what a wheel stands on */
    const double coarse_span_max_m =
        (2.0 * COARSE_SHIFT_M) / nav_max(fabs(right_up), COARSE_SHIFT_M);
    /* the surface in the box hangs on the cells around it */
    footprint.box.half_u_m += around_m;
    footprint.box.half_v_m += around_m;
    const nav_span_t span = wheel_ground(view, &footprint, coarse_span_max_m);
    const bool is_known = is_any_known(&span);
    if (is_known)
    {
        const double shift_m = 0.5 * (span.above.high_m + span.above.low_m) * right_up;
        const double reach_m = 0.5 * (span.above.high_m - span.above.low_m) * fabs(right_up);
        const nav_box_t places = {footprint.box.u_m, footprint.box.v_m - shift_m, growth->u_m,
                                  growth->v_m + reach_m};
        *hub =
            nav_wheel_interval(&view->ground, &places, &span.above, view->params->wheel_radius_m);
    }
    return is_known;
}

/** Heights of one wheel: rough where they span little enough. @return false when nothing is known under
 * it */
static bool wheel_hub(const nav_ace_view_t *view,
                      nav_ace_range_t *range,
                      const common_t *common,
                      uint32_t wheel,
                      nav_interval_t *hub)
{
    const growth_t growth = growth_wheel(view, range, common, wheel);
    const double lean = fabs(range->middle[NAV_LINKAGE_ROLL]) + range->half[NAV_LINKAGE_ROLL];
    nav_box_t places = {0.0, 0.0, growth.u_m, growth.v_m};
    bool is_known = true;
    wheel_middle(view, range, wheel, &places);
    *hub = nav_rough_interval(&view->ground, &places, range->height_m[wheel], lean,
                              view->params->wheel_radius_m);
    range->widest_m = nav_max(range->widest_m, hub->high_m - hub->low_m);
    if ((hub->high_m - hub->low_m) > range->close_from_m)
    {
        is_known = wheel_closely(view, range, common, &growth, wheel, hub);
    }
    range->is_bounded =
        range->is_bounded && (growth.u_m < GROWTH_MAX_M) && (growth.v_m < GROWTH_MAX_M);
    return is_known;
}

/** Wheel drop and unknown share over all wheels. */
static void drop_bounds(const nav_ace_view_t *view,
                        const nav_ace_range_t *range,
                        nav_ace_bounds_t *bounds)
{
    const common_t common = common_of(view, range->middle, range->half);
    const double coarse_span_max_m = view->limits.wheel_drop_max_m;
    bounds->wheel_drop_max_m = 0.0;
    bounds->wheel_unknown = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const growth_t growth = growth_wheel(view, range, &common, wheel);
        const nav_footprint_t footprint = wheel_footprint(view, range, &common, &growth, wheel);
        const nav_span_t span = wheel_ground(view, &footprint, coarse_span_max_m);
        const double unknown =
            is_any_known(&span) ? ((double) span.unknown_count / (double) span.cell_count) : 1.0;
        bounds->wheel_unknown = nav_max(bounds->wheel_unknown, unknown);
        bounds->wheel_drop_max_m =
            nav_max(bounds->wheel_drop_max_m,
                    (span.above.high_m - span.above.low_m) * view->ground.cos_slope);
    }
}

/* ------------------------------------------------------------------ states */

/** Does what was found lie inside the range that its growth assumed? */
static bool is_consistent(const nav_spanned_t *spanned, const nav_ace_range_t *range)
{
    bool is_inside = range->is_bounded;
    for (uint32_t k = 0U; (k < (uint32_t) NAV_LINKAGE_STATES) && is_inside; k++)
    {
        is_inside = (fabs(spanned->linkage.state[k] - range->middle[k]) + spanned->half[k]) <=
                    range->half[k];
    }
    return is_inside;
}

/** The first range: around where the cells nearest to the wheels' places put them. */
static void range_first(const nav_ace_view_t *view, nav_ace_range_t *range)
{
    const nav_vehicle_t *vehicle = view->vehicle;
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        range->middle[k] = 0.0;
        range->half[k] = LEAST_HALF[k];
    }
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const double height_m =
            nav_ground_eta_m(&view->ground, vehicle->hub_x_m[wheel], vehicle->hub_y_m[wheel]);
        range->height_m[wheel] = (fabs(height_m) < FIRST_HEIGHT_MAX_M) ? height_m : 0.0;
        for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
        {
            range->middle[k] += vehicle->flat_inverse[k][wheel] * range->height_m[wheel];
        }
    }
    nav_vehicle_wheel_places(vehicle, range->middle, range->forward_m, range->right_m);
}

/** A range around what was found, no narrower than it, nor than the least half widths. */
static void range_around(const nav_ace_view_t *view,
                         const nav_spanned_t *spanned,
                         double widening,
                         const double least_half[NAV_LINKAGE_STATES],
                         nav_ace_range_t *range)
{
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        range->middle[k] = spanned->linkage.state[k];
        range->half[k] = nav_max(widening * spanned->half[k], least_half[k]);
    }
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        range->height_m[wheel] = spanned->wheel_middle_m[wheel];
    }
    nav_vehicle_wheel_places(view->vehicle, range->middle, range->forward_m, range->right_m);
}

/* ------------------------------------------------------------------ bounds */

/** Attitude against gravity from the attitude against the plane. */
static void attitude_bounds(const nav_ace_view_t *view,
                            const nav_spanned_t *spanned,
                            nav_ace_bounds_t *bounds)
{
    const nav_ground_t *plane = &view->ground;
    const double roll = spanned->linkage.state[NAV_LINKAGE_ROLL];
    const double pitch = spanned->linkage.state[NAV_LINKAGE_PITCH];
    const double roll_half = spanned->half[NAV_LINKAGE_ROLL];
    const double pitch_half = spanned->half[NAV_LINKAGE_PITCH];
    const double sr = spanned->sin_roll;
    const double cr = spanned->cos_roll;
    const double sp = spanned->sin_pitch;
    const double cp = spanned->cos_pitch;

    /* heights of the ends of the body's unit axes; right is taken down, as roll is */
    const double up =
        (-cr * sp * plane->forward_up) + (sr * plane->right_up) + (cr * cp * plane->cos_slope);
    const double nose = (cp * plane->forward_up) + (sp * plane->cos_slope);
    const double right_down =
        -((sr * sp * plane->forward_up) + (cr * plane->right_up)) + (sr * cp * plane->cos_slope);
    const double pitch_site = nav_asin(nose);
    const double cos_pitch = nav_max(sqrt(nav_max(1.0 - squared(nose), 0.0)), 0.1);
    const double roll_site = nav_asin(right_down / cos_pitch);

    /* uncertain yaw turns the slope under the rover; pitching on a cross slope does the same */
    const double slope = sqrt(squared(plane->rise_forward) + squared(plane->rise_right));
    const double turn =
        view->uncertainty.yaw_rad + ((fabs(pitch) + pitch_half) * fabs(plane->rise_right));
    const double pitch_reach = pitch_half + (turn * slope);
    const double roll_reach =
        (roll_half + (turn * slope) + (pitch_half * fabs(nose * right_down) / squared(cos_pitch))) /
        cos_pitch;

    /* turning changes the tilt by no more than the lesser of the two tilts it is made of */
    const double leaned = fabs(roll) + roll_half + fabs(pitch) + pitch_half;
    bounds->tilt_max_rad = nav_acos(up) + sqrt(squared(roll_half) + squared(pitch_half)) +
                           (turn * nav_min(slope, leaned));
    bounds->pitch_min_rad = pitch_site - pitch_reach;
    bounds->pitch_max_rad = pitch_site + pitch_reach;
    bounds->roll_min_rad = roll_site - roll_reach;
    bounds->roll_max_rad = roll_site + roll_reach;

    const double z_m =
        plane->z_site_m - (spanned->linkage.state[NAV_LINKAGE_HEIGHT] / plane->cos_slope);
    const double z_reach_m = (spanned->half[NAV_LINKAGE_HEIGHT] / plane->cos_slope) +
                             (slope * view->uncertainty.position_m);
    bounds->z_min_site_m = z_m - z_reach_m;
    bounds->z_max_site_m = z_m + z_reach_m;
}

static void suspension_bounds(const nav_spanned_t *spanned, nav_ace_bounds_t *bounds)
{
    const double *state = spanned->linkage.state;
    const double *half = spanned->half;
    bounds->rocker_min_rad = state[NAV_LINKAGE_ROCKER] - half[NAV_LINKAGE_ROCKER];
    bounds->rocker_max_rad = state[NAV_LINKAGE_ROCKER] + half[NAV_LINKAGE_ROCKER];
    bounds->bogie_left_min_rad = state[NAV_LINKAGE_BOGIE_LEFT] - half[NAV_LINKAGE_BOGIE_LEFT];
    bounds->bogie_left_max_rad = state[NAV_LINKAGE_BOGIE_LEFT] + half[NAV_LINKAGE_BOGIE_LEFT];
    bounds->bogie_right_min_rad = state[NAV_LINKAGE_BOGIE_RIGHT] - half[NAV_LINKAGE_BOGIE_RIGHT];
    bounds->bogie_right_max_rad = state[NAV_LINKAGE_BOGIE_RIGHT] + half[NAV_LINKAGE_BOGIE_RIGHT];
}

/** How far the belly can be from its nominal place in the plane, and from what stands under it. */
static growth_t growth_belly(const nav_ace_view_t *view, const nav_spanned_t *spanned)
{
    const nav_params_t *params = view->params;
    const double far_m = nav_max(fabs(params->belly_front_x_m), fabs(params->belly_rear_x_m));
    const double roll_half = spanned->half[NAV_LINKAGE_ROLL];
    const double pitch_half = spanned->half[NAV_LINKAGE_PITCH];
    const double lift_half_m = spanned->half[NAV_LINKAGE_HEIGHT];
    const double roll_far = fabs(spanned->linkage.state[NAV_LINKAGE_ROLL]) + roll_half;
    const double pitch_far = fabs(spanned->linkage.state[NAV_LINKAGE_PITCH]) + pitch_half;
    /* what is higher than the belly itself is refused wherever it stands */
    const double above_m = params->belly_height_m;
    const common_t common = common_of(view, spanned->linkage.state, spanned->half);
    growth_t growth = growth_of(&common, far_m, params->belly_half_width_m);
    growth.u_m += (pitch_half * above_m) + (lift_half_m * pitch_far);
    growth.v_m +=
        (roll_half * above_m) + (lift_half_m * roll_far) + (pitch_half * roll_far * far_m);
    return growth;
}

/** Lower bound of clearance and unknown share of the belly box. */
static void belly_bounds(const nav_ace_view_t *view,
                         const nav_spanned_t *spanned,
                         nav_ace_bounds_t *bounds)
{
    const nav_params_t *params = view->params;
    const double roll =
        fabs(spanned->linkage.state[NAV_LINKAGE_ROLL]) + spanned->half[NAV_LINKAGE_ROLL];
    const double pitch =
        fabs(spanned->linkage.state[NAV_LINKAGE_PITCH]) + spanned->half[NAV_LINKAGE_PITCH];
    const growth_t growth = growth_belly(view, spanned);
    /* the belly may stand elsewhere in its box */
    const double less_m = (pitch * growth.u_m) + (roll * growth.v_m) + spanned->curved_m;
    const nav_box_t box = {
        0.5 * (params->belly_front_x_m + params->belly_rear_x_m),
        0.0,
        (0.5 * (params->belly_front_x_m - params->belly_rear_x_m)) + growth.u_m,
        params->belly_half_width_m + growth.v_m,
    };
    const nav_clearance_t clearance =
        nav_belly_clearance(&view->ground, spanned, &box, params->belly_height_m,
                            turn_of_pitch(view, spanned->linkage.state[NAV_LINKAGE_PITCH]),
                            view->limits.clearance_min_m + less_m);
    bounds->clearance_min_m = clearance.clearance_min_m - less_m;
    bounds->belly_unknown = clearance.unknown;
}

static bool is_beyond(double low, double high, double limit)
{
    return (low < -limit) || (high > limit);
}

static bool is_bogie_beyond(const nav_ace_bounds_t *bounds, double limit_rad)
{
    return is_beyond(bounds->bogie_left_min_rad, bounds->bogie_left_max_rad, limit_rad) ||
           is_beyond(bounds->bogie_right_min_rad, bounds->bogie_right_max_rad, limit_rad);
}

nav_reason_t nav_ace_refuse(const nav_params_t *params,
                            const nav_ace_bounds_t *bounds,
                            bool is_leaving)
{
    const nav_ace_limits_t limits = limits_of(params, is_leaving);
    nav_reason_t reason = NAV_REASON_NONE;
    if ((bounds->wheel_unknown > params->wheel_unknown_max) ||
        (bounds->belly_unknown > params->belly_unknown_max))
    {
        reason = NAV_REASON_UNKNOWN;
    }
    else if (bounds->wheel_drop_max_m > limits.wheel_drop_max_m)
    {
        reason = NAV_REASON_WHEEL_DROP;
    }
    else if (bounds->clearance_min_m < limits.clearance_min_m)
    {
        reason = NAV_REASON_CLEARANCE;
    }
    else if (bounds->tilt_max_rad > limits.tilt_max_rad)
    {
        reason = NAV_REASON_TILT;
    }
    else if (is_beyond(bounds->rocker_min_rad, bounds->rocker_max_rad, limits.rocker_max_rad))
    {
        reason = NAV_REASON_ROCKER;
    }
    else if (is_bogie_beyond(bounds, limits.bogie_max_rad))
    {
        reason = NAV_REASON_BOGIE;
    }
    else
    {
        /* bounds that are not consistent promise nothing */
        reason = (bounds->is_certified != 0U) ? NAV_REASON_NONE : NAV_REASON_UNEXPECTED;
    }
    return reason;
}

/** Does a wheel drop within a part of the first range refuse the pose? Then hardly any range does not. */
static bool is_dropping(const nav_ace_view_t *view,
                        nav_ace_range_t *range,
                        nav_ace_bounds_t *bounds)
{
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        range->half[k] = DROP_PART * LEAST_HALF[k];
    }
    drop_bounds(view, range, bounds);
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        range->half[k] = LEAST_HALF[k];
    }
    return (bounds->wheel_unknown <= view->params->wheel_unknown_max) &&
           (bounds->wheel_drop_max_m > view->limits.wheel_drop_max_m);
}

/** The states that a range leads to. @return false when a wheel has nothing known to stand on */
static bool span_range(const nav_ace_view_t *view, nav_ace_range_t *range, nav_spanned_t *spanned)
{
    const common_t common = common_of(view, range->middle, range->half);
    nav_interval_t heights[NAV_WHEELS];
    bool is_known = true;
    range->widest_m = 0.0;
    range->is_bounded = true;
    for (uint32_t wheel = 0U; (wheel < (uint32_t) NAV_WHEELS) && is_known; wheel++)
    {
        is_known = wheel_hub(view, range, &common, wheel, &heights[wheel]);
    }
    bool is_spanned = is_known;
    const bool is_flat =
        is_known && (range->close_from_m > 0.0) && nav_states_flat(view->vehicle, heights, spanned);
    if (is_known && !is_flat)
    {
        for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
        {
            spanned->linkage.state[k] = range->middle[k];
        }
        is_spanned = nav_states_solve(view->vehicle, heights, spanned);
    }
    range->is_bounded = range->is_bounded && is_spanned;
    return is_spanned;
}

/** All bounds of the states that a range has led to. */
static void bound_states(const nav_ace_view_t *view,
                         const nav_ace_range_t *range,
                         bool is_certified,
                         nav_spanned_t *spanned,
                         nav_ace_bounds_t *bounds)
{
    nav_sincos(spanned->linkage.state[NAV_LINKAGE_ROLL], &spanned->sin_roll, &spanned->cos_roll);
    nav_sincos(spanned->linkage.state[NAV_LINKAGE_PITCH], &spanned->sin_pitch, &spanned->cos_pitch);
    drop_bounds(view, range, bounds);
    suspension_bounds(spanned, bounds);
    attitude_bounds(view, spanned, bounds);
    belly_bounds(view, spanned, bounds);
    bounds->is_certified = (is_certified && (bounds->belly_unknown < 1.0)) ? 1U : 0U;
    bounds->reason = (uint32_t) nav_ace_refuse(view->params, bounds, view->is_leaving);
}

/** Certified bounds are themselves a range that the rover stays within: what follows from it is
 * certified too, and mostly tighter. */
static void tighten(const nav_ace_view_t *view,
                    nav_ace_range_t *range,
                    nav_spanned_t *spanned,
                    nav_ace_bounds_t *bounds)
{
    static const double NONE[NAV_LINKAGE_STATES] = {0.0};
    range_around(view, spanned, 1.0, NONE, range);
    range->close_from_m = 0.0;
    (void) span_range(view, range, spanned);
    if (range->is_bounded)
    {
        bound_states(view, range, true, spanned, bounds);
    }
}

/** What became of the search for a range. */
typedef enum
{
    NOT_STANDING, /* nothing known to stand on, or no state */
    DROPPING,     /* a wheel drop that is refused whatever the range */
    STANDING,     /* states, but no consistent range */
    CERTIFIED
} finding_t;

/** Looks for a consistent range: roughly first, then closely. */
static finding_t find_range(const nav_ace_view_t *view,
                            nav_ace_range_t *range,
                            nav_spanned_t *spanned,
                            nav_ace_bounds_t *bounds)
{
    finding_t finding = STANDING;
    range_first(view, range);
    range->is_bounded = true;
    for (uint32_t k = 0U; (k < ATTEMPTS) && range->is_bounded && (finding == STANDING); k++)
    {
        if (k > 0U)
        {
            range_around(view, spanned, WIDENING_FIRST + (WIDENING_STEP * (double) k), LEAST_HALF,
                         range);
        }
        range->close_from_m = CLOSE_FROM_M[k];
        if (!span_range(view, range, spanned))
        {
            finding = NOT_STANDING;
        }
        else if (is_consistent(spanned, range))
        {
            finding = CERTIFIED;
        }
        else
        {
            finding = STANDING;
        }
        if ((k == 0U) && (range->widest_m > SUSPECT_M) && is_dropping(view, range, bounds))
        {
            finding = DROPPING;
        }
    }
    return finding;
}

/** What tightening has gained, or could. */
typedef struct
{
    double clearance_m;
    double drop_m;
} gain_t;

/** Do bounds refuse a pose, but could they accept it with a gain? */
static bool is_near_limits(const nav_ace_view_t *view,
                           const nav_ace_bounds_t *bounds,
                           const gain_t *gain)
{
    return (bounds->reason != (uint32_t) NAV_REASON_NONE) &&
           ((bounds->clearance_min_m + gain->clearance_m) >= view->limits.clearance_min_m) &&
           ((bounds->wheel_drop_max_m - gain->drop_m) <= view->limits.wheel_drop_max_m);
}

/** Tightens bounds that refuse a pose, as long as what the last time has gained could be enough. */
static void tighten_refused(const nav_ace_view_t *view,
                            nav_ace_range_t *range,
                            nav_spanned_t *spanned,
                            nav_ace_bounds_t *bounds)
{
    gain_t gain = {FIRST_GAIN_M, FIRST_DROP_GAIN_M};
    bool is_worth_it = is_near_limits(view, bounds, &gain);
    for (uint32_t k = 0U; (k < TIGHTENINGS) && is_worth_it; k++)
    {
        const double clearance_m = bounds->clearance_min_m;
        const double drop_m = bounds->wheel_drop_max_m;
        tighten(view, range, spanned, bounds);
        gain.clearance_m = nav_max(bounds->clearance_min_m - clearance_m, LEAST_GAIN_M);
        gain.drop_m = nav_max(drop_m - bounds->wheel_drop_max_m, LEAST_DROP_GAIN_M);
        is_worth_it = is_near_limits(view, bounds, &gain);
    }
}

/** Bounds at the pose of a view. */
static void bound_pose(nav_ace_work_t *work, nav_ace_bounds_t *bounds)
{
    const nav_ace_view_t *view = &work->view;
    nav_ace_range_t *range = &work->range;
    nav_spanned_t *spanned = &work->spanned;
    const finding_t finding = find_range(view, range, spanned, bounds);
    if (finding == NOT_STANDING)
    {
        /* which wheels and why */
        drop_bounds(view, range, bounds);
        bounds->reason = (bounds->wheel_unknown < 1.0) ? (uint32_t) NAV_REASON_UNEXPECTED
                                                       : (uint32_t) NAV_REASON_UNKNOWN;
    }
    else if (finding == DROPPING)
    {
        bounds->belly_unknown = 0.0;
        bounds->reason = (uint32_t) NAV_REASON_WHEEL_DROP;
    }
    else
    {
        bound_states(view, range, finding == CERTIFIED, spanned, bounds);
        if (finding == CERTIFIED)
        {
            tighten_refused(view, range, spanned, bounds);
        }
    }
}

/** Leaves no pointers behind: the work lies in a context, which may be copied. */
static void forget_scene(nav_ace_view_t *view)
{
    view->params = NULL;
    view->vehicle = NULL;
    view->ground.surface = NULL;
    view->ground.costmap = NULL;
    view->ground.relief = NULL;
}

void nav_ace_evaluate(const nav_ace_scene_t *scene,
                      const nav_pose2_t *pose,
                      const nav_uncertainty_t *uncertainty,
                      bool is_leaving,
                      nav_ace_bounds_t *bounds)
{
    static const nav_ace_bounds_t UNKNOWN = {
        .wheel_unknown = 1.0, .belly_unknown = 1.0, .reason = (uint32_t) NAV_REASON_UNKNOWN};
    nav_ace_view_t *view = &scene->work->view;

    view->params = scene->params;
    view->vehicle = scene->vehicle;
    view->is_leaving = is_leaving;
    view->limits = limits_of(scene->params, is_leaving);
    view->uncertainty = *uncertainty;
    *bounds = UNKNOWN;
    if (nav_ground_place(&view->ground, scene->surface, scene->costmap, scene->relief, pose))
    {
        bound_pose(scene->work, bounds);
    }
    forget_scene(view);
}

nav_uncertainty_t nav_ace_grow(const nav_params_t *params,
                               const nav_uncertainty_t *uncertainty,
                               double distance_m)
{
    nav_uncertainty_t grown = *uncertainty;
    grown.position_m =
        nav_max(uncertainty->position_m,
                nav_min(uncertainty->position_m + (params->uncertainty_growth * distance_m),
                        params->uncertainty_position_max_m));
    grown.yaw_rad = nav_max(
        uncertainty->yaw_rad,
        nav_min(uncertainty->yaw_rad + (params->uncertainty_yaw_growth_rad_per_m * distance_m),
                params->uncertainty_yaw_max_rad));
    return grown;
}
