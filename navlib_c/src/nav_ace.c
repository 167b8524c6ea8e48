/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ace.c
 * @brief Approximate Clearance Evaluation relative to the local ground plane.
 *
 * All in the plane frame of nav_ground.h. The wheels are assumed to be within some places; from these
 * follow the intervals of their heights, and from those the places where the wheels can be. If they lie
 * within the assumed ones, the settled rover is there, and the states that the exact linkage can take
 * with such heights bound it.
 */
#include "nav_ace.h"

#include <math.h>
#include <stddef.h>

#include "nav_belly.h"
#include "nav_ground.h"
#include "nav_math.h"
#include "nav_minmax.h"
#include "nav_places.h"
#include "nav_rough.h"
#include "nav_wheel.h"

/* Attempts to find places of the wheels that are consistent: first around where the nearest cells put
 * them, then each around the heights of the attempt before. */
#define ATTEMPTS 3U
#define GROWTH_MAX_M 0.8 /* places that far around certify nothing */

/* Single heightmap cells are looked at where coarse heights would move a wheel's places on a slope by
 * more than this. */
#define COARSE_SHIFT_M 0.01

/* From a point of the surface to the cells it hangs on, on any heading: a diagonal. */
#define CELLS_AROUND 1.42

/* Attempt by attempt: wheels whose rough heights span more are looked at closely. */
static const double CLOSE_FROM_M[ATTEMPTS] = {NAV_ETA_NONE, 0.2, 0.05};

/* Where rough heights span more than this, wheel drop is looked at first, while the heights of the wheels
 * are within this of the nearest cells. */
#define SUSPECT_M 0.15
#define DROP_HALF_M 0.02

/* Bounds that refuse a pose are tightened this often at most, while clearance and wheel drop are no further
 * from their limits than this the first time, then than what the last time has gained, and than this. */
#define TIGHTENINGS 4U
static const double TIGHTEN_FROM_M[TIGHTENINGS] = {0.05, 0.0, 0.0, 0.0};
#define FIRST_GAIN_M 0.08
#define FIRST_DROP_GAIN_M 0.4
#define LEAST_GAIN_M 0.01
#define LEAST_DROP_GAIN_M 0.05

/* Half of what the height of a wheel is assumed to span at least. Between walls a rover can stand in more
 * than one way; places hold all of those that are near. */
#define LEAST_HALF_M 0.06

/* Heights are assumed to span more than what was found, so that they can hold the next: little at first,
 * for tight bounds, then more, for bounds at all. */
#define WIDENING_FIRST 0.95
#define WIDENING_STEP 0.15

/* The nearest cells say little where they are this far off the plane. */
#define FIRST_HEIGHT_MAX_M 0.28

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

/* ------------------------------------------------------------------ heights of the wheels */

/** The box of a wheel, which leans and turns with the body. */
static nav_footprint_t wheel_footprint(const nav_ace_view_t *view,
                                       const nav_places_t *places,
                                       uint32_t wheel)
{
    const nav_params_t *params = view->params;
    nav_footprint_t footprint = {
        .box = places->wheels[wheel],
        .radius_m = params->wheel_radius_m,
        .hub_m = places->height_m[wheel] + params->wheel_radius_m,
        .pitch_rad = places->pitch_rad,
        .roll_rad = places->roll_rad,
    };
    footprint.box.half_u_m += params->wheel_radius_m + (places->pitch_half_rad * NAV_STAND_MAX_M) +
                              (places->reach.box_turn * 0.5 * params->wheel_width_m);
    footprint.box.half_v_m +=
        (0.5 * params->wheel_width_m) + (places->roll_half_rad * NAV_STAND_MAX_M);
    return footprint;
}

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
                          const nav_places_t *places,
                          uint32_t wheel,
                          nav_interval_t *hub)
{
    nav_footprint_t footprint = wheel_footprint(view, places, wheel);
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
        nav_box_t feet = places->wheels[wheel];
        feet.v_m -= shift_m;
        feet.half_v_m += reach_m;
        *hub = nav_wheel_interval(&view->ground, &feet, &span.above, view->params->wheel_radius_m);
    }
    return is_known;
}

/**
 * Looks at a wheel: roughly where it could be elsewhere than at the last look, closely where its height then spans
 * more than it should. What holds for all places of a look holds for fewer, too.
 * @return false when nothing is known under it
 */
static bool look_at_wheel(const nav_ace_view_t *view,
                          const nav_places_t *places,
                          uint32_t wheel,
                          double close_from_m,
                          nav_ace_look_t *look)
{
    const nav_box_t *box = &places->wheels[wheel];
    bool is_known = true;
    if (!nav_places_cover(&look->places, box))
    {
        look->places = *box;
        look->height = nav_rough_interval(&view->ground, box, places->height_m[wheel],
                                          view->params->wheel_radius_m);
    }
    if ((look->height.high_m - look->height.low_m) > close_from_m)
    {
        look->places = *box;
        is_known = wheel_closely(view, places, wheel, &look->height);
    }
    return is_known;
}

/** Heights of the wheels at places. @return false when nothing is known under one of them */
static bool find_heights(nav_ace_work_t *work, const nav_places_t *places, double close_from_m)
{
    const double lean_rad = fabs(places->roll_rad) + places->roll_half_rad;
    const double lean_m = 0.5 * work->view.params->wheel_radius_m * squared(lean_rad);
    bool is_known = true;
    for (uint32_t wheel = 0U; (wheel < (uint32_t) NAV_WHEELS) && is_known; wheel++)
    {
        nav_ace_look_t *look = &work->looks[wheel];
        is_known = look_at_wheel(&work->view, places, wheel, close_from_m, look);
        /* a wheel that leans with the body stands lower over what it touches */
        work->heights[wheel].low_m = look->height.low_m - lean_m;
        work->heights[wheel].high_m = look->height.high_m;
    }
    return is_known;
}

/** Wheel drop and unknown share over all wheels. */
static void drop_bounds(const nav_ace_view_t *view,
                        const nav_places_t *places,
                        nav_ace_bounds_t *bounds)
{
    bounds->wheel_drop_max_m = 0.0;
    bounds->wheel_unknown = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const nav_footprint_t footprint = wheel_footprint(view, places, wheel);
        const nav_span_t span = wheel_ground(view, &footprint, view->limits.wheel_drop_max_m);
        const double unknown =
            is_any_known(&span) ? ((double) span.unknown_count / (double) span.cell_count) : 1.0;
        bounds->wheel_unknown = nav_max(bounds->wheel_unknown, unknown);
        bounds->wheel_drop_max_m =
            nav_max(bounds->wheel_drop_max_m,
                    (span.above.high_m - span.above.low_m) * view->ground.cos_slope);
    }
}

/* ------------------------------------------------------------------ places of the wheels */

/** The places that follow from heights of the wheels; no larger than what can be looked at. */
static void find_places(const nav_ace_view_t *view,
                        const nav_interval_t heights[NAV_WHEELS],
                        nav_places_t *places)
{
    nav_places_find(&view->ground, view->vehicle, &view->uncertainty, heights, places);
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        nav_box_t *box = &places->wheels[wheel];
        places->is_bounded =
            places->is_bounded && (box->half_u_m < GROWTH_MAX_M) && (box->half_v_m < GROWTH_MAX_M);
        box->half_u_m = nav_min(box->half_u_m, GROWTH_MAX_M);
        box->half_v_m = nav_min(box->half_v_m, GROWTH_MAX_M);
    }
}

/** Heights around where the cells nearest to the wheels put them. */
static void first_heights(const nav_ace_view_t *view,
                          double half_m,
                          nav_interval_t heights[NAV_WHEELS])
{
    const nav_vehicle_t *vehicle = view->vehicle;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const double found_m =
            nav_ground_eta_m(&view->ground, vehicle->hub_x_m[wheel], vehicle->hub_y_m[wheel]);
        const double height_m = (fabs(found_m) < FIRST_HEIGHT_MAX_M) ? found_m : 0.0;
        heights[wheel].low_m = height_m - half_m;
        heights[wheel].high_m = height_m + half_m;
    }
}

/** Heights around those found, no narrower than the least. */
static void widen_heights(double widening, nav_interval_t heights[NAV_WHEELS])
{
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        nav_interval_t *height = &heights[wheel];
        const double middle_m = 0.5 * (height->low_m + height->high_m);
        const double half_m =
            nav_max(0.5 * widening * (height->high_m - height->low_m), LEAST_HALF_M);
        height->low_m = middle_m - half_m;
        height->high_m = middle_m + half_m;
    }
}

/** Largest of what the heights of the wheels span. */
static double widest_m(const nav_interval_t heights[NAV_WHEELS])
{
    double span_m = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        span_m = nav_max(span_m, heights[wheel].high_m - heights[wheel].low_m);
    }
    return span_m;
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

/** The box of the belly, grown by how far it can be from its nominal place in the plane, and from what
 * stands under it. */
static nav_box_t belly_box(const nav_ace_view_t *view, const nav_spanned_t *spanned)
{
    const nav_params_t *params = view->params;
    const double far_m = nav_max(fabs(params->belly_front_x_m), fabs(params->belly_rear_x_m));
    const double roll_half = spanned->half[NAV_LINKAGE_ROLL];
    const double pitch_half = spanned->half[NAV_LINKAGE_PITCH];
    const double lift_half_m = spanned->half[NAV_LINKAGE_HEIGHT];
    const double pitch = spanned->linkage.state[NAV_LINKAGE_PITCH];
    const double roll_far = fabs(spanned->linkage.state[NAV_LINKAGE_ROLL]) + roll_half;
    const double pitch_far = fabs(pitch) + pitch_half;
    /* what is higher than the belly itself is refused wherever it stands */
    const double above_m = params->belly_height_m;
    const nav_reach_t reach =
        nav_places_reach(&view->ground, &view->uncertainty, lift_half_m, pitch, pitch_half);
    nav_box_t box = {
        0.5 * (params->belly_front_x_m + params->belly_rear_x_m),
        0.0,
        (pitch_half * above_m) + (lift_half_m * pitch_far),
        (roll_half * above_m) + (lift_half_m * roll_far) + (pitch_half * roll_far * far_m),
    };
    nav_places_grow(&reach, far_m, params->belly_half_width_m, &box);
    return box;
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
    nav_box_t box = belly_box(view, spanned);
    /* the belly may stand elsewhere in its box */
    const double less_m = (pitch * box.half_u_m) + (roll * box.half_v_m) + spanned->curved_m;
    box.half_u_m += 0.5 * (params->belly_front_x_m - params->belly_rear_x_m);
    box.half_v_m += params->belly_half_width_m;
    const nav_clearance_t clearance = nav_belly_clearance(
        &view->ground, spanned, &box, params->belly_height_m,
        nav_places_turn(&view->ground, spanned->linkage.state[NAV_LINKAGE_PITCH]),
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

/** Does a wheel drop refuse the pose although all heights are assumed to span hardly anything? Then hardly
 * any others would not. */
static bool is_dropping(const nav_ace_view_t *view, nav_ace_bounds_t *bounds)
{
    nav_interval_t heights[NAV_WHEELS];
    nav_places_t places;
    first_heights(view, DROP_HALF_M, heights);
    find_places(view, heights, &places);
    drop_bounds(view, &places, bounds);
    return (bounds->wheel_unknown <= view->params->wheel_unknown_max) &&
           (bounds->wheel_drop_max_m > view->limits.wheel_drop_max_m);
}

/** The states that the linkage can take. @return false when none has such heights */
static bool span_states(const nav_ace_view_t *view,
                        const nav_interval_t heights[NAV_WHEELS],
                        nav_spanned_t *spanned)
{
    return nav_states_flat(view->vehicle, heights, spanned) ||
           nav_states_solve(view->vehicle, heights, spanned);
}

/** All bounds of the states that the linkage can take. */
static void bound_states(const nav_ace_view_t *view,
                         const nav_places_t *places,
                         bool is_certified,
                         nav_spanned_t *spanned,
                         nav_ace_bounds_t *bounds)
{
    nav_sincos(spanned->linkage.state[NAV_LINKAGE_ROLL], &spanned->sin_roll, &spanned->cos_roll);
    nav_sincos(spanned->linkage.state[NAV_LINKAGE_PITCH], &spanned->sin_pitch, &spanned->cos_pitch);
    drop_bounds(view, places, bounds);
    suspension_bounds(spanned, bounds);
    attitude_bounds(view, spanned, bounds);
    belly_bounds(view, spanned, bounds);
    bounds->is_certified = (is_certified && (bounds->belly_unknown < 1.0)) ? 1U : 0U;
    bounds->reason = (uint32_t) nav_ace_refuse(view->params, bounds, view->is_leaving);
}

/** Certified places are where the wheels are: the heights of the ground there are theirs, too, and what
 * follows from these is certified and mostly tighter. */
static void tighten(nav_ace_work_t *work, double close_from_m, nav_ace_bounds_t *bounds)
{
    const nav_ace_view_t *view = &work->view;
    if (find_heights(work, &work->places, close_from_m) &&
        nav_states_solve(view->vehicle, work->heights, &work->spanned))
    {
        find_places(view, work->heights, &work->places);
        bound_states(view, &work->places, true, &work->spanned, bounds);
    }
}

/** What became of the search for places. */
typedef enum
{
    NOT_STANDING, /* nothing known to stand on, or no state */
    DROPPING,     /* a wheel drop that is refused whatever the heights */
    STANDING,     /* states, but no consistent places */
    CERTIFIED
} finding_t;

/** As if no wheel had been looked at: boxes of less than no extent cover none. */
static void forget_looks(nav_ace_work_t *work)
{
    static const nav_box_t NOWHERE = {0.0, 0.0, -1.0, -1.0};
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        work->looks[wheel].places = NOWHERE;
    }
}

/** What an attempt comes to, at the assumed places. */
static finding_t attempt(nav_ace_work_t *work, uint32_t k, nav_ace_bounds_t *bounds)
{
    const nav_ace_view_t *view = &work->view;
    finding_t finding = NOT_STANDING;
    if (find_heights(work, &work->assumed, CLOSE_FROM_M[k]))
    {
        find_places(view, work->heights, &work->places);
        finding = nav_places_hold(&work->assumed, &work->places) ? CERTIFIED : STANDING;
        if ((k == 0U) && (widest_m(work->heights) > SUSPECT_M) && is_dropping(view, bounds))
        {
            finding = DROPPING;
        }
    }
    return finding;
}

/** Looks for consistent places: roughly first, then closely. Leaves the last that were assumed. */
static finding_t find_consistent(nav_ace_work_t *work, nav_ace_bounds_t *bounds)
{
    const nav_ace_view_t *view = &work->view;
    forget_looks(work);
    first_heights(view, LEAST_HALF_M, work->heights);
    find_places(view, work->heights, &work->assumed);
    finding_t finding = attempt(work, 0U, bounds);
    for (uint32_t k = 1U; (k < ATTEMPTS) && (finding == STANDING) && work->places.is_bounded; k++)
    {
        widen_heights(WIDENING_FIRST + (WIDENING_STEP * (double) k), work->heights);
        find_places(view, work->heights, &work->places);
        if (work->places.is_bounded)
        {
            work->assumed = work->places;
            finding = attempt(work, k, bounds);
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
static void tighten_refused(nav_ace_work_t *work, nav_ace_bounds_t *bounds)
{
    gain_t gain = {FIRST_GAIN_M, FIRST_DROP_GAIN_M};
    bool is_worth_it = is_near_limits(&work->view, bounds, &gain);
    for (uint32_t k = 0U; (k < TIGHTENINGS) && is_worth_it; k++)
    {
        const double clearance_m = bounds->clearance_min_m;
        const double drop_m = bounds->wheel_drop_max_m;
        tighten(work, TIGHTEN_FROM_M[k], bounds);
        gain.clearance_m = nav_max(bounds->clearance_min_m - clearance_m, LEAST_GAIN_M);
        gain.drop_m = nav_max(drop_m - bounds->wheel_drop_max_m, LEAST_DROP_GAIN_M);
        is_worth_it = is_near_limits(&work->view, bounds, &gain);
    }
}

/** Bounds at the pose of a view. */
static void bound_pose(nav_ace_work_t *work, nav_ace_bounds_t *bounds)
{
    const nav_ace_view_t *view = &work->view;
    finding_t finding = find_consistent(work, bounds);
    if (((finding == STANDING) || (finding == CERTIFIED)) &&
        !span_states(view, work->heights, &work->spanned))
    {
        finding = NOT_STANDING;
    }
    if (finding == NOT_STANDING)
    {
        /* which wheels and why */
        drop_bounds(view, &work->assumed, bounds);
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
        /* places that are not certified could be anywhere */
        const bool is_certified = finding == CERTIFIED;
        bound_states(view, is_certified ? &work->places : &work->assumed, is_certified,
                     &work->spanned, bounds);
        if (is_certified)
        {
            tighten_refused(work, bounds);
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
