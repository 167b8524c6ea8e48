/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ace.c
 * @brief Approximate Clearance Evaluation relative to the local ground plane.
 *
 * All in the plane frame of nav_ground.h. Each wheel's height interval is the terrain, dilated by the
 * wheel disc, over all places the wheel can be (its growth). The linkage is solved exactly for the
 * middles of the six intervals; the exact Jacobian there spans the rest.
 */
#include "nav_ace.h"

#include <math.h>

#include "nav_ground.h"
#include "nav_math.h"

/* Attempts to find a range of states that is consistent: first around flat standing, then each around
 * the solution of the one before. */
#define ATTEMPTS 6U
#define SAMPLES_MAX 56U
#define SAMPLE_SPACING_M 0.05
#define GROWTH_MIN_M 0.02
#define GROWTH_MAX_M 0.8
#define ROW_ENDS 2U
#define WHEELS_PER_SIDE 3U

/* Share of a turn in the plane that its linear formula can be wrong by, slopes up to 30 deg. */
#define TURN_ERROR 0.2

/* How far a wheel can be above or below the body's ground level, and its change per bogie angle. */
#define WHEEL_TRAVEL_M 0.35
#define WHEEL_SWAY 0.8

/* Largest distance in height between a wheel's hub and what stands in its box. */
#define WHEEL_LEAN_M 0.6

/* Terrain whose foot is this far times the slope outside a box can still stand in it. */
#define ETA_SCAN_M 1.0

/* Largest second-order error of the linearized linkage per squared half width of the widest wheel
 * interval, over all states within +/-0.35 m of wheel height; measured, and enlarged by a quarter. */
static const double CURVATURE[NAV_LINKAGE_STATES] = {0.21, 0.15, 0.29, 0.33, 3.2, 3.2};
#define CURVATURE_CLEARANCE 0.47

/** The states an attempt assumes the rover stays within. Bounds found from such a range that lie
 * inside it are certified: the map from states to states then has its fixed point, the settled
 * rover, inside (Brouwer). */
typedef struct
{
    double middle[NAV_LINKAGE_STATES];
    double half[NAV_LINKAGE_STATES];
    double forward_m[NAV_WHEELS]; /* places of the wheels in the middle state */
    double right_m[NAV_WHEELS];
    double height_m[NAV_WHEELS];
} range_t;

/* Flat standing: m, and rad for roll, pitch, rocker, bogies. */
static const double FIRST_HALF[NAV_LINKAGE_STATES] = {0.06, 0.05, 0.06, 0.04, 0.12, 0.12};

/* A new range is wider than the solution it is made from, so that it can hold the next: little at
 * first, for tight bounds, then more, for bounds at all. */
#define WIDENING_FIRST 1.1
#define WIDENING_STEP 0.15
static const double SLACK[NAV_LINKAGE_STATES] = {0.002, 0.002, 0.002, 0.002, 0.006, 0.006};

/** All that stays the same during one evaluation. */
typedef struct
{
    const nav_params_t *params;
    const nav_vehicle_t *vehicle;
    nav_uncertainty_t uncertainty;
    nav_ground_t ground;
} view_t;

/** How far a part of the rover can be from its nominal place in the plane. */
typedef struct
{
    double u_m;
    double v_m;
} growth_t;

/** The box of a wheel, and how it leans with the body. */
typedef struct
{
    nav_box_t box;
    growth_t growth;
    double hub_m; /* height of the hub */
    double pitch_rad;
    double roll_rad;
} footprint_t;

/** What the cells in a wheel's box hold. */
typedef struct
{
    double eta_min_m;
    double eta_max_m;
    double hub_high_m; /* highest that a hub can stand on a cell */
    uint32_t cell_count;
    uint32_t unknown_count;
} span_t;

typedef struct
{
    double low_m;
    double high_m;
} interval_t;

/** The linkage over all wheel intervals: middle, half widths, and what spans them. */
typedef struct
{
    double state[NAV_LINKAGE_STATES];
    double half[NAV_LINKAGE_STATES];
    double inverse[NAV_LINKAGE_STATES][NAV_WHEELS];
    double wheel_middle_m[NAV_WHEELS];
    double wheel_half_m[NAV_WHEELS];
    double wheel_half_max_m;
} linkage_t;

/** The belly over the plane frame: clearance at (u, v, eta) is at_0 + per_u u + per_v v - per_eta eta. */
typedef struct
{
    double at_0_m;
    double per_u;
    double per_v;
    double per_eta;
    double spread_0[NAV_WHEELS]; /* change of clearance over half a wheel's interval, affine too */
    double spread_u[NAV_WHEELS];
    double spread_v[NAV_WHEELS];
    double spread_eta; /* loss of clearance per metre of |eta|, over all wheels */
    nav_box_t box;     /* of the belly, grown, along the axes of the body */
    double lift_m;
    double cos_roll;
    double sin_roll;
    double cos_pitch;
    double sin_pitch;
} belly_t;

static double squared(double x)
{
    return x * x;
}

/** Height of the wheel's hub over a point of its rim, along_m fore or aft of the hub. */
static double wheel_reach_m(const view_t *view, double along_m)
{
    return sqrt(nav_max(squared(view->params->wheel_radius_m) - squared(along_m), 0.0));
}

/** The turn in the plane that keeps a pitched rover's yaw, which is measured in the horizontal. */
static double turn_of_pitch(const view_t *view, double pitch_rad)
{
    return pitch_rad * view->ground.rise_right;
}

/** In-plane place, in the plane frame, of what is at (u, v) from the origin of a state's body. */
static nav_ground_point_t from_body(const view_t *view,
                                    const double state[],
                                    double u_m,
                                    double v_m)
{
    const double turn = turn_of_pitch(view, state[NAV_LINKAGE_PITCH]);
    const double above_m = state[NAV_LINKAGE_HEIGHT] / view->ground.cos_slope;
    const nav_ground_point_t point = {
        (above_m * view->ground.forward_up) + (u_m - (turn * v_m)),
        (above_m * view->ground.right_up) + (v_m + (turn * u_m)),
        0.0,
    };
    return point;
}

/** And back. */
static nav_ground_point_t to_body(const view_t *view,
                                  const double state[],
                                  const nav_ground_point_t *point)
{
    const double turn = turn_of_pitch(view, state[NAV_LINKAGE_PITCH]);
    const double above_m = state[NAV_LINKAGE_HEIGHT] / view->ground.cos_slope;
    const double u_m = point->u_m - (above_m * view->ground.forward_up);
    const double v_m = point->v_m - (above_m * view->ground.right_up);
    const nav_ground_point_t seen = {u_m + (turn * v_m), v_m - (turn * u_m), point->eta_m};
    return seen;
}

/** Growth of a part at (u, v) that all parts share: uncertainty, and what slopes make of the range. */
static growth_t growth_common(const view_t *view, const range_t *range, double u_m, double v_m)
{
    const double p = view->uncertainty.position_m;
    const double lift_m = range->half[NAV_LINKAGE_HEIGHT];
    const double middle_turn = turn_of_pitch(view, range->middle[NAV_LINKAGE_PITCH]);
    const double turn = view->uncertainty.yaw_rad +
                        fabs(turn_of_pitch(view, range->half[NAV_LINKAGE_PITCH])) +
                        (TURN_ERROR * fabs(middle_turn));
    const double bend = 0.5 * squared(turn + fabs(middle_turn));
    const growth_t growth = {
        p + (turn * fabs(v_m)) + (bend * fabs(u_m)) + (lift_m * fabs(view->ground.rise_forward)),
        p + (turn * fabs(u_m)) + (bend * fabs(v_m)) + (lift_m * fabs(view->ground.rise_right)),
    };
    return growth;
}

/** How far the suspension swings a hub fore and aft of its place in the middle of a range. */
static double wheel_swing_m(const nav_vehicle_t *vehicle, const range_t *range, uint32_t wheel)
{
    const double u_m = vehicle->hub_x_m[wheel];
    const double pivot_m = vehicle->rocker_pivot_x_m;
    const uint32_t bogie = (uint32_t) NAV_LINKAGE_BOGIE_LEFT + (wheel / WHEELS_PER_SIDE);
    const double pitch = range->half[NAV_LINKAGE_PITCH];
    const double turn_1 = pitch + range->half[NAV_LINKAGE_ROCKER];
    const double turn_2 = turn_1 + range->half[bogie];
    const double at_1 = fabs(range->middle[NAV_LINKAGE_PITCH]) +
                        fabs(range->middle[NAV_LINKAGE_ROCKER]) + (0.5 * turn_1);
    const double at_2 = at_1 + fabs(range->middle[bogie]) + (0.5 * range->half[bogie]);
    double swing_m =
        (vehicle->hub_height_m * pitch) +
        ((vehicle->rocker_pivot_height_m - vehicle->hub_height_m) *
         range->half[NAV_LINKAGE_ROCKER]) +
        (fabs(pivot_m) * pitch * (fabs(range->middle[NAV_LINKAGE_PITCH]) + (0.5 * pitch)));
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

/** How far a wheel and its box, which stand along the heading, can be turned in the plane. */
static double turn_of_box(const view_t *view, const range_t *range)
{
    return view->uncertainty.yaw_rad + fabs(turn_of_pitch(view, range->middle[NAV_LINKAGE_PITCH])) +
           fabs(turn_of_pitch(view, range->half[NAV_LINKAGE_PITCH]));
}

static growth_t growth_wheel(const view_t *view, const range_t *range, uint32_t wheel)
{
    const double u_m = view->vehicle->hub_x_m[wheel];
    const double v_m = view->vehicle->hub_y_m[wheel];
    const double roll = range->half[NAV_LINKAGE_ROLL];
    const double roll_far = fabs(range->middle[NAV_LINKAGE_ROLL]) + roll;
    growth_t growth = growth_common(view, range, u_m, v_m);
    /* the ends of the disc swing sideways as the rover turns */
    growth.v_m += turn_of_box(view, range) * view->params->wheel_radius_m;
    /* a wheel above or below the body's ground level leans sideways with roll */
    growth.u_m = nav_clamp(growth.u_m + wheel_swing_m(view->vehicle, range, wheel), GROWTH_MIN_M,
                           GROWTH_MAX_M);
    growth.v_m = nav_min(growth.v_m + (WHEEL_TRAVEL_M * roll) + (fabs(v_m) * roll * roll_far) +
                             (roll_far * WHEEL_SWAY * range->half[NAV_LINKAGE_BOGIE_LEFT]),
                         GROWTH_MAX_M);
    return growth;
}

/** The box in which the feet of all terrain lie that can stand in a box. */
static nav_box_t scanned(const view_t *view, const nav_box_t *box)
{
    nav_box_t wide = *box;
    wide.half_u_m += ETA_SCAN_M * fabs(view->ground.rise_forward);
    wide.half_v_m += ETA_SCAN_M * fabs(view->ground.rise_right);
    return wide;
}

/** Takes one cell into a wheel's span; raises hub_high_m where the wheel could stand on it. */
static void span_point(const view_t *view,
                       const footprint_t *footprint,
                       const nav_ground_point_t *point,
                       span_t *span)
{
    const nav_box_t *box = &footprint->box;
    const double du_m = point->u_m - box->u_m;
    const double dv_m = point->v_m - box->v_m;
    /* the box stands upright on the body; its place is the hub's fore and aft, the foot's sideways */
    const double above_m = point->eta_m - footprint->hub_m;
    const double above_foot_m = above_m + view->params->wheel_radius_m;
    const double leaned_u_m = du_m + (footprint->pitch_rad * above_m);
    const double leaned_v_m = dv_m - (footprint->roll_rad * above_foot_m);
    if ((fabs(leaned_u_m) <= box->half_u_m) && (fabs(leaned_v_m) <= box->half_v_m))
    {
        span->eta_min_m = nav_min(span->eta_min_m, point->eta_m);
        span->eta_max_m = nav_max(span->eta_max_m, point->eta_m);
    }
    const double along_m = nav_max(fabs(du_m) - footprint->growth.u_m, 0.0);
    if ((fabs(dv_m) <= footprint->growth.v_m) && (along_m <= view->params->wheel_radius_m))
    {
        span->hub_high_m = nav_max(span->hub_high_m, point->eta_m + wheel_reach_m(view, along_m));
    }
}

/** What the cells in a wheel's box hold. */
static span_t wheel_span(const view_t *view, const footprint_t *footprint)
{
    span_t span = {NAV_ETA_NONE, -NAV_ETA_NONE, -NAV_ETA_NONE, 0U, 0U};
    nav_box_t wide = scanned(view, &footprint->box);
    wide.half_u_m += fabs(footprint->pitch_rad) * ETA_SCAN_M;
    wide.half_v_m += fabs(footprint->roll_rad) * ETA_SCAN_M;
    const nav_columns_t rows = nav_ground_rows(&view->ground, &wide);
    for (int32_t row = rows.first; row <= rows.last; row++)
    {
        uint32_t outside_count = 0U;
        const nav_columns_t cols = nav_ground_columns(&view->ground, &wide, row, &outside_count);
        span.unknown_count += outside_count;
        span.cell_count += outside_count;
        for (int32_t col = cols.first; col <= cols.last; col++)
        {
            nav_ground_point_t point;
            span.cell_count++;
            if (nav_ground_cell(&view->ground, row, col, &point))
            {
                span_point(view, footprint, &point, &span);
            }
            else
            {
                span.unknown_count++;
            }
        }
    }
    return span;
}

/** Lowest and highest a hub can stand along one line of samples, spaced so that the growth is a
 * whole number of them: place - reach .. place + reach touch the disc at place. */
static void line_interval(const double eta_m[SAMPLES_MAX],
                          const double reach_m[SAMPLES_MAX],
                          uint32_t grow_count,
                          uint32_t disc_count,
                          interval_t *hub)
{
    for (uint32_t place = disc_count; place <= (disc_count + (2U * grow_count)); place++)
    {
        double standing_m = -NAV_ETA_NONE;
        for (uint32_t k = 0U; k <= (2U * disc_count); k++)
        {
            const uint32_t off = (k > disc_count) ? (k - disc_count) : (disc_count - k);
            standing_m = nav_max(standing_m, eta_m[(place + k) - disc_count] + reach_m[off]);
        }
        if (standing_m > (-0.5 * NAV_ETA_NONE))
        {
            hub->low_m = nav_min(hub->low_m, standing_m);
            hub->high_m = nav_max(hub->high_m, standing_m);
        }
    }
}

/** Highest a hub can stand on the corners of the surface along one side of a wheel's places; with the
 * cells between the sides these are all corners the wheel can meet. */
static double side_high_m(const view_t *view, const nav_box_t *places, double v_m)
{
    const double reach_m = places->half_u_m + view->params->wheel_radius_m;
    double high_m = -NAV_ETA_NONE;
    for (uint32_t axis = NAV_GROUND_ROWS; axis <= NAV_GROUND_COLUMNS; axis++)
    {
        nav_crossings_t crossings;
        nav_ground_crossings(&view->ground, axis, places->u_m, v_m, reach_m, &crossings);
        for (uint32_t k = 0U; k < crossings.count; k++)
        {
            const double along_m =
                nav_max(fabs(crossings.foot_u_m[k] - places->u_m) - places->half_u_m, 0.0);
            high_m = nav_max(high_m, crossings.eta_m[k] + wheel_reach_m(view, along_m));
        }
    }
    return high_m;
}

/** Heights of a wheel's lowest point over all places the wheel can be. */
static interval_t wheel_interval(const view_t *view, const nav_box_t *places, double high_m)
{
    const double radius_m = view->params->wheel_radius_m;
    const uint32_t grow_count = (uint32_t) (places->half_u_m / SAMPLE_SPACING_M) + 1U;
    const double spacing_m = places->half_u_m / (double) grow_count;
    const uint32_t disc_count = (uint32_t) (radius_m / spacing_m);
    const uint32_t sample_count = (2U * (grow_count + disc_count)) + 1U;
    const uint32_t line_count = (uint32_t) (2.0 * places->half_v_m / SAMPLE_SPACING_M) + 2U;
    const double line_step_m = 2.0 * places->half_v_m / (double) (line_count - 1U);
    double eta_m[SAMPLES_MAX];
    double reach_m[SAMPLES_MAX];
    interval_t hub = {NAV_ETA_NONE, high_m};

    for (uint32_t k = 0U; k <= disc_count; k++)
    {
        reach_m[k] = wheel_reach_m(view, (double) k * spacing_m);
    }
    for (uint32_t line = 0U; line < line_count; line++)
    {
        const double v_m = (places->v_m - places->half_v_m) + ((double) line * line_step_m);
        for (uint32_t k = 0U; k < sample_count; k++)
        {
            const double place = (double) k - (double) (grow_count + disc_count);
            eta_m[k] = nav_ground_eta_m(&view->ground, places->u_m + (place * spacing_m), v_m);
        }
        line_interval(eta_m, reach_m, grow_count, disc_count, &hub);
    }
    hub.high_m = nav_max(hub.high_m, side_high_m(view, places, places->v_m - places->half_v_m));
    hub.high_m = nav_max(hub.high_m, side_high_m(view, places, places->v_m + places->half_v_m));
    hub.low_m -= radius_m;
    hub.high_m -= radius_m;
    return hub;
}

/** Where the feet of what a wheel stands on can be, for terrain heights within the span. */
static nav_box_t wheel_places(const view_t *view, const footprint_t *footprint, const span_t *span)
{
    const double above_m = 0.5 * (span->eta_max_m + span->eta_min_m) / view->ground.cos_slope;
    const double reach_m = 0.5 * (span->eta_max_m - span->eta_min_m) / view->ground.cos_slope;
    const nav_box_t places = {
        footprint->box.u_m - (above_m * view->ground.forward_up),
        footprint->box.v_m - (above_m * view->ground.right_up),
        nav_min(footprint->growth.u_m + (reach_m * fabs(view->ground.forward_up)), GROWTH_MAX_M),
        nav_min(footprint->growth.v_m + (reach_m * fabs(view->ground.right_up)), GROWTH_MAX_M),
    };
    return places;
}

static footprint_t wheel_footprint(const view_t *view, const range_t *range, uint32_t wheel)
{
    const growth_t growth = growth_wheel(view, range, wheel);
    const double turn = turn_of_box(view, range);
    const nav_ground_point_t at =
        from_body(view, range->middle, range->forward_m[wheel], range->right_m[wheel]);
    const footprint_t footprint = {
        {
            at.u_m,
            at.v_m,
            view->params->wheel_radius_m + growth.u_m +
                (range->half[NAV_LINKAGE_PITCH] * WHEEL_LEAN_M) +
                (turn * 0.5 * view->params->wheel_width_m),
            (0.5 * view->params->wheel_width_m) + growth.v_m +
                (range->half[NAV_LINKAGE_ROLL] * WHEEL_LEAN_M),
        },
        growth,
        range->height_m[wheel] + view->params->wheel_radius_m,
        range->middle[NAV_LINKAGE_PITCH],
        range->middle[NAV_LINKAGE_ROLL],
    };
    return footprint;
}

/** Interval, drop and unknown share of one wheel. */
static interval_t wheel_bounds(const view_t *view,
                               const range_t *range,
                               uint32_t wheel,
                               nav_ace_bounds_t *bounds)
{
    const footprint_t footprint = wheel_footprint(view, range, wheel);
    const span_t span = wheel_span(view, &footprint);
    interval_t hub = {-NAV_ETA_NONE, NAV_ETA_NONE};
    double unknown = 1.0;

    if (span.eta_max_m >= span.eta_min_m)
    {
        const nav_box_t places = wheel_places(view, &footprint, &span);
        const double height_m = span.eta_max_m - span.eta_min_m;
        const double margin_m = view->params->ace_margin * height_m;
        unknown = (double) span.unknown_count / (double) span.cell_count;
        bounds->wheel_drop_max_m = nav_max(bounds->wheel_drop_max_m, height_m);
        hub = wheel_interval(view, &places, span.hub_high_m);
        hub.low_m = nav_max(hub.low_m - margin_m, span.eta_min_m);
        hub.high_m += margin_m;
        hub.low_m = (hub.low_m > hub.high_m) ? span.eta_min_m : hub.low_m;
    }
    bounds->wheel_unknown = nav_max(bounds->wheel_unknown, unknown);
    return hub;
}

/** Solves the linkage for the middles and spans the intervals. @return false when unsolvable */
static bool linkage_span(const view_t *view, const interval_t hubs[NAV_WHEELS], linkage_t *linkage)
{
    linkage->wheel_half_max_m = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        linkage->wheel_middle_m[wheel] = 0.5 * (hubs[wheel].low_m + hubs[wheel].high_m);
        linkage->wheel_half_m[wheel] = 0.5 * (hubs[wheel].high_m - hubs[wheel].low_m);
        linkage->wheel_half_max_m =
            nav_max(linkage->wheel_half_max_m, linkage->wheel_half_m[wheel]);
    }
    const bool is_solved = nav_vehicle_settle(view->vehicle, linkage->wheel_middle_m,
                                              linkage->state, linkage->inverse);
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        linkage->half[k] = CURVATURE[k] * squared(linkage->wheel_half_max_m);
        for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
        {
            linkage->half[k] += fabs(linkage->inverse[k][wheel]) * linkage->wheel_half_m[wheel];
        }
    }
    return is_solved;
}

/** Attitude against gravity from the attitude against the plane. */
static void attitude_bounds(const view_t *view, const linkage_t *linkage, nav_ace_bounds_t *bounds)
{
    const nav_ground_t *plane = &view->ground;
    const double roll = linkage->state[NAV_LINKAGE_ROLL];
    const double pitch = linkage->state[NAV_LINKAGE_PITCH];
    const double roll_half = linkage->half[NAV_LINKAGE_ROLL];
    const double pitch_half = linkage->half[NAV_LINKAGE_PITCH];
    const double sr = nav_sin(roll);
    const double cr = nav_cos(roll);
    const double sp = nav_sin(pitch);
    const double cp = nav_cos(pitch);

    /* heights of the ends of the body's unit axes; right is taken down, as roll is */
    const double up =
        (-cr * sp * plane->forward_up) + (sr * plane->right_up) + (cr * cp * plane->cos_slope);
    const double nose = (cp * plane->forward_up) + (sp * plane->cos_slope);
    const double right_down =
        -((sr * sp * plane->forward_up) + (cr * plane->right_up)) + (sr * cp * plane->cos_slope);
    const double pitch_site = nav_asin(nose);
    const double cos_pitch = nav_max(nav_cos(pitch_site), 0.1);
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

    const double z_m = plane->z_site_m - (linkage->state[NAV_LINKAGE_HEIGHT] / plane->cos_slope);
    const double z_reach_m = (linkage->half[NAV_LINKAGE_HEIGHT] / plane->cos_slope) +
                             (slope * view->uncertainty.position_m);
    bounds->z_min_site_m = z_m - z_reach_m;
    bounds->z_max_site_m = z_m + z_reach_m;
}

static void suspension_bounds(const linkage_t *linkage, nav_ace_bounds_t *bounds)
{
    const double *state = linkage->state;
    const double *half = linkage->half;
    bounds->rocker_min_rad = state[NAV_LINKAGE_ROCKER] - half[NAV_LINKAGE_ROCKER];
    bounds->rocker_max_rad = state[NAV_LINKAGE_ROCKER] + half[NAV_LINKAGE_ROCKER];
    bounds->bogie_left_min_rad = state[NAV_LINKAGE_BOGIE_LEFT] - half[NAV_LINKAGE_BOGIE_LEFT];
    bounds->bogie_left_max_rad = state[NAV_LINKAGE_BOGIE_LEFT] + half[NAV_LINKAGE_BOGIE_LEFT];
    bounds->bogie_right_min_rad = state[NAV_LINKAGE_BOGIE_RIGHT] - half[NAV_LINKAGE_BOGIE_RIGHT];
    bounds->bogie_right_max_rad = state[NAV_LINKAGE_BOGIE_RIGHT] + half[NAV_LINKAGE_BOGIE_RIGHT];
}

/** Derivatives of clearance by wheel height, over half of each wheel's interval. */
static void belly_spread_place(const view_t *view, const linkage_t *linkage, belly_t *belly)
{
    const double sr = belly->sin_roll;
    const double cr = belly->cos_roll;
    const double sp = belly->sin_pitch;
    const double cp = belly->cos_pitch;
    const double roll_half = linkage->half[NAV_LINKAGE_ROLL];
    const double pitch_half = linkage->half[NAV_LINKAGE_PITCH];
    double per_u = 0.0;
    double per_v = 0.0;

    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const double height = linkage->inverse[NAV_LINKAGE_HEIGHT][wheel];
        const double roll = linkage->inverse[NAV_LINKAGE_ROLL][wheel];
        const double pitch = linkage->inverse[NAV_LINKAGE_PITCH][wheel];
        const double half_m = linkage->wheel_half_m[wheel];
        belly->spread_0[wheel] =
            half_m *
            ((cr * cp * height) - (belly->lift_m * ((sr * cp * roll) + (cr * sp * pitch))));
        belly->spread_u[wheel] = half_m * ((cr * cp * pitch) - (sr * sp * roll));
        belly->spread_v[wheel] = -half_m * cr * roll;
        per_u += fabs(belly->spread_u[wheel]);
        per_v += fabs(belly->spread_v[wheel]);
    }
    /* attitude acts on eta, and on a slope a cell stands rise * eta from its foot */
    belly->spread_eta = (fabs(sr) * roll_half) + (fabs(sp) * pitch_half) +
                        (0.5 * (squared(roll_half) + squared(pitch_half))) +
                        (per_u * fabs(view->ground.rise_forward)) +
                        (per_v * fabs(view->ground.rise_right));
}

/** Clearance along the body z axis as a function of place. */
static void belly_place(const view_t *view, const linkage_t *linkage, belly_t *belly)
{
    belly->lift_m = linkage->state[NAV_LINKAGE_HEIGHT];
    belly->sin_roll = nav_sin(linkage->state[NAV_LINKAGE_ROLL]);
    belly->cos_roll = nav_cos(linkage->state[NAV_LINKAGE_ROLL]);
    belly->sin_pitch = nav_sin(linkage->state[NAV_LINKAGE_PITCH]);
    belly->cos_pitch = nav_cos(linkage->state[NAV_LINKAGE_PITCH]);
    belly->per_u = belly->cos_roll * belly->sin_pitch;
    belly->per_v = -belly->sin_roll;
    belly->per_eta = belly->cos_roll * belly->cos_pitch;
    belly->at_0_m = view->params->belly_height_m + (belly->per_eta * belly->lift_m);
    belly_spread_place(view, linkage, belly);
}

/** How far clearance at (u, v) can fall below that of the middle state: convex in u and v. */
static double belly_spread_m(const belly_t *belly, double u_m, double v_m)
{
    double spread_m = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        spread_m += fabs(belly->spread_0[wheel] + (belly->spread_u[wheel] * u_m) +
                         (belly->spread_v[wheel] * v_m));
    }
    return spread_m;
}

/** Does a point, seen from the body, lie in the box along the body's axes? */
static bool is_under_belly(const belly_t *belly, const nav_ground_point_t *point)
{
    const nav_box_t *box = &belly->box;
    const double up_m = point->eta_m - belly->lift_m;
    const double u_m = (belly->cos_pitch * point->u_m) + (belly->sin_pitch * up_m);
    const double v_m =
        (belly->sin_roll * ((belly->sin_pitch * point->u_m) - (belly->cos_pitch * up_m))) +
        (belly->cos_roll * point->v_m);
    return (fabs(u_m - box->u_m) <= box->half_u_m) && (fabs(v_m - box->v_m) <= box->half_v_m);
}

/** The convex spread along a row of feet lies below the chord between the ends of the row. */
static void row_spread(const view_t *view,
                       const belly_t *belly,
                       int32_t row,
                       const nav_columns_t *cols,
                       double spread_m[ROW_ENDS])
{
    const nav_ground_t *ground = &view->ground;
    const double cell_m = ground->surface->cell_m;
    const double dx_m = ((double) row - ground->row) * cell_m;
    const int32_t ends[ROW_ENDS] = {cols->first, cols->last};
    for (uint32_t end = 0U; end < ROW_ENDS; end++)
    {
        const double dy_m = ((double) ends[end] - ground->col) * cell_m;
        const double u_m = (ground->u_of_xy[0] * dx_m) + (ground->u_of_xy[1] * dy_m);
        const double v_m = (ground->v_of_xy[0] * dx_m) + (ground->v_of_xy[1] * dy_m);
        spread_m[end] = belly_spread_m(belly, u_m, v_m);
    }
}

/** Least clearance over the cells of a row. */
static double belly_row_m(const view_t *view,
                          const linkage_t *linkage,
                          const belly_t *belly,
                          int32_t row,
                          const nav_columns_t *cols,
                          uint32_t *unknown_count)
{
    const double steps = (cols->last > cols->first) ? (double) (cols->last - cols->first) : 1.0;
    double spread_m[ROW_ENDS];
    double least_m = NAV_ETA_NONE;

    row_spread(view, belly, row, cols, spread_m);
    for (int32_t col = cols->first; col <= cols->last; col++)
    {
        nav_ground_point_t cell;
        if (nav_ground_cell(&view->ground, row, col, &cell))
        {
            const nav_ground_point_t point = to_body(view, linkage->state, &cell);
            const double chord_m = spread_m[0] + ((spread_m[1] - spread_m[0]) *
                                                  ((double) (col - cols->first) / steps));
            const double free_m =
                (belly->at_0_m + (belly->per_u * point.u_m) + (belly->per_v * point.v_m)) -
                (belly->per_eta * point.eta_m) - chord_m - (belly->spread_eta * fabs(point.eta_m));
            if ((free_m < least_m) && is_under_belly(belly, &point))
            {
                least_m = free_m;
            }
        }
        else
        {
            (*unknown_count)++;
        }
    }
    return least_m;
}

/** The belly box, grown by all that can move it against the terrain from the middle state. */
static nav_box_t belly_box(const view_t *view,
                           const range_t *range,
                           const linkage_t *linkage,
                           growth_t *growth)
{
    const nav_params_t *params = view->params;
    const double far_m = nav_max(fabs(params->belly_front_x_m), fabs(params->belly_rear_x_m));
    const double roll_half = linkage->half[NAV_LINKAGE_ROLL];
    const double pitch_half = linkage->half[NAV_LINKAGE_PITCH];
    const double lift_half_m = linkage->half[NAV_LINKAGE_HEIGHT];
    const double roll_far = fabs(linkage->state[NAV_LINKAGE_ROLL]) + roll_half;
    const double pitch_far = fabs(linkage->state[NAV_LINKAGE_PITCH]) + pitch_half;
    /* what is higher than the belly itself is refused wherever it stands */
    const double above_m = params->belly_height_m;
    range_t spanned = *range;
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        spanned.middle[k] = linkage->state[k];
        spanned.half[k] = linkage->half[k];
    }
    *growth = growth_common(view, &spanned, far_m, params->belly_half_width_m);
    growth->u_m += (pitch_half * above_m) + (lift_half_m * pitch_far);
    growth->v_m +=
        (roll_half * above_m) + (lift_half_m * roll_far) + (pitch_half * roll_far * far_m);
    const nav_box_t box = {
        0.5 * (params->belly_front_x_m + params->belly_rear_x_m),
        0.0,
        (0.5 * (params->belly_front_x_m - params->belly_rear_x_m)) + growth->u_m,
        params->belly_half_width_m + growth->v_m,
    };
    return box;
}

/** Lower bound of clearance and unknown share of the belly box. */
static void belly_bounds(const view_t *view,
                         const range_t *range,
                         const linkage_t *linkage,
                         nav_ace_bounds_t *bounds)
{
    const double roll = fabs(linkage->state[NAV_LINKAGE_ROLL]) + linkage->half[NAV_LINKAGE_ROLL];
    const double pitch = fabs(linkage->state[NAV_LINKAGE_PITCH]) + linkage->half[NAV_LINKAGE_PITCH];
    growth_t growth;
    belly_t belly;
    const nav_box_t box = belly_box(view, range, linkage, &growth);
    const nav_ground_point_t at = from_body(view, linkage->state, box.u_m, box.v_m);
    nav_box_t wide = scanned(view, &box);
    uint32_t cell_count = 0U;
    uint32_t unknown_count = 0U;
    double least_m = NAV_ETA_NONE;

    belly_place(view, linkage, &belly);
    belly.box = box;
    const double turn = fabs(turn_of_pitch(view, linkage->state[NAV_LINKAGE_PITCH]));
    wide.u_m = at.u_m;
    wide.v_m = at.v_m;
    wide.half_u_m += (pitch * ETA_SCAN_M) + (turn * box.half_v_m);
    wide.half_v_m += (roll * ETA_SCAN_M) + (turn * box.half_u_m);
    const nav_columns_t rows = nav_ground_rows(&view->ground, &wide);
    for (int32_t row = rows.first; row <= rows.last; row++)
    {
        uint32_t outside_count = 0U;
        const nav_columns_t cols = nav_ground_columns(&view->ground, &wide, row, &outside_count);
        cell_count += outside_count;
        unknown_count += outside_count;
        if (cols.last >= cols.first)
        {
            cell_count += (uint32_t) ((cols.last - cols.first) + 1);
            least_m =
                nav_min(least_m, belly_row_m(view, linkage, &belly, row, &cols, &unknown_count));
        }
    }
    /* the belly may stand elsewhere in its box */
    bounds->clearance_min_m = least_m - (pitch * growth.u_m) - (roll * growth.v_m) -
                              (CURVATURE_CLEARANCE * squared(linkage->wheel_half_max_m));
    bounds->belly_unknown =
        (cell_count > 0U) ? ((double) unknown_count / (double) cell_count) : 1.0;
}

static bool is_beyond(double low, double high, double limit)
{
    return (low < -limit) || (high > limit);
}

/** The limits that ACE holds bounds against. */
typedef struct
{
    double clearance_min_m;
    double tilt_max_rad;
    double rocker_max_rad;
    double bogie_max_rad;
    double wheel_drop_max_m;
} limits_t;

static limits_t limits_of(const nav_params_t *params, bool is_leaving)
{
    const limits_t planned = {params->clearance_min_m, params->tilt_max_rad, params->rocker_max_rad,
                              params->bogie_max_rad, params->wheel_drop_max_m};
    /* never stricter than what is planned with */
    const limits_t leaving = {
        nav_min(params->leave_clearance_min_m, params->clearance_min_m),
        nav_max(params->leave_tilt_max_rad, params->tilt_max_rad),
        nav_max(params->leave_rocker_max_rad, params->rocker_max_rad),
        nav_max(params->leave_bogie_max_rad, params->bogie_max_rad),
        nav_max(params->leave_wheel_drop_max_m, params->wheel_drop_max_m),
    };
    return is_leaving ? leaving : planned;
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
    const limits_t limits = limits_of(params, is_leaving);
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

/** Do the bounds lie inside the range that the growth assumed? */
static bool is_consistent(const linkage_t *linkage, const range_t *range)
{
    bool is_inside = true;
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        is_inside = is_inside && ((fabs(linkage->state[k] - range->middle[k]) + linkage->half[k]) <=
                                  range->half[k]);
    }
    return is_inside;
}

static void range_first(const view_t *view, range_t *range)
{
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        range->middle[k] = 0.0;
        range->half[k] = FIRST_HALF[k];
    }
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        range->height_m[wheel] = 0.0;
    }
    nav_vehicle_wheel_places(view->vehicle, range->middle, range->forward_m, range->right_m);
}

/** The next range: around the solution, wide enough for it, and never narrower than is sensible. */
static void range_next(const view_t *view,
                       const linkage_t *linkage,
                       uint32_t attempts_made,
                       range_t *range)
{
    const double widening = WIDENING_FIRST + (WIDENING_STEP * (double) attempts_made);
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        range->middle[k] = linkage->state[k];
        range->half[k] = (widening * linkage->half[k]) + SLACK[k];
    }
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        range->height_m[wheel] = linkage->wheel_middle_m[wheel];
    }
    nav_vehicle_wheel_places(view->vehicle, range->middle, range->forward_m, range->right_m);
}

/** Bounds for one range, which is moved on to the next. @return true when no other is needed */
static bool attempt(const view_t *view,
                    uint32_t attempts_made,
                    range_t *range,
                    nav_ace_bounds_t *bounds)
{
    static const nav_ace_bounds_t NOTHING = {0};
    interval_t hubs[NAV_WHEELS];
    linkage_t linkage;
    bool is_done = true;

    *bounds = NOTHING;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        hubs[wheel] = wheel_bounds(view, range, wheel, bounds);
    }
    bounds->reason = (uint32_t) NAV_REASON_UNKNOWN;
    if (bounds->wheel_unknown < 1.0)
    {
        bounds->reason = (uint32_t) NAV_REASON_UNEXPECTED;
        if (linkage_span(view, hubs, &linkage))
        {
            suspension_bounds(&linkage, bounds);
            attitude_bounds(view, &linkage, bounds);
            belly_bounds(view, range, &linkage, bounds);
            is_done = is_consistent(&linkage, range);
            bounds->is_certified = is_done ? 1U : 0U;
            bounds->reason = (uint32_t) nav_ace_refuse(view->params, bounds, false);
            range_next(view, &linkage, attempts_made, range);
        }
    }
    return is_done;
}

void nav_ace_evaluate(const nav_ace_scene_t *scene,
                      const nav_pose2_t *pose,
                      const nav_uncertainty_t *uncertainty,
                      nav_ace_bounds_t *bounds)
{
    static const nav_ace_bounds_t UNKNOWN = {
        .wheel_unknown = 1.0, .belly_unknown = 1.0, .reason = (uint32_t) NAV_REASON_UNKNOWN};
    view_t view = {.params = scene->params, .vehicle = scene->vehicle, .uncertainty = *uncertainty};
    bool is_done = !nav_ground_place(&view.ground, scene->surface, scene->costmap, pose);
    range_t range;

    *bounds = UNKNOWN;
    range_first(&view, &range);
    for (uint32_t k = 0U; (k < ATTEMPTS) && !is_done; k++)
    {
        is_done = attempt(&view, k, &range, bounds);
    }
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
