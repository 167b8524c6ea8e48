/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file contact.c
 * @brief Nearest point of a point, disc or cylinder wheel to a bilinear surface.
 */
#include "contact.h"

#include <math.h>

#define RIM_STEPS_MAX 12
#define CYLINDER_DISCS 5
/* more than what single precision may misplace a sample by */
#define REACH_ROUNDING_M 1e-3
/* the rim is searched to 85 degrees from straight down */
#define RIM_SINE_MAX 0.99619
/* the rim's nearest point is found to this height */
#define RIM_TOLERANCE_M 1e-6
/* local minima this close to the best sample are refined too: a kink may hide below a sample */
#define REFINE_MARGIN_M 0.01F

void support_set(const sim_terrain_t *terrain, const double *hub_z_m, support_t *support)
{
    support->terrain = terrain;
    support->hub_z_m = hub_z_m;
    support->nodes_per_m = (terrain != NULL) ? 1.0 / terrain->resolution_m : 0.0;
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const double part =
            (double) ((2 * sample) - (RIM_SAMPLES - 1)) / (double) (RIM_SAMPLES - 1);
        const double sine = RIM_SINE_MAX * part;
        const double cosine = sqrt(1.0 - (sine * sine));
        support->rim_sine[sample] = (float) sine;
        support->rim_cosine[sample] = (float) cosine;
        support->rim_h[sample] = sine / (1.0 + cosine);
    }
}

/* ------------------------------------------------------------------ one disc */

/* a disc of a wheel in its posture over the ground */
typedef struct
{
    const support_t *support;
    const linkage_t *linkage;
    double radius_m;
    double centre_m[3];
} disc_t;

/* one evaluated place on the rim, at h = tan(angle / 2) from straight down */
typedef struct
{
    double h;
    double slope;
    double tangent[3];
    contact_t contact;
} rim_t;

/* gap at h and its slope, the derivative by h; in h the rim needs neither root nor sine */
static inline void evaluate_rim(const disc_t *disc, double h, rim_t *rim)
{
    const double *ex = disc->linkage->ex;
    const double *ez = disc->linkage->ez;
    const double inverse = 1.0 / (1.0 + (h * h));
    const double cosine = (2.0 * inverse) - 1.0;
    const double sine = 2.0 * h * inverse;
    const double rate = 2.0 * disc->radius_m * inverse;
    contact_t *contact = &rim->contact;
    ground_t ground;
    for (int axis = 0; axis < 3; axis++)
    {
        contact->point_m[axis] =
            disc->centre_m[axis] + (disc->radius_m * ((cosine * ez[axis]) + (sine * ex[axis])));
        rim->tangent[axis] = rate * ((cosine * ex[axis]) - (sine * ez[axis]));
    }
    sample_ground(disc->support, contact->point_m[0], contact->point_m[1], &ground);
    contact->gap_m = ground.z_m - contact->point_m[2];
    contact->slope_north = ground.slope_north;
    contact->slope_east = ground.slope_east;
    rim->h = h;
    rim->slope = (ground.slope_north * rim->tangent[0]) + (ground.slope_east * rim->tangent[1]) -
                 rim->tangent[2];
}

/*
 * At the nearest rim point the gap is stationary along the rim. Where that point sits on a crease
 * between two cells neither cell's slope says so: give the slope along the rim the tangent's value.
 */
static void make_stationary(const double *tangent, contact_t *contact)
{
    const double rise = (contact->slope_north * tangent[0]) + (contact->slope_east * tangent[1]);
    const double excess =
        (rise - tangent[2]) / ((tangent[0] * tangent[0]) + (tangent[1] * tangent[1]));
    contact->slope_north -= excess * tangent[0];
    contact->slope_east -= excess * tangent[1];
}

/*
 * Refines a bracketed minimum. The end tangents cross below a convex gap: their crossing bounds the
 * error and is the next place to look where the ground has a crease; where it is smooth the zero of
 * the interpolated slope is. The two alternate.
 */
static void refine_rim(const disc_t *disc, double low_h, double high_h, contact_t *best)
{
    rim_t low;
    rim_t high;
    rim_t middle;
    evaluate_rim(disc, low_h, &low);
    evaluate_rim(disc, high_h, &high);
    rim_t nearest = (low.contact.gap_m < high.contact.gap_m) ? low : high;
    for (int step = 0; step < RIM_STEPS_MAX; step++)
    {
        const double span = high.h - low.h;
        const double turn = high.slope - low.slope;
        if (!(turn > 0.0))
        {
            break;
        }
        const double crossing =
            (low.contact.gap_m - high.contact.gap_m + (high.slope * span)) / turn;
        const double bound_m = low.contact.gap_m + (low.slope * crossing);
        if ((step > 0) && (fabs(nearest.contact.gap_m - bound_m) <= RIM_TOLERANCE_M))
        {
            break;
        }
        const double smooth = -low.slope * span / turn;
        const double advance = (step == 0) ? 0.5 * span : (((step % 2) == 0) ? crossing : smooth);
        const double far_enough = (advance < 0.02 * span) ? 0.02 * span : advance;
        const double inside = (far_enough > 0.98 * span) ? 0.98 * span : far_enough;
        evaluate_rim(disc, low.h + inside, &middle);
        nearest = (middle.contact.gap_m < nearest.contact.gap_m) ? middle : nearest;
        if (middle.slope < 0.0)
        {
            low = middle;
        }
        else
        {
            high = middle;
        }
    }
    if (nearest.contact.gap_m < best->gap_m)
    {
        *best = nearest.contact;
        make_stationary(nearest.tangent, best);
    }
}

/* the samples on the ground: the node south-west of each, the place in its cell, and the rim's depth */
typedef struct
{
    int32_t node[RIM_SAMPLES];
    float north[RIM_SAMPLES];
    float east[RIM_SAMPLES];
    float z_m[RIM_SAMPLES];
} rim_places_t;

/* places the samples relative to a node and to the depth of the disc's centre */
static void place_samples(const disc_t *disc,
                          int32_t base_row,
                          int32_t base_col,
                          rim_places_t *places)
{
    const support_t *support = disc->support;
    const sim_terrain_t *terrain = support->terrain;
    const double scale = support->nodes_per_m;
    const double radius = disc->radius_m * scale;
    const float u_centre =
        (float) (((disc->centre_m[0] - terrain->north_min_m) * scale) - base_row);
    const float v_centre = (float) (((disc->centre_m[1] - terrain->east_min_m) * scale) - base_col);
    const float u_down = (float) (radius * disc->linkage->ez[0]);
    const float v_down = (float) (radius * disc->linkage->ez[1]);
    const float z_down = (float) (disc->radius_m * disc->linkage->ez[2]);
    const float u_ahead = (float) (radius * disc->linkage->ex[0]);
    const float v_ahead = (float) (radius * disc->linkage->ex[1]);
    const float z_ahead = (float) (disc->radius_m * disc->linkage->ex[2]);
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const float sine = support->rim_sine[sample];
        const float cosine = support->rim_cosine[sample];
        const float u = u_centre + (cosine * u_down) + (sine * u_ahead);
        const float v = v_centre + (cosine * v_down) + (sine * v_ahead);
        const int32_t row = (int32_t) u;
        const int32_t col = (int32_t) v;
        places->node[sample] = (row * terrain->cols) + col;
        places->north[sample] = u - (float) row;
        places->east[sample] = v - (float) col;
        places->z_m[sample] = (cosine * z_down) + (sine * z_ahead);
    }
}

/*
 * Gaps of the sampled rim into gap[]; returns the least, NaN where there is no ground. They only
 * tell where to look closer: single precision does, and several samples are worked on at a time.
 */
static float sample_rim(const disc_t *disc, float *gap)
{
    const support_t *support = disc->support;
    const sim_terrain_t *terrain = support->terrain;
    const double radius = disc->radius_m * support->nodes_per_m;
    const int32_t base_row =
        (int32_t) (((disc->centre_m[0] - terrain->north_min_m) * support->nodes_per_m) - radius);
    const int32_t base_col =
        (int32_t) (((disc->centre_m[1] - terrain->east_min_m) * support->nodes_per_m) - radius);
    const float *base = &terrain->z_site_m[((ptrdiff_t) base_row * terrain->cols) + base_col];
    const float z_centre_m = (float) disc->centre_m[2];
    rim_places_t places;
    float corner_m[4][RIM_SAMPLES];
    float sum = 0.0F;
    float least = (float) INFINITY;
    place_samples(disc, base_row, base_col, &places);
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const float *south = &base[places.node[sample]];
        const float *north = south + terrain->cols;
        corner_m[0][sample] = south[0];
        corner_m[1][sample] = south[1];
        corner_m[2][sample] = north[0];
        corner_m[3][sample] = north[1];
    }
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const float east = places.east[sample];
        const float south_m =
            corner_m[0][sample] + (east * (corner_m[1][sample] - corner_m[0][sample]));
        const float north_m =
            corner_m[2][sample] + (east * (corner_m[3][sample] - corner_m[2][sample]));
        const float ground_m = south_m + (places.north[sample] * (north_m - south_m));
        gap[sample] = (ground_m - z_centre_m) - places.z_m[sample];
    }
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        sum += gap[sample];
        least = (gap[sample] < least) ? gap[sample] : least;
    }
    return isnan(sum) ? (float) NAN : least;
}

/* nearest point of one disc: sampled along the rim, then every promising minimum refined */
static void disc_contact(const disc_t *disc, contact_t *best)
{
    const double *rim_h = disc->support->rim_h;
    float gap[RIM_SAMPLES];
    const float least = sample_rim(disc, gap);
    if (isnan(least))
    {
        best->gap_m = NAN;
        return;
    }
    const float found = (float) best->gap_m;
    const float limit = ((least < found) ? least : found) + REFINE_MARGIN_M;
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const int before = (sample > 0) ? sample - 1 : 0;
        const int after = (sample < RIM_SAMPLES - 1) ? sample + 1 : RIM_SAMPLES - 1;
        if ((gap[sample] <= limit) && (gap[sample] <= gap[before]) && (gap[sample] <= gap[after]))
        {
            refine_rim(disc, rim_h[before], rim_h[after], best);
        }
    }
}

/* ------------------------------------------------------------------ wheels */

static void point_contact(const support_t *support, const double *point_m, contact_t *contact)
{
    ground_t ground;
    sample_ground(support, point_m[0], point_m[1], &ground);
    for (int axis = 0; axis < 3; axis++)
    {
        contact->point_m[axis] = point_m[axis];
    }
    contact->gap_m = ground.z_m - point_m[2];
    contact->slope_north = ground.slope_north;
    contact->slope_east = ground.slope_east;
}

static void rolling_contact(const support_t *support,
                            const sim_vehicle_t *vehicle,
                            const linkage_t *linkage,
                            const double *hub_m,
                            contact_t *contact)
{
    const int discs = (vehicle->wheel_kind == SIM_WHEEL_CYLINDER) ? CYLINDER_DISCS : 1;
    contact->gap_m = INFINITY;
    for (int i = 0; (i < discs) && !isnan(contact->gap_m); i++)
    {
        const double part = (discs == 1) ? 0.0 : ((double) i / (double) (discs - 1)) - 0.5;
        const double offset_m = part * vehicle->wheel_width_m;
        const disc_t disc = {support,
                             linkage,
                             vehicle->wheel_radius_m,
                             {hub_m[0] + (offset_m * linkage->ey[0]),
                              hub_m[1] + (offset_m * linkage->ey[1]),
                              hub_m[2] + (offset_m * linkage->ey[2])}};
        disc_contact(&disc, contact);
    }
}

void wheel_contact(const support_t *support,
                   const sim_vehicle_t *vehicle,
                   const linkage_t *linkage,
                   int wheel,
                   contact_t *contact)
{
    const double reach_m =
        vehicle->wheel_radius_m + (0.5 * vehicle->wheel_width_m) + REACH_ROUNDING_M;
    double hub_m[3];
    body_to_site(linkage, linkage->hub_body_m[wheel], hub_m);
    const double under_m[3] = {hub_m[0], hub_m[1], hub_m[2] + vehicle->wheel_radius_m};
    if (support->hub_z_m != NULL)
    {
        *contact = (contact_t){
            support->hub_z_m[wheel] - hub_m[2], {under_m[0], under_m[1], under_m[2]}, 0.0, 0.0};
    }
    else if (!is_inside(support, hub_m[0], hub_m[1], reach_m))
    {
        contact->gap_m = NAN;
    }
    else if (vehicle->wheel_kind == SIM_WHEEL_POINT)
    {
        point_contact(support, under_m, contact);
    }
    else
    {
        rolling_contact(support, vehicle, linkage, hub_m, contact);
    }
}

void known_contact(const support_t *support,
                   const sim_vehicle_t *vehicle,
                   const linkage_t *linkage,
                   int wheel,
                   const double *point_m,
                   contact_t *contact)
{
    if (!is_inside(support, point_m[0], point_m[1], 0.0))
    {
        contact->gap_m = NAN;
        return;
    }
    point_contact(support, point_m, contact);
    if (vehicle->wheel_kind != SIM_WHEEL_POINT)
    {
        double body_m[3];
        double tangent[3];
        site_to_body(linkage, point_m, body_m);
        const double ahead_m = body_m[0] - linkage->hub_body_m[wheel][0];
        const double down_m = body_m[2] - linkage->hub_body_m[wheel][2];
        for (int axis = 0; axis < 3; axis++)
        {
            tangent[axis] = (down_m * linkage->ex[axis]) - (ahead_m * linkage->ez[axis]);
        }
        make_stationary(tangent, contact);
    }
}
