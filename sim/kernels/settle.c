/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file settle.c
 * @brief Rocker-bogie settling by damped Newton iteration.
 */
#include <math.h>
#include <stddef.h>

#include "sim_kernels.h"

/* ------------------------------------------------------------------ internal definitions */

#define UNKNOWN_COUNT 6
#define RIM_SAMPLES 25
#define RIM_STEPS_MAX 12
#define CYLINDER_DISCS 5
#define HALVINGS_MAX 6
#define SLOPE_WEIGHTS 3
#define RESTARTS 24
#define RESTART_BEND_RAD 0.1
#define STEP_ANGLE_MAX_RAD 0.3
/* the rim is searched to 85 degrees from straight down */
#define RIM_SINE_MAX 0.99619
/* the rim's nearest point is found to this height */
#define RIM_TOLERANCE_M 1e-6
/* local minima this close to the best sample are refined too: a kink may hide below a sample */
#define REFINE_MARGIN_M 0.01

enum
{
    Q_Z,
    Q_ROLL,
    Q_PITCH,
    Q_ROCKER,
    Q_BOGIE_LEFT,
    Q_BOGIE_RIGHT
};

/* what the wheels stand on: a terrain, or fixed hub heights when hub_z_m is not NULL */
typedef struct
{
    const sim_terrain_t *terrain;
    const sim_vehicle_t *vehicle;
    const double *hub_z_m;
    double pose[3];
    double cos_yaw;
    double sin_yaw;
    double inverse_resolution;
    double rim_sine[RIM_SAMPLES];
    double rim_cosine[RIM_SAMPLES];
} problem_t;

/* body axes in SITE (columns of R) and the joint kinematics of one iterate */
typedef struct
{
    double ex[3];
    double ey[3];
    double ez[3];
    double hub_body_m[SIM_WHEEL_COUNT][3];
    double d_rocker[SIM_WHEEL_COUNT][3];
    double d_bogie[SIM_WHEEL_COUNT][3];
} linkage_t;

/* one wheel's nearest rim point: the gap, the point, and the ground slope felt there */
typedef struct
{
    double gap_m;
    double point_m[3];
    double slope_north;
    double slope_east;
} contact_t;

/* everything known about one iterate; jacobian = slope_weight * ground + rigid */
typedef struct
{
    double q[UNKNOWN_COUNT];
    double square_sum;
    double residual_m;
    linkage_t linkage;
    contact_t contact[SIM_WHEEL_COUNT];
} iterate_t;

/* ground height and slopes in one bilinear cell */
typedef struct
{
    double z_m;
    double slope_north;
    double slope_east;
} ground_t;

static int is_inside(const problem_t *problem, double north_m, double east_m, double margin_m)
{
    const sim_terrain_t *terrain = problem->terrain;
    const double row = (north_m - terrain->north_min_m) * problem->inverse_resolution;
    const double col = (east_m - terrain->east_min_m) * problem->inverse_resolution;
    const double margin = margin_m * problem->inverse_resolution;
    /* written so that NaN is outside; short of the last node, so that a cell always follows */
    return (row - margin >= 0.0) && (row + margin < (double) (terrain->rows - 1)) &&
           (col - margin >= 0.0) && (col + margin < (double) (terrain->cols - 1));
}

/* the caller guarantees is_inside() */
static inline void sample_ground(const problem_t *problem,
                                 double north_m,
                                 double east_m,
                                 ground_t *ground)
{
    const sim_terrain_t *terrain = problem->terrain;
    const double scale = problem->inverse_resolution;
    const double u = (north_m - terrain->north_min_m) * scale;
    const double v = (east_m - terrain->east_min_m) * scale;
    const int32_t row = (int32_t) u;
    const int32_t col = (int32_t) v;
    const float *south = &terrain->z_site_m[((ptrdiff_t) row * terrain->cols) + col];
    const float *north = south + terrain->cols;
    const double fu = u - (double) row;
    const double fv = v - (double) col;
    const double z00 = (double) south[0];
    const double d_east = (double) south[1] - z00;
    const double d_north = (double) north[0] - z00;
    const double twist = ((double) north[1] - (double) north[0]) - d_east;
    ground->slope_north = (d_north + (twist * fv)) * scale;
    ground->slope_east = (d_east + (twist * fu)) * scale;
    ground->z_m = z00 + (d_east * fv) + (fu * (d_north + (twist * fv)));
}

/* ------------------------------------------------------------------ linkage */

/* turns (x, z) of a link by angle, positive nose-down, into out; out may alias */
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

static void set_linkage(const problem_t *problem, const double *q, linkage_t *linkage)
{
    const double cr = cos(q[Q_ROLL]);
    const double sr = sin(q[Q_ROLL]);
    const double cp = cos(q[Q_PITCH]);
    const double sp = sin(q[Q_PITCH]);
    const double cy = problem->cos_yaw;
    const double sy = problem->sin_yaw;
    linkage->ex[0] = cy * cp;
    linkage->ex[1] = sy * cp;
    linkage->ex[2] = -sp;
    linkage->ey[0] = (cy * sp * sr) - (sy * cr);
    linkage->ey[1] = (sy * sp * sr) + (cy * cr);
    linkage->ey[2] = cp * sr;
    linkage->ez[0] = (cy * sp * cr) + (sy * sr);
    linkage->ez[1] = (sy * sp * cr) - (cy * sr);
    linkage->ez[2] = cp * cr;
    link_side(problem->vehicle, 0, q[Q_ROCKER], q[Q_BOGIE_LEFT], 1.0, linkage);
    link_side(problem->vehicle, 1, -q[Q_ROCKER], q[Q_BOGIE_RIGHT], -1.0, linkage);
}

static void body_to_site(const problem_t *problem,
                         const iterate_t *iterate,
                         const double *body,
                         double *site)
{
    const linkage_t *linkage = &iterate->linkage;
    const double origin[3] = {problem->pose[0], problem->pose[1], iterate->q[Q_Z]};
    for (int axis = 0; axis < 3; axis++)
    {
        site[axis] = origin[axis] + (linkage->ex[axis] * body[0]) + (linkage->ey[axis] * body[1]) +
                     (linkage->ez[axis] * body[2]);
    }
}

/* ------------------------------------------------------------------ wheel contact */

/* rim point at sine s from straight down: centre + r (c ez + s ex) */
static inline void rim_point(const linkage_t *linkage,
                             const double *centre,
                             double radius_m,
                             double sine,
                             double cosine,
                             double *point)
{
    for (int axis = 0; axis < 3; axis++)
    {
        point[axis] =
            centre[axis] + (radius_m * ((cosine * linkage->ez[axis]) + (sine * linkage->ex[axis])));
    }
}

/* one evaluated place on the rim, at h = tan(angle / 2) from straight down */
typedef struct
{
    double h;
    double slope;
    double tangent_north;
    double tangent_east;
    double tangent_down;
    contact_t contact;
} rim_t;

/* gap at h and its slope, the derivative by h; in h the rim needs neither root nor sine */
static inline void evaluate_rim(
    const problem_t *problem, const linkage_t *linkage, const double *centre, double h, rim_t *rim)
{
    const double radius_m = problem->vehicle->wheel_radius_m;
    const double inverse = 1.0 / (1.0 + (h * h));
    const double cosine = (2.0 * inverse) - 1.0;
    const double sine = 2.0 * h * inverse;
    const double rate = 2.0 * radius_m * inverse;
    contact_t *contact = &rim->contact;
    ground_t ground;
    rim_point(linkage, centre, radius_m, sine, cosine, contact->point_m);
    sample_ground(problem, contact->point_m[0], contact->point_m[1], &ground);
    contact->gap_m = ground.z_m - contact->point_m[2];
    contact->slope_north = ground.slope_north;
    contact->slope_east = ground.slope_east;
    rim->h = h;
    rim->tangent_north = rate * ((cosine * linkage->ex[0]) - (sine * linkage->ez[0]));
    rim->tangent_east = rate * ((cosine * linkage->ex[1]) - (sine * linkage->ez[1]));
    rim->tangent_down = rate * ((cosine * linkage->ex[2]) - (sine * linkage->ez[2]));
    rim->slope = (ground.slope_north * rim->tangent_north) +
                 (ground.slope_east * rim->tangent_east) - rim->tangent_down;
}

/*
 * At the nearest rim point the gap is stationary along the rim. Where that point sits on a crease
 * between two cells neither cell's slope says so: give the slope along the rim the tangent's value.
 */
static void make_stationary(rim_t *rim)
{
    const double length =
        (rim->tangent_north * rim->tangent_north) + (rim->tangent_east * rim->tangent_east);
    rim->contact.slope_north -= rim->slope * rim->tangent_north / length;
    rim->contact.slope_east -= rim->slope * rim->tangent_east / length;
}

/*
 * Refines a bracketed minimum. The end tangents cross below a convex gap: their crossing bounds the
 * error and is the next place to look where the ground has a crease; where it is smooth the zero of
 * the interpolated slope is. The two alternate.
 */
static void refine_rim(const problem_t *problem,
                       const linkage_t *linkage,
                       const double *centre,
                       double low_h,
                       double high_h,
                       contact_t *best)
{
    rim_t low;
    rim_t high;
    rim_t middle;
    evaluate_rim(problem, linkage, centre, low_h, &low);
    evaluate_rim(problem, linkage, centre, high_h, &high);
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
        const double inside = fmin(fmax(advance, 0.02 * span), 0.98 * span);
        evaluate_rim(problem, linkage, centre, low.h + inside, &middle);
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
        make_stationary(&nearest);
        *best = nearest.contact;
    }
}

static double half_tangent(const problem_t *problem, int sample)
{
    return problem->rim_sine[sample] / (1.0 + problem->rim_cosine[sample]);
}

/* gaps of the sampled rim into gap[]; returns the least, NaN where there is no ground */
static double sample_rim(const problem_t *problem,
                         const linkage_t *linkage,
                         const double *centre,
                         double *gap)
{
    const sim_terrain_t *terrain = problem->terrain;
    const double radius_m = problem->vehicle->wheel_radius_m;
    /* the rim in node units, the same affine map for all samples */
    const double scale = problem->inverse_resolution;
    const double u_centre = (centre[0] - terrain->north_min_m) * scale;
    const double v_centre = (centre[1] - terrain->east_min_m) * scale;
    const double u_down = linkage->ez[0] * radius_m * scale;
    const double v_down = linkage->ez[1] * radius_m * scale;
    const double u_ahead = linkage->ex[0] * radius_m * scale;
    const double v_ahead = linkage->ex[1] * radius_m * scale;
    const double z_down = linkage->ez[2] * radius_m;
    const double z_ahead = linkage->ex[2] * radius_m;
    double sum = 0.0;
    double least = INFINITY;
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const double sine = problem->rim_sine[sample];
        const double cosine = problem->rim_cosine[sample];
        const double u = u_centre + (cosine * u_down) + (sine * u_ahead);
        const double v = v_centre + (cosine * v_down) + (sine * v_ahead);
        const int32_t row = (int32_t) u;
        const int32_t col = (int32_t) v;
        const float *south = &terrain->z_site_m[((ptrdiff_t) row * terrain->cols) + col];
        const float *north = south + terrain->cols;
        const double fu = u - (double) row;
        const double fv = v - (double) col;
        const double z_south = (double) south[0] + (fv * ((double) south[1] - (double) south[0]));
        const double z_north = (double) north[0] + (fv * ((double) north[1] - (double) north[0]));
        const double z_rim = centre[2] + (cosine * z_down) + (sine * z_ahead);
        gap[sample] = z_south + (fu * (z_north - z_south)) - z_rim;
        sum += gap[sample];
        least = (gap[sample] < least) ? gap[sample] : least;
    }
    return isnan(sum) ? (double) NAN : least;
}

/* nearest point of one disc: sampled along the rim, then every promising minimum refined */
static void disc_contact(const problem_t *problem,
                         const linkage_t *linkage,
                         const double *centre,
                         contact_t *best)
{
    double gap[RIM_SAMPLES];
    const double least = sample_rim(problem, linkage, centre, gap);
    if (isnan(least))
    {
        best->gap_m = NAN;
        return;
    }
    const double limit = ((least < best->gap_m) ? least : best->gap_m) + REFINE_MARGIN_M;
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const int before = (sample > 0) ? sample - 1 : 0;
        const int after = (sample < RIM_SAMPLES - 1) ? sample + 1 : RIM_SAMPLES - 1;
        if ((gap[sample] <= limit) && (gap[sample] <= gap[before]) && (gap[sample] <= gap[after]))
        {
            refine_rim(problem, linkage, centre, half_tangent(problem, before),
                       half_tangent(problem, after), best);
        }
    }
}

static void point_contact(const problem_t *problem, const double *hub, contact_t *contact)
{
    ground_t ground = {0.0, 0.0, 0.0};
    contact->point_m[0] = hub[0];
    contact->point_m[1] = hub[1];
    contact->point_m[2] = hub[2] + problem->vehicle->wheel_radius_m;
    if (problem->terrain != NULL)
    {
        sample_ground(problem, hub[0], hub[1], &ground);
    }
    contact->gap_m = ground.z_m - contact->point_m[2];
    contact->slope_north = ground.slope_north;
    contact->slope_east = ground.slope_east;
}

static void wheel_contact(const problem_t *problem,
                          const iterate_t *iterate,
                          int wheel,
                          contact_t *contact)
{
    const sim_vehicle_t *vehicle = problem->vehicle;
    const linkage_t *linkage = &iterate->linkage;
    const double reach_m = vehicle->wheel_radius_m + (0.5 * vehicle->wheel_width_m);
    double hub[3];
    body_to_site(problem, iterate, linkage->hub_body_m[wheel], hub);
    contact->gap_m = INFINITY;
    if (problem->hub_z_m != NULL)
    {
        point_contact(problem, hub, contact);
        contact->gap_m = problem->hub_z_m[wheel] - hub[2];
    }
    else if (!is_inside(problem, hub[0], hub[1], reach_m))
    {
        contact->gap_m = NAN;
    }
    else if (vehicle->wheel_kind == SIM_WHEEL_POINT)
    {
        point_contact(problem, hub, contact);
    }
    else
    {
        const int discs = (vehicle->wheel_kind == SIM_WHEEL_CYLINDER) ? CYLINDER_DISCS : 1;
        for (int disc = 0; (disc < discs) && !isnan(contact->gap_m); disc++)
        {
            const double offset = (discs == 1) ? 0.0
                                               : vehicle->wheel_width_m *
                                                     (((double) disc / (double) (discs - 1)) - 0.5);
            const double centre[3] = {hub[0] + (offset * linkage->ey[0]),
                                      hub[1] + (offset * linkage->ey[1]),
                                      hub[2] + (offset * linkage->ey[2])};
            disc_contact(problem, linkage, centre, contact);
        }
    }
}

/* ------------------------------------------------------------------ Newton */

static void evaluate(const problem_t *problem, iterate_t *iterate)
{
    set_linkage(problem, iterate->q, &iterate->linkage);
    iterate->square_sum = 0.0;
    iterate->residual_m = 0.0;
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        wheel_contact(problem, iterate, wheel, &iterate->contact[wheel]);
        const double gap = iterate->contact[wheel].gap_m;
        iterate->square_sum += gap * gap;
        iterate->residual_m = (fabs(gap) > iterate->residual_m) ? fabs(gap) : iterate->residual_m;
    }
    if (isnan(iterate->square_sum))
    {
        iterate->residual_m = NAN;
    }
}

/* row of the Jacobian: d(gap)/dq = slope . d(point xy) - d(point z) */
static void jacobian_row(
    const problem_t *problem, const iterate_t *iterate, int wheel, double slope_weight, double *row)
{
    const linkage_t *linkage = &iterate->linkage;
    const contact_t *contact = &iterate->contact[wheel];
    const double arm[3] = {contact->point_m[0] - problem->pose[0],
                           contact->point_m[1] - problem->pose[1],
                           contact->point_m[2] - iterate->q[Q_Z]};
    const double g[3] = {slope_weight * contact->slope_north, slope_weight * contact->slope_east,
                         -1.0};
    const double *ex = linkage->ex;
    const double gx = (g[0] * ex[0]) + (g[1] * ex[1]) + (g[2] * ex[2]);
    const double gz = (g[0] * linkage->ez[0]) + (g[1] * linkage->ez[1]) + (g[2] * linkage->ez[2]);
    row[Q_Z] = g[2];
    /* roll turns about the body x axis, pitch about the horizontal axis right of the heading */
    row[Q_ROLL] = (g[0] * ((ex[1] * arm[2]) - (ex[2] * arm[1]))) +
                  (g[1] * ((ex[2] * arm[0]) - (ex[0] * arm[2]))) +
                  (g[2] * ((ex[0] * arm[1]) - (ex[1] * arm[0])));
    row[Q_PITCH] = (g[0] * problem->cos_yaw * arm[2]) + (g[1] * problem->sin_yaw * arm[2]) -
                   (g[2] * ((problem->sin_yaw * arm[1]) + (problem->cos_yaw * arm[0])));
    row[Q_ROCKER] = (gx * linkage->d_rocker[wheel][0]) + (gz * linkage->d_rocker[wheel][2]);
    const double bogie = (gx * linkage->d_bogie[wheel][0]) + (gz * linkage->d_bogie[wheel][2]);
    row[Q_BOGIE_LEFT] = (wheel < 3) ? bogie : 0.0;
    row[Q_BOGIE_RIGHT] = (wheel < 3) ? 0.0 : bogie;
}

/* solves a x = b in place by elimination with row pivoting; 0 when singular */
static int solve_linear(double a[UNKNOWN_COUNT][UNKNOWN_COUNT], double *b)
{
    for (int k = 0; k < UNKNOWN_COUNT; k++)
    {
        int pivot = k;
        for (int i = k + 1; i < UNKNOWN_COUNT; i++)
        {
            pivot = (fabs(a[i][k]) > fabs(a[pivot][k])) ? i : pivot;
        }
        if (!(fabs(a[pivot][k]) > 1e-9))
        {
            return 0;
        }
        for (int j = 0; (pivot != k) && (j < UNKNOWN_COUNT); j++)
        {
            const double swap = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = swap;
        }
        const double swap = b[k];
        b[k] = b[pivot];
        b[pivot] = swap;
        for (int i = k + 1; i < UNKNOWN_COUNT; i++)
        {
            const double factor = a[i][k] / a[k][k];
            for (int j = k; j < UNKNOWN_COUNT; j++)
            {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for (int i = UNKNOWN_COUNT - 1; i >= 0; i--)
    {
        for (int j = i + 1; j < UNKNOWN_COUNT; j++)
        {
            b[i] -= a[i][j] * b[j];
        }
        b[i] /= a[i][i];
    }
    return 1;
}

/* Newton step; slope_weight 0 ignores how the ground changes with the wheel's horizontal shift */
static int newton_step(const problem_t *problem,
                       const iterate_t *iterate,
                       double slope_weight,
                       double *step)
{
    double jacobian[UNKNOWN_COUNT][UNKNOWN_COUNT];
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        jacobian_row(problem, iterate, wheel, slope_weight, jacobian[wheel]);
        step[wheel] = -iterate->contact[wheel].gap_m;
    }
    if (!solve_linear(jacobian, step))
    {
        return 0;
    }
    double angle_max = 0.0;
    for (int i = Q_ROLL; i < UNKNOWN_COUNT; i++)
    {
        angle_max = (fabs(step[i]) > angle_max) ? fabs(step[i]) : angle_max;
    }
    const double scale = (angle_max > STEP_ANGLE_MAX_RAD) ? STEP_ANGLE_MAX_RAD / angle_max : 1.0;
    for (int i = 0; i < UNKNOWN_COUNT; i++)
    {
        step[i] *= scale;
    }
    return isfinite(step[Q_Z]) && isfinite(angle_max);
}

/* one improving step: the full slope first, then damped slopes, halving each; 0 when stalled */
static int improve(const problem_t *problem, int first_weight, iterate_t *iterate)
{
    static const double slope_weight[SLOPE_WEIGHTS] = {1.0, 0.5, 0.0};
    for (int attempt = first_weight; attempt < SLOPE_WEIGHTS; attempt++)
    {
        double step[UNKNOWN_COUNT];
        if (!newton_step(problem, iterate, slope_weight[attempt], step))
        {
            continue;
        }
        double fraction = 1.0;
        for (int halving = 0; halving <= HALVINGS_MAX; halving++)
        {
            iterate_t trial;
            for (int i = 0; i < UNKNOWN_COUNT; i++)
            {
                trial.q[i] = iterate->q[i] + (fraction * step[i]);
            }
            evaluate(problem, &trial);
            /* NaN never improves */
            if (trial.square_sum < iterate->square_sum * (1.0 - (0.01 * fraction)))
            {
                *iterate = trial;
                return 1;
            }
            fraction *= 0.5;
        }
    }
    return 0;
}

static int32_t iterate_to_rest(const problem_t *problem, int first_weight, iterate_t *iterate)
{
    int32_t count = 0;
    evaluate(problem, iterate);
    while ((count < problem->vehicle->iterations_max) &&
           (iterate->residual_m > problem->vehicle->tolerance_m) &&
           improve(problem, first_weight, iterate))
    {
        count++;
    }
    return count;
}

/* ------------------------------------------------------------------ truth */

/* rover-frame coordinates of a SITE point */
static void site_to_body(const problem_t *problem,
                         const iterate_t *iterate,
                         const double *site,
                         double *body)
{
    const linkage_t *linkage = &iterate->linkage;
    const double d[3] = {site[0] - problem->pose[0], site[1] - problem->pose[1],
                         site[2] - iterate->q[Q_Z]};
    body[0] = (linkage->ex[0] * d[0]) + (linkage->ex[1] * d[1]) + (linkage->ex[2] * d[2]);
    body[1] = (linkage->ey[0] * d[0]) + (linkage->ey[1] * d[1]) + (linkage->ey[2] * d[2]);
    body[2] = (linkage->ez[0] * d[0]) + (linkage->ez[1] * d[1]) + (linkage->ez[2] * d[2]);
}

/* a body-frame box in x and y, and the SITE unit vector along which depth is measured */
typedef struct
{
    double x_min;
    double x_max;
    double y_min;
    double y_max;
    double down[3];
} box_t;

typedef struct
{
    double low;
    double high;
} range_t;

static inline int is_in_box(const box_t *box, double x, double y)
{
    return (x >= box->x_min) && (x <= box->x_max) && (y >= box->y_min) && (y <= box->y_max);
}

static int32_t clamp_index(double value, int32_t count)
{
    return (value < 0.0) ? 0 : ((value > (double) (count - 1)) ? count - 1 : (int32_t) value);
}

/* node index ranges that can hold nodes of the box whose body z lies in [z_min, z_max] */
static void box_nodes(const problem_t *problem,
                      const iterate_t *iterate,
                      const box_t *box,
                      const range_t *z_body,
                      int32_t range[4])
{
    const sim_terrain_t *terrain = problem->terrain;
    const linkage_t *linkage = &iterate->linkage;
    const double scale = problem->inverse_resolution;
    const double middle_body[3] = {0.5 * (box->x_min + box->x_max), 0.5 * (box->y_min + box->y_max),
                                   0.5 * (z_body->low + z_body->high)};
    const double first_m[2] = {terrain->north_min_m, terrain->east_min_m};
    const int32_t count[2] = {terrain->rows, terrain->cols};
    double middle[3];
    body_to_site(problem, iterate, middle_body, middle);
    for (int axis = 0; axis < 2; axis++)
    {
        const double reach = (fabs(linkage->ex[axis]) * (box->x_max - middle_body[0])) +
                             (fabs(linkage->ey[axis]) * (box->y_max - middle_body[1])) +
                             (fabs(linkage->ez[axis]) * (z_body->high - middle_body[2]));
        const double node = (middle[axis] - first_m[axis]) * scale;
        /* rounded up and down; below zero the clamp decides */
        range[2 * axis] = clamp_index(node - (reach * scale) + 0.999999, count[axis]);
        range[(2 * axis) + 1] = clamp_index(node + (reach * scale), count[axis]);
    }
}

/*
 * Lowest and highest depth under the rover origin over the terrain nodes inside the box; NaN when a
 * node without ground lies in it, taken at the height of the origin.
 */
static range_t span_in_box(const problem_t *problem,
                           const iterate_t *iterate,
                           const box_t *box,
                           const range_t *z_body)
{
    const sim_terrain_t *terrain = problem->terrain;
    const linkage_t *linkage = &iterate->linkage;
    range_t span = {INFINITY, -INFINITY};
    int has_hole = 0;
    int32_t range[4];
    box_nodes(problem, iterate, box, z_body, range);
    const double east_m = terrain->east_min_m - problem->pose[1];
    for (int32_t row = range[0]; row <= range[1]; row++)
    {
        const float *z_site_m = &terrain->z_site_m[(ptrdiff_t) row * terrain->cols];
        const double north_m =
            terrain->north_min_m + ((double) row * terrain->resolution_m) - problem->pose[0];
        const double x_row = linkage->ex[0] * north_m;
        const double y_row = linkage->ey[0] * north_m;
        const double depth_row = box->down[0] * north_m;
        for (int32_t col = range[2]; col <= range[3]; col++)
        {
            const double east = east_m + ((double) col * terrain->resolution_m);
            const double down = (double) z_site_m[col] - iterate->q[Q_Z];
            const double x = x_row + (linkage->ex[1] * east) + (linkage->ex[2] * down);
            const double y = y_row + (linkage->ey[1] * east) + (linkage->ey[2] * down);
            if (is_in_box(box, x, y))
            {
                const double depth = depth_row + (box->down[1] * east) + (box->down[2] * down);
                span.low = (depth < span.low) ? depth : span.low;
                span.high = (depth > span.high) ? depth : span.high;
            }
            else if (isnan(down))
            {
                has_hole |= is_in_box(box, x_row + (linkage->ex[1] * east),
                                      y_row + (linkage->ey[1] * east));
            }
        }
    }
    if (has_hole)
    {
        span.low = NAN;
        span.high = NAN;
    }
    return span;
}

/* least-squares plane body z = p0 + p1 x + p2 y through the six contacts */
static void contact_plane(const problem_t *problem, const iterate_t *iterate, double *plane)
{
    double body[SIM_WHEEL_COUNT][3];
    double mean[3] = {0.0, 0.0, 0.0};
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        site_to_body(problem, iterate, iterate->contact[wheel].point_m, body[wheel]);
        for (int axis = 0; axis < 3; axis++)
        {
            mean[axis] += body[wheel][axis] / (double) SIM_WHEEL_COUNT;
        }
    }
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    double xz = 0.0;
    double yz = 0.0;
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        const double x = body[wheel][0] - mean[0];
        const double y = body[wheel][1] - mean[1];
        const double z = body[wheel][2] - mean[2];
        xx += x * x;
        xy += x * y;
        yy += y * y;
        xz += x * z;
        yz += y * z;
    }
    const double determinant = (xx * yy) - (xy * xy);
    plane[1] = ((xz * yy) - (yz * xy)) / determinant;
    plane[2] = ((yz * xx) - (xz * xy)) / determinant;
    plane[0] = mean[2] - (plane[1] * mean[0]) - (plane[2] * mean[1]);
}

/* unit vector down across the slope of the ground at the pose, NaN where there is none */
static void ground_normal(const problem_t *problem, double *down)
{
    const sim_terrain_t *terrain = problem->terrain;
    const double row = (problem->pose[0] - terrain->slope_north_min_m) / terrain->slope_cell_m;
    const double col = (problem->pose[1] - terrain->slope_east_min_m) / terrain->slope_cell_m;
    double gradient[2] = {NAN, NAN};
    if ((terrain->slope != NULL) && (row >= 0.0) && (col >= 0.0) &&
        (row < (double) terrain->slope_rows) && (col < (double) terrain->slope_cols))
    {
        const ptrdiff_t cell = ((ptrdiff_t) row * terrain->slope_cols) + (ptrdiff_t) col;
        gradient[0] = (double) terrain->slope[2 * cell];
        gradient[1] = (double) terrain->slope[(2 * cell) + 1];
    }
    const double norm = sqrt(1.0 + (gradient[0] * gradient[0]) + (gradient[1] * gradient[1]));
    down[0] = -gradient[0] / norm;
    down[1] = -gradient[1] / norm;
    down[2] = 1.0 / norm;
}

static double clearance_m(const problem_t *problem, const iterate_t *iterate)
{
    const sim_vehicle_t *vehicle = problem->vehicle;
    /* ground further than this from the frame's origin plane cannot be under a standing rover */
    const range_t z_body = {vehicle->belly_z_m - 1.0, 0.7};
    const double *ez = iterate->linkage.ez;
    const box_t belly = {vehicle->belly_rear_m,
                         vehicle->belly_front_m,
                         -vehicle->belly_half_width_m,
                         vehicle->belly_half_width_m,
                         {ez[0], ez[1], ez[2]}};
    return span_in_box(problem, iterate, &belly, &z_body).low - vehicle->belly_z_m;
}

static double wheel_drop_m(const problem_t *problem, const iterate_t *iterate)
{
    const double half_length = problem->vehicle->wheel_radius_m;
    const double half_width = 0.5 * problem->vehicle->wheel_width_m;
    double down[3];
    ground_normal(problem, down);
    double largest = 0.0 * down[2]; /* NaN without a slope */
    for (int wheel = 0; (wheel < SIM_WHEEL_COUNT) && !isnan(largest); wheel++)
    {
        const double *hub = iterate->linkage.hub_body_m[wheel];
        const range_t z_wheel = {hub[2] - 0.4, hub[2] + 0.9};
        const box_t box = {hub[0] - half_length,
                           hub[0] + half_length,
                           hub[1] - half_width,
                           hub[1] + half_width,
                           {down[0], down[1], down[2]}};
        const range_t span = span_in_box(problem, iterate, &box, &z_wheel);
        /* a box between coarse nodes holds none and has no drop; one with a hole has no known one */
        const double drop = (span.high < span.low) ? 0.0 : span.high - span.low;
        largest = ((drop > largest) || isnan(drop)) ? drop : largest;
    }
    return largest;
}

static void fill_unsettled(const problem_t *problem, sim_settled_t *out)
{
    double *first = &out->x_m;
    double *last = &out->hub_site_m[SIM_WHEEL_COUNT - 1][2];
    for (double *value = first; value <= last; value++)
    {
        *value = NAN;
    }
    out->x_m = problem->pose[0];
    out->y_m = problem->pose[1];
    out->yaw_rad = problem->pose[2];
    out->iterations = 0;
    out->converged = 0;
    out->on_map = 0;
    out->reserved = 0;
}

static void fill_settled(const problem_t *problem,
                         const iterate_t *iterate,
                         int32_t iterations,
                         sim_settled_t *out)
{
    fill_unsettled(problem, out);
    out->z_m = iterate->q[Q_Z];
    out->roll_rad = iterate->q[Q_ROLL];
    out->pitch_rad = iterate->q[Q_PITCH];
    out->rocker_rad = iterate->q[Q_ROCKER];
    out->bogie_left_rad = iterate->q[Q_BOGIE_LEFT];
    out->bogie_right_rad = iterate->q[Q_BOGIE_RIGHT];
    out->tilt_rad = acos(fmin(1.0, fmax(-1.0, iterate->linkage.ez[2])));
    out->residual_m = iterate->residual_m;
    out->iterations = iterations;
    out->converged = (iterate->residual_m <= problem->vehicle->tolerance_m) ? 1 : 0;
    out->on_map = 1;
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            out->contact_site_m[wheel][axis] = iterate->contact[wheel].point_m[axis];
        }
        body_to_site(problem, iterate, iterate->linkage.hub_body_m[wheel], out->hub_site_m[wheel]);
    }
    if (problem->terrain != NULL)
    {
        out->clearance_m = clearance_m(problem, iterate);
        out->wheel_drop_m = wheel_drop_m(problem, iterate);
    }
}

/* ------------------------------------------------------------------ public functions */

static void set_problem(const sim_terrain_t *terrain,
                        const sim_vehicle_t *vehicle,
                        problem_t *problem)
{
    problem->terrain = terrain;
    problem->vehicle = vehicle;
    problem->hub_z_m = NULL;
    problem->inverse_resolution = (terrain != NULL) ? 1.0 / terrain->resolution_m : 0.0;
    for (int sample = 0; sample < RIM_SAMPLES; sample++)
    {
        const double part =
            (double) ((2 * sample) - (RIM_SAMPLES - 1)) / (double) (RIM_SAMPLES - 1);
        const double sine = RIM_SINE_MAX * part;
        problem->rim_sine[sample] = sine;
        problem->rim_cosine[sample] = sqrt(1.0 - (sine * sine));
    }
}

static void set_pose(problem_t *problem, const double *pose)
{
    for (int i = 0; i < 3; i++)
    {
        problem->pose[i] = pose[i];
    }
    problem->cos_yaw = cos(pose[2]);
    problem->sin_yaw = sin(pose[2]);
}

/* the plane through the ground under the nominal hubs, or NaN off the map */
static void start_cold(const problem_t *problem, double *q)
{
    const sim_vehicle_t *vehicle = problem->vehicle;
    iterate_t level = {.q = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}};
    double plane[3];
    set_linkage(problem, level.q, &level.linkage);
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        ground_t ground = {NAN, 0.0, 0.0};
        double *point = level.contact[wheel].point_m;
        body_to_site(problem, &level, vehicle->hub_m[wheel], point);
        if (is_inside(problem, point[0], point[1], 0.0))
        {
            sample_ground(problem, point[0], point[1], &ground);
        }
        point[2] = ground.z_m;
    }
    contact_plane(problem, &level, plane);
    q[Q_Z] = plane[0];
    q[Q_PITCH] = -atan(plane[1]);
    q[Q_ROLL] = atan(plane[2] * cos(q[Q_PITCH]));
    q[Q_ROCKER] = 0.0;
    q[Q_BOGIE_LEFT] = 0.0;
    q[Q_BOGIE_RIGHT] = 0.0;
}

/* restarts after the plain one begin with bent joints, in all combinations of direction */
static void bend_joints(int restart, double *q)
{
    const double bend = (restart < SLOPE_WEIGHTS) ? 0.0 : RESTART_BEND_RAD;
    q[Q_ROCKER] = ((restart & 1) != 0) ? bend : -bend;
    q[Q_BOGIE_LEFT] = ((restart & 2) != 0) ? 2.0 * bend : -2.0 * bend;
    q[Q_BOGIE_RIGHT] = ((restart & 4) != 0) ? 2.0 * bend : -2.0 * bend;
}

static void start_warm(const sim_settled_t *guess, double *q)
{
    q[Q_Z] = guess->z_m;
    q[Q_ROLL] = guess->roll_rad;
    q[Q_PITCH] = guess->pitch_rad;
    q[Q_ROCKER] = guess->rocker_rad;
    q[Q_BOGIE_LEFT] = guess->bogie_left_rad;
    q[Q_BOGIE_RIGHT] = guess->bogie_right_rad;
}

static void settle_pose(const problem_t *problem, const sim_settled_t *guess, sim_settled_t *out)
{
    iterate_t iterate;
    int32_t iterations = 0;
    iterate.residual_m = NAN;
    if (guess != NULL)
    {
        start_warm(guess, iterate.q);
        iterations = iterate_to_rest(problem, 0, &iterate);
    }
    for (int restart = 0;
         (restart < RESTARTS) && !(iterate.residual_m <= problem->vehicle->tolerance_m); restart++)
    {
        iterate_t cold;
        start_cold(problem, cold.q);
        bend_joints(restart, cold.q);
        iterations += iterate_to_rest(problem, restart % SLOPE_WEIGHTS, &cold);
        if (!(iterate.residual_m <= cold.residual_m))
        {
            iterate = cold;
        }
    }
    if (isnan(iterate.residual_m))
    {
        fill_unsettled(problem, out);
    }
    else
    {
        fill_settled(problem, &iterate, iterations, out);
    }
}

void sim_settle(const sim_terrain_t *terrain,
                const sim_vehicle_t *vehicle,
                const double *pose,
                const sim_settled_t *guess,
                sim_settled_t *out)
{
    problem_t problem;
    set_problem(terrain, vehicle, &problem);
    set_pose(&problem, pose);
    settle_pose(&problem, guess, out);
}

void sim_settle_path(const sim_terrain_t *terrain,
                     const sim_vehicle_t *vehicle,
                     const double *poses,
                     int32_t count,
                     int32_t chained,
                     sim_settled_t *out)
{
    problem_t problem;
    set_problem(terrain, vehicle, &problem);
    for (int32_t i = 0; i < count; i++)
    {
        const int is_warm = (chained != 0) && (i > 0) && (out[i - 1].on_map != 0);
        set_pose(&problem, &poses[(ptrdiff_t) 3 * i]);
        settle_pose(&problem, is_warm ? &out[i - 1] : NULL, &out[i]);
    }
}

void sim_settle_hubs(const sim_vehicle_t *vehicle,
                     const double *pose,
                     const double *hub_z_site_m,
                     sim_settled_t *out)
{
    problem_t problem;
    iterate_t iterate;
    set_problem(NULL, vehicle, &problem);
    set_pose(&problem, pose);
    problem.hub_z_m = hub_z_site_m;
    for (int i = 0; i < UNKNOWN_COUNT; i++)
    {
        iterate.q[i] = 0.0;
    }
    iterate.q[Q_Z] = hub_z_site_m[1] + vehicle->wheel_radius_m;
    const int32_t iterations = iterate_to_rest(&problem, 0, &iterate);
    if (isnan(iterate.residual_m))
    {
        fill_unsettled(&problem, out);
    }
    else
    {
        fill_settled(&problem, &iterate, iterations, out);
    }
}
