/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_wheel.c
 * @brief What stands in the box of one wheel, and how high its hub can be.
 */
#include "nav_wheel.h"

#include <math.h>

#include "nav_math.h"
#include "nav_minmax.h"

#define PARALLEL 1.0e-9

#define NOTHING (-0.5 * NAV_ETA_NONE)

/* Lines of the grid that are looked at under a wheel. A wheel whose places lie across more of them is
 * given the heights of all ground around. */
#define LINES_MAX 20U

/* Places are taken in parts of at most this half length: the lower end is lost by less. */
#define PART_HALF_M 0.05

/* ------------------------------------------------------------------ the box */

/** One line of the grid seen from a wheel. */
typedef struct
{
    const float *z_site_m; /* first cell */
    double plane_m;        /* z of the plane at the first cell */
    double minor;          /* where the line crosses the middle of the box, in cells */
    double u_m;            /* foot of that point */
} line_t;

static line_t line_of(const nav_ground_t *ground, const nav_box_t *box, int32_t major)
{
    const nav_lanes_t *lanes = &ground->lanes;
    const double ahead = ((double) major - lanes->major) -
                         ((lanes->major_per_u * box->u_m) + (lanes->major_per_v * box->v_m));
    const line_t line = {
        &ground->surface->z_site_m[major * lanes->step_major],
        lanes->plane_first_m + (lanes->plane_major_m * (double) major),
        lanes->minor + (lanes->minor_per_u * box->u_m) + (lanes->minor_per_v * box->v_m) +
            (lanes->minor_per_major * ahead),
        box->u_m + (lanes->u_per_major * ahead),
    };
    return line;
}

/** Lines that a box touches, made longer at both ends. */
static nav_indices_t lines_across(const nav_lanes_t *lanes, const nav_box_t *box, double more_u_m)
{
    const double middle =
        lanes->major + (lanes->major_per_u * box->u_m) + (lanes->major_per_v * box->v_m);
    const double half = (fabs(lanes->major_per_u) * (box->half_u_m + more_u_m)) +
                        (fabs(lanes->major_per_v) * box->half_v_m);
    return nav_ground_between(middle - half, middle + half);
}

/** Cells of a line whose foot is in the box. */
static nav_indices_t cells_across(const nav_lanes_t *lanes,
                                  const nav_box_t *box,
                                  const line_t *line)
{
    const double reach = fabs(lanes->minor_across) * box->half_v_m;
    double low = line->minor - reach;
    double high = line->minor + reach;
    if (fabs(lanes->u_per_minor) > PARALLEL)
    {
        /* where the line leaves the box at its front and back */
        const double middle = line->minor + ((box->u_m - line->u_m) / lanes->u_per_minor);
        const double half = box->half_u_m / fabs(lanes->u_per_minor);
        low = nav_max(low, middle - half);
        high = nav_min(high, middle + half);
    }
    else if (fabs(line->u_m - box->u_m) > box->half_u_m)
    {
        high = low - 1.0;
    }
    else
    {
        /* the whole line lies between front and back */
    }
    return nav_ground_between(low, high);
}

nav_box_t nav_wheel_feet(const nav_ground_t *ground, const nav_footprint_t *footprint)
{
    nav_box_t feet = footprint->box;
    feet.half_u_m += (NAV_STAND_MAX_M * fabs(ground->rise_forward)) +
                     (NAV_STAND_MAX_M * fabs(footprint->pitch_rad));
    feet.half_v_m += (NAV_STAND_MAX_M * fabs(ground->rise_right)) +
                     (NAV_STAND_MAX_M * fabs(footprint->roll_rad));
    return feet;
}

/** Does a point of the ground stand in the box? It is upright on the body; its place is the hub's fore
 * and aft, the foot's sideways. */
static bool is_in_box(const nav_ground_t *ground,
                      const nav_footprint_t *footprint,
                      double foot_u_m,
                      double foot_v_m,
                      double above_m)
{
    const nav_box_t *box = &footprint->box;
    const double over_hub_m = (above_m * ground->cos_slope) - footprint->hub_m;
    const double u_m =
        foot_u_m + (above_m * ground->forward_up) + (footprint->pitch_rad * over_hub_m);
    const double v_m = foot_v_m + (above_m * ground->right_up) -
                       (footprint->roll_rad * (over_hub_m + footprint->radius_m));
    return (fabs(u_m - box->u_m) <= box->half_u_m) && (fabs(v_m - box->v_m) <= box->half_v_m);
}

/** Takes the cells of a line into a span; only those that would widen it are looked at closely. */
static void span_line(const nav_ground_t *ground,
                      const nav_footprint_t *footprint,
                      const line_t *line,
                      const nav_indices_t *cells,
                      nav_span_t *span)
{
    const nav_lanes_t *lanes = &ground->lanes;
    const float *z_site_m = &line->z_site_m[cells->first * lanes->step_minor];
    double plane_m = line->plane_m + (lanes->plane_minor_m * (double) cells->first);
    for (int32_t cell = cells->first; cell <= cells->last; cell++)
    {
        const double above_m = plane_m - (double) *z_site_m;
        if ((above_m < span->above.low_m) || (above_m > span->above.high_m))
        {
            const double off = (double) cell - line->minor;
            const double foot_v_m = footprint->box.v_m + (off / lanes->minor_across);
            if (above_m < NOTHING)
            {
                span->unknown_count++;
            }
            else if (is_in_box(ground, footprint, line->u_m + (off * lanes->u_per_minor), foot_v_m,
                               above_m))
            {
                span->above.low_m = nav_min(span->above.low_m, above_m);
                span->above.high_m = nav_max(span->above.high_m, above_m);
            }
            else
            {
                /* its foot is in the box, but it leans out of it */
            }
        }
        plane_m += lanes->plane_minor_m;
        z_site_m = &z_site_m[lanes->step_minor];
    }
}

/** Cuts indices to those on the map. @return the number cut off */
static uint32_t cut_to_map(nav_indices_t *indices)
{
    const int32_t count = (indices->last - indices->first) + 1;
    indices->first = (indices->first < 0) ? 0 : indices->first;
    indices->last = (indices->last < NAV_HEIGHTMAP_SIZE) ? indices->last : (NAV_HEIGHTMAP_SIZE - 1);
    const int32_t left =
        (indices->last >= indices->first) ? ((indices->last - indices->first) + 1) : 0;
    return (count > left) ? (uint32_t) (count - left) : 0U;
}

nav_span_t nav_wheel_span(const nav_ground_t *ground, const nav_footprint_t *footprint)
{
    const nav_lanes_t *lanes = &ground->lanes;
    const nav_box_t feet = nav_wheel_feet(ground, footprint);
    const nav_indices_t lines = lines_across(lanes, &feet, 0.0);
    nav_span_t span = {{NAV_ETA_NONE, -NAV_ETA_NONE}, 0U, 0U};

    for (int32_t major = lines.first; major <= lines.last; major++)
    {
        const bool is_on_map = (major >= 0) && (major < NAV_HEIGHTMAP_SIZE);
        const line_t line = line_of(ground, &feet, is_on_map ? major : 0);
        nav_indices_t cells = cells_across(lanes, &feet, &line);
        const uint32_t off_count = is_on_map ? cut_to_map(&cells) : 1U;
        span.unknown_count += off_count;
        span.cell_count += off_count;
        if (is_on_map && (cells.last >= cells.first))
        {
            span.cell_count += (uint32_t) ((cells.last - cells.first) + 1);
            span_line(ground, footprint, &line, &cells, &span);
        }
    }
    return span;
}

/* ------------------------------------------------------------------ the hub */

/** Ground under a wheel's places, line by line. Heights are of the ground, above the plane. */
typedef struct
{
    uint32_t count;
    line_t lines[LINES_MAX];   /* their feet are seen from the middle of the places */
    double under_m[LINES_MAX]; /* lowest cell that the sides touch on their way to the next line, */
    double over_m[LINES_MAX];  /* and highest */
} profile_t;

/** What stays the same for one wheel. */
typedef struct
{
    const nav_ground_t *ground;
    const nav_box_t *places;
    double radius_m;
    double half_minor; /* half width of the places along a line, in cells */
    double half_u_m;   /* and how far the heading's place moves along that */
    double uphill_m;   /* how far ground is from its foot at most */
    int32_t aside;     /* cells by which a side can move on its way to the next line: 0 or 1 */
} track_t;

/** A point of the ground that a disc could touch. */
typedef struct
{
    double u_m;
    double eta_m;
} touch_t;

/** Ground between two points: straight but for a bulge, and nowhere higher than its highest cell. */
typedef struct
{
    touch_t from;
    touch_t to;
    double bulge_m;
    double over_m;
} stretch_t;

/** Height over the ground of a hub whose disc touches it at a distance fore or aft; 0: does not. */
static double disc_m(double radius_m, double along_m)
{
    return sqrt(nav_max((radius_m * radius_m) - (along_m * along_m), 0.0));
}

static touch_t touch_at(const track_t *track, double foot_u_m, double above_m)
{
    const touch_t touch = {foot_u_m + (above_m * track->ground->forward_up),
                           above_m * track->ground->cos_slope};
    return touch;
}

/** Raises the highest hub by one point of the ground. */
static void raise_at(const track_t *track, double half_m, const touch_t *touch, double *high_m)
{
    const double along_m = nav_max(fabs(touch->u_m) - half_m, 0.0);
    if (along_m <= track->radius_m)
    {
        *high_m = nav_max(*high_m, touch->eta_m + disc_m(track->radius_m, along_m));
    }
}

/**
 * Where a stretch of ground, raised by its bulge and cut off at its highest cell, lifts a hub most. It is where
 * the disc is parallel to it: outside the places, that is at radius * slope / sqrt(1 + slope^2) from the nearest
 * of them. Where the ground is cut off before that, it is as near to the places as it is cut off.
 * @param ends_m  the ends of the stretch, @param half_m  the places are within this of the middle
 */
static touch_t summit_of(const stretch_t *stretch,
                         const nav_interval_t *ends_m,
                         double half_m,
                         double radius_m)
{
    const touch_t *from = &stretch->from;
    const double rise_m = stretch->to.eta_m - from->eta_m;
    const double slope = ((stretch->to.u_m < from->u_m) ? -rise_m : rise_m) /
                         nav_max(ends_m->high_m - ends_m->low_m, PARALLEL);
    const double upright = 1.0 / sqrt(1.0 + (slope * slope));
    const double outward_m = half_m + (radius_m * fabs(slope) * upright);
    touch_t summit = {
        nav_clamp((slope < 0.0) ? -outward_m : outward_m, ends_m->low_m, ends_m->high_m), 0.0};
    summit.eta_m = from->eta_m + (slope * (summit.u_m - from->u_m)) + stretch->bulge_m;
    if (summit.eta_m > stretch->over_m)
    {
        /* how far back from there it is cut off */
        const double back_m = (summit.eta_m - stretch->over_m) / nav_max(fabs(slope), PARALLEL);
        const double cut_m = (slope < 0.0) ? (summit.u_m + back_m) : (summit.u_m - back_m);
        summit.u_m = nav_clamp(0.0, nav_min(summit.u_m, cut_m), nav_max(summit.u_m, cut_m));
        summit.u_m = nav_clamp(summit.u_m, ends_m->low_m, ends_m->high_m);
        summit.eta_m = stretch->over_m;
    }
    return summit;
}

/** Raises the highest hub by a stretch of ground, over all places within half_m of the middle. */
static void raise_along(const track_t *track,
                        double half_m,
                        const stretch_t *stretch,
                        double *high_m)
{
    const double radius_m = track->radius_m;
    const touch_t *from = &stretch->from;
    const touch_t *to = &stretch->to;
    const nav_interval_t ends_m = {nav_min(from->u_m, to->u_m), nav_max(from->u_m, to->u_m)};
    const double near_m = nav_max(nav_max(ends_m.low_m, -ends_m.high_m) - half_m, 0.0);
    const double top_m =
        nav_min(nav_max(from->eta_m, to->eta_m) + stretch->bulge_m, stretch->over_m);
    raise_at(track, half_m, from, high_m);
    raise_at(track, half_m, to, high_m);
    if ((near_m < radius_m) && ((top_m + disc_m(radius_m, near_m)) > *high_m))
    {
        const touch_t summit = summit_of(stretch, &ends_m, half_m, radius_m);
        raise_at(track, half_m, &summit, high_m);
    }
}

static double above_at(const nav_lanes_t *lanes, const line_t *line, int32_t cell)
{
    return (line->plane_m + (lanes->plane_minor_m * (double) cell)) -
           (double) line->z_site_m[cell * lanes->step_minor];
}

/** How much the ground of a line rises from a cell to the next one. */
static double rise_from(const nav_lanes_t *lanes, const line_t *line, int32_t cell)
{
    const float *z_site_m = &line->z_site_m[cell * lanes->step_minor];
    return lanes->plane_minor_m - ((double) z_site_m[lanes->step_minor] - (double) *z_site_m);
}

/** Height above the plane where a line crosses a place between cells. */
static double above_between(const nav_lanes_t *lanes, const line_t *line, double minor)
{
    const int32_t cell = (int32_t) minor;
    return above_at(lanes, line, cell) + ((minor - (double) cell) * rise_from(lanes, line, cell));
}

/** Between which heights above the plane the ground of a line lies from side to side of the places. */
static nav_interval_t between_sides(const track_t *track, const line_t *line)
{
    const nav_lanes_t *lanes = &track->ground->lanes;
    const double left = line->minor - track->half_minor;
    const double right = line->minor + track->half_minor;
    const double left_m = above_between(lanes, line, left);
    const double right_m = above_between(lanes, line, right);
    nav_interval_t above = {nav_min(left_m, right_m), nav_max(left_m, right_m)};
    for (int32_t cell = (int32_t) left + 1; cell <= (int32_t) right; cell++)
    {
        const double above_m = above_at(lanes, line, cell);
        above.low_m = nav_min(above.low_m, above_m);
        above.high_m = nav_max(above.high_m, above_m);
    }
    return above;
}

/** Adds a line to the profile. @return false when some of it is unknown or off the map */
static bool add_line(const track_t *track, const line_t *line, profile_t *profile)
{
    const nav_lanes_t *lanes = &track->ground->lanes;
    const double left = line->minor - track->half_minor;
    const double right = line->minor + track->half_minor;
    const uint32_t k = profile->count;
    bool is_known = (left >= 1.0) && (right < (double) (NAV_HEIGHTMAP_SIZE - 2));
    if (is_known)
    {
        const int32_t start = (int32_t) left - track->aside;
        const int32_t cell_count = ((((int32_t) right + 1) + track->aside) - start) + 1;
        const float *z_site_m = &line->z_site_m[start * lanes->step_minor];
        double plane_m = line->plane_m + (lanes->plane_minor_m * (double) start);
        double under_m = NAV_ETA_NONE;
        double over_m = -NAV_ETA_NONE;
        for (int32_t cell = 0; cell < cell_count; cell++)
        {
            const double above_m = plane_m - (double) *z_site_m;
            under_m = nav_min(under_m, above_m);
            over_m = nav_max(over_m, above_m);
            plane_m += lanes->plane_minor_m;
            z_site_m = &z_site_m[lanes->step_minor];
        }
        is_known = under_m > NOTHING;
        profile->lines[k] = *line;
        profile->under_m[k] = under_m;
        profile->over_m[k] = over_m;
    }
    return is_known;
}

/** Takes the ground of every line that a wheel could touch: one stretch of known lines without a gap. */
static void take_lines(const track_t *track, const nav_indices_t *majors, profile_t *profile)
{
    const nav_lanes_t *lanes = &track->ground->lanes;
    line_t line = line_of(track->ground, track->places, majors->first);
    bool is_over = false;
    profile->count = 0U;
    line.u_m -= track->places->u_m;
    for (int32_t major = majors->first; (major <= majors->last) && !is_over; major++)
    {
        if (add_line(track, &line, profile))
        {
            profile->count++;
        }
        else
        {
            is_over = profile->count > 0U;
        }
        line.z_site_m = &line.z_site_m[lanes->step_major];
        line.plane_m += lanes->plane_major_m;
        line.minor += lanes->minor_per_major;
        line.u_m += lanes->u_per_major;
    }
}

/**
 * How far the ground along one side of the places rises over its chord from one line to the next, at most. There
 * the surface is a mean of what the two lines hold where the side is: as it moves along them, either rises by no
 * more than its steepest cell. The mean of both, over the way, is a parabola.
 */
static double bulge_along_m(const track_t *track, const line_t lines[2], double aside)
{
    const nav_lanes_t *lanes = &track->ground->lanes;
    const double drift = lanes->minor_per_major;
    const int32_t cells[2] = {(int32_t) (lines[0].minor + aside),
                              (int32_t) (lines[1].minor + aside)};
    double gain_m = 0.0;
    for (uint32_t k = 0U; k < 2U; k++)
    {
        const double toward = (k == 0U) ? drift : -drift;
        gain_m += nav_max(toward * rise_from(lanes, &lines[k], cells[0]),
                          toward * rise_from(lanes, &lines[k], cells[1]));
    }
    return 0.25 * nav_max(gain_m, 0.0) * track->ground->cos_slope;
}

/** Raises the highest hub by the ground along one side of the places, from one line to the next. */
static void raise_along_side(const track_t *track,
                             const line_t lines[2],
                             double aside,
                             double bulge_m,
                             double over_m,
                             double *high_m)
{
    const nav_lanes_t *lanes = &track->ground->lanes;
    const double aside_u_m = aside * lanes->u_per_minor;
    const stretch_t stretch = {
        touch_at(track, lines[0].u_m + aside_u_m,
                 above_between(lanes, &lines[0], lines[0].minor + aside)),
        touch_at(track, lines[1].u_m + aside_u_m,
                 above_between(lanes, &lines[1], lines[1].minor + aside)),
        bulge_m,
        over_m,
    };
    /* on a slope the bulge stands uphill of its foot */
    raise_along(track, track->places->half_u_m + (bulge_m * fabs(track->ground->rise_forward)),
                &stretch, high_m);
}

/** Is there a cell between the sides, on either line or on the way from one to the other? */
static bool has_inner(const track_t *track, const line_t lines[2])
{
    const double left = nav_min(lines[0].minor, lines[1].minor) - track->half_minor;
    const double right = nav_max(lines[0].minor, lines[1].minor) + track->half_minor;
    return (int32_t) left < (int32_t) right;
}

/** Raises the highest hub by the cells between the sides, wherever along their lines they are: what leads from
 * them to a side lies under their chord, raised as much as the sides are. */
static void raise_along_inner(
    const track_t *track, const line_t lines[2], double bulge_m, double over_m, double *high_m)
{
    if (has_inner(track, lines))
    {
        const double half_m = track->places->half_u_m + track->half_u_m +
                              (bulge_m * fabs(track->ground->rise_forward));
        const stretch_t stretch = {
            touch_at(track, lines[0].u_m, between_sides(track, &lines[0]).high_m),
            touch_at(track, lines[1].u_m, between_sides(track, &lines[1]).high_m),
            bulge_m,
            over_m,
        };
        raise_along(track, half_m, &stretch, high_m);
    }
}

/** Raises the highest hub by the ground from a line to the next, if that can be. */
static void raise_between(const track_t *track,
                          const profile_t *profile,
                          uint32_t k,
                          double *high_m)
{
    const line_t *lines = &profile->lines[k];
    const double over_m =
        nav_max(profile->over_m[k], profile->over_m[k + 1U]) * track->ground->cos_slope;
    /* no reach is longer than the radius */
    if ((over_m + track->radius_m) > *high_m)
    {
        const double between_m = nav_max(
            nav_max(nav_min(lines[0].u_m, lines[1].u_m), -nav_max(lines[0].u_m, lines[1].u_m)),
            0.0);
        const double along_m =
            nav_max(between_m - (track->places->half_u_m + track->half_u_m + track->uphill_m), 0.0);
        if ((over_m + disc_m(track->radius_m, along_m)) > *high_m)
        {
            const double half = track->half_minor;
            const double left_m = bulge_along_m(track, lines, -half);
            const double right_m = bulge_along_m(track, lines, half);
            raise_along_side(track, lines, -half, left_m, over_m, high_m);
            raise_along_side(track, lines, half, right_m, over_m, high_m);
            raise_along_inner(track, lines, nav_max(left_m, right_m), over_m, high_m);
        }
    }
}

/** Highest hub over all places: looks first where its middle is. */
static double hub_high_m(const track_t *track, const profile_t *profile)
{
    const uint32_t middle = profile->count / 2U;
    double high_m = -NAV_ETA_NONE;
    for (uint32_t k = middle; (k + 1U) < profile->count; k++)
    {
        raise_between(track, profile, k, &high_m);
    }
    for (uint32_t k = middle; k > 0U; k--)
    {
        raise_between(track, profile, k - 1U, &high_m);
    }
    return high_m;
}

/** Lines near the places, for the lowest hub. */
typedef struct
{
    const profile_t *profile;
    uint32_t first;
    uint32_t last;
    touch_t low[LINES_MAX]; /* of each of them: the lowest ground between the sides */
} near_lines_t;

/** Takes the lines within a distance of the middle of the places, maybe none. */
static void take_near_lines(const track_t *track, double near_m, near_lines_t *near)
{
    const profile_t *profile = near->profile;
    near->first = profile->count;
    near->last = 0U;
    for (uint32_t k = 0U; k < profile->count; k++)
    {
        if (fabs(profile->lines[k].u_m) <= near_m)
        {
            near->first = (k < near->first) ? k : near->first;
            near->last = k;
            near->low[k] = touch_at(track, profile->lines[k].u_m,
                                    between_sides(track, &profile->lines[k]).low_m);
        }
    }
}

/** Lowest ground that a hub within reach_m of u_m can be over: of all stretches from line to line that
 * lie there, leaning as slopes make them. */
static double under_hub_m(const track_t *track,
                          const near_lines_t *near,
                          double u_m,
                          double reach_m)
{
    const profile_t *profile = near->profile;
    const double lean = fabs(track->ground->forward_up);
    double under_m = NAV_ETA_NONE;
    for (uint32_t k = near->first; k < near->last; k++)
    {
        const double from_m = near->low[k].u_m;
        const double to_m = near->low[k + 1U].u_m;
        const double stretch_m = nav_min(profile->under_m[k], profile->under_m[k + 1U]);
        const double over_m = nav_max(profile->over_m[k], profile->over_m[k + 1U]);
        const double near_m = reach_m + ((over_m - stretch_m) * lean);
        if (((nav_min(from_m, to_m) - near_m) <= u_m) && (u_m <= (nav_max(from_m, to_m) + near_m)))
        {
            under_m = nav_min(under_m, stretch_m);
        }
    }
    return (under_m < NAV_ETA_NONE) ? (under_m * track->ground->cos_slope) : -NAV_ETA_NONE;
}

/** Lowest hub over a part of the places around u_m: on whatever line it stands highest at least, and
 * not below the ground under its middle. */
static double part_low_m(const track_t *track, const near_lines_t *near, double u_m, double half_m)
{
    const double reach_m = half_m + track->half_u_m;
    const double radius_m = track->radius_m;
    double standing_m = under_hub_m(track, near, u_m, reach_m) + radius_m;
    for (uint32_t k = near->first; k <= near->last; k++)
    {
        const touch_t *low = &near->low[k];
        const double along_m = fabs(low->u_m - u_m) + reach_m;
        /* no higher than straight above it */
        if ((along_m < radius_m) && ((low->eta_m + radius_m) > standing_m))
        {
            standing_m = nav_max(standing_m, low->eta_m + disc_m(radius_m, along_m));
        }
    }
    return standing_m - radius_m;
}

/** Lowest hub over all places. */
static double hub_low_m(const track_t *track, const profile_t *profile)
{
    const nav_box_t *places = track->places;
    const uint32_t part_count = 1U + (uint32_t) (places->half_u_m / PART_HALF_M);
    const double half_m = places->half_u_m / (double) part_count;
    const double spacing_m = fabs(track->ground->lanes.u_per_major);
    near_lines_t near = {.profile = profile};
    double low_m = NAV_ETA_NONE;
    take_near_lines(track, places->half_u_m + track->half_u_m + (2.0 * track->uphill_m) + spacing_m,
                    &near);
    for (uint32_t part = 0U; part < part_count; part++)
    {
        const double u_m = (half_m * (double) ((2U * part) + 1U)) - places->half_u_m;
        low_m = nav_min(low_m, part_low_m(track, &near, u_m, half_m));
    }
    return low_m;
}

/** How far from its places a wheel can touch ground within a range of heights. */
static double touch_reach_m(const nav_ground_t *ground,
                            const nav_interval_t *above,
                            double radius_m)
{
    const double span_m = nav_min((above->high_m - above->low_m) * ground->cos_slope, radius_m);
    return disc_m(radius_m, radius_m - span_m);
}

nav_interval_t nav_wheel_interval(const nav_ground_t *ground,
                                  const nav_box_t *places,
                                  const nav_interval_t *above,
                                  double radius_m)
{
    const nav_lanes_t *lanes = &ground->lanes;
    const double half_minor = places->half_v_m * fabs(lanes->minor_across);
    const track_t track = {
        ground,
        places,
        radius_m,
        half_minor,
        half_minor * fabs(lanes->u_per_minor),
        fabs(ground->forward_up) * nav_max(fabs(above->low_m), fabs(above->high_m)),
        (fabs(lanes->minor_per_major) > PARALLEL) ? 1 : 0,
    };
    profile_t profile;

    /* and one line more on either side: what is touched can lie between two */
    nav_indices_t majors = lines_across(lanes, places,
                                        touch_reach_m(ground, above, radius_m) + track.uphill_m +
                                            fabs(lanes->u_per_major));
    (void) cut_to_map(&majors);
    nav_interval_t hub = {above->low_m * ground->cos_slope, above->high_m * ground->cos_slope};
    if ((majors.last - majors.first) < (int32_t) LINES_MAX)
    {
        take_lines(&track, &majors, &profile);
        const double high_m = hub_high_m(&track, &profile) - radius_m;
        if (high_m > NOTHING)
        {
            hub.high_m = high_m;
            hub.low_m = nav_min(nav_max(hub.low_m, hub_low_m(&track, &profile)), high_m);
        }
    }
    return hub;
}
