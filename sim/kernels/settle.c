/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file settle.c
 * @brief Settling of the rocker-bogie: where the iteration starts, and what it leaves.
 */
#include <math.h>
#include <stddef.h>

#include "margins.h"
#include "newton.h"
#include "sim_kernels.h"

#define RESTARTS 24
#define RESTART_BEND_RAD 0.1
/* ground under a wheel that moved further is not foretold from where the wheel was */
#define FORETOLD_SHIFT_MAX_M 0.05

/* ------------------------------------------------------------------ where to start */

/* least-squares plane z = p0 + p1 x + p2 y through six points of the body frame */
static void fit_plane(double point_m[SIM_WHEEL_COUNT][3], double *plane)
{
    double mean[3] = {0.0, 0.0, 0.0};
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            mean[axis] += point_m[wheel][axis] / (double) SIM_WHEEL_COUNT;
        }
    }
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    double xz = 0.0;
    double yz = 0.0;
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        const double x = point_m[wheel][0] - mean[0];
        const double y = point_m[wheel][1] - mean[1];
        const double z = point_m[wheel][2] - mean[2];
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

/* the plane through the ground under the nominal hubs, or NaN off the map */
static void start_cold(const problem_t *problem, double *q)
{
    static const double level[UNKNOWN_COUNT] = {0.0};
    const support_t *support = &problem->support;
    linkage_t linkage;
    double under_m[SIM_WHEEL_COUNT][3];
    double plane[3];
    linkage_set(problem->vehicle, &problem->place, level, &linkage);
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        ground_t ground = {NAN, 0.0, 0.0};
        double site_m[3];
        body_to_site(&linkage, problem->vehicle->hub_m[wheel], site_m);
        if (is_inside(support, site_m[0], site_m[1], 0.0))
        {
            sample_ground(support, site_m[0], site_m[1], &ground);
        }
        site_m[2] = ground.z_m;
        site_to_body(&linkage, site_m, under_m[wheel]);
    }
    fit_plane(under_m, plane);
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

/*
 * How the posture changes as the guess moves to the place asked for: one Newton step on the ground
 * that its contacts touch and on its slopes there, without a search along the rims. 0 when the guess
 * says nothing about the ground or is too far.
 */
static int foretell(const problem_t *problem,
                    const sim_settled_t *guess,
                    const double *q,
                    double *step)
{
    const double pose[3] = {guess->x_m, guess->y_m, guess->yaw_rad};
    const double turn_rad = problem->place.yaw_rad - guess->yaw_rad;
    place_t place;
    iterate_t before;
    place_set(pose, &place);
    linkage_set(problem->vehicle, &place, q, &before.linkage);
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        contact_t *contact = &before.contact[wheel];
        const double *point_m = guess->contact_site_m[wheel];
        known_contact(&problem->support, problem->vehicle, &before.linkage, wheel, point_m,
                      contact);
        const double north_m =
            problem->place.north_m - place.north_m - (turn_rad * (point_m[1] - place.east_m));
        const double east_m =
            problem->place.east_m - place.east_m + (turn_rad * (point_m[0] - place.north_m));
        contact->gap_m += (contact->slope_north * north_m) + (contact->slope_east * east_m);
        if (!(hypot(north_m, east_m) <= FORETOLD_SHIFT_MAX_M))
        {
            return 0;
        }
    }
    return newton_step(&place, &before, 1.0, step);
}

static void start_warm(const problem_t *problem, const sim_settled_t *guess, double *q)
{
    double step[UNKNOWN_COUNT];
    q[Q_Z] = guess->z_m;
    q[Q_ROLL] = guess->roll_rad;
    q[Q_PITCH] = guess->pitch_rad;
    q[Q_ROCKER] = guess->rocker_rad;
    q[Q_BOGIE_LEFT] = guess->bogie_left_rad;
    q[Q_BOGIE_RIGHT] = guess->bogie_right_rad;
    if (foretell(problem, guess, q, step))
    {
        for (int i = 0; i < UNKNOWN_COUNT; i++)
        {
            q[i] += step[i];
        }
    }
}

/* ------------------------------------------------------------------ what is left */

static void fill_unsettled(const place_t *place, sim_settled_t *out)
{
    double *first = &out->x_m;
    double *last = &out->hub_site_m[SIM_WHEEL_COUNT - 1][2];
    for (double *value = first; value <= last; value++)
    {
        *value = NAN;
    }
    out->x_m = place->north_m;
    out->y_m = place->east_m;
    out->yaw_rad = place->yaw_rad;
    out->iterations = 0;
    out->converged = 0;
    out->on_map = 0;
    out->reserved = 0;
}

static void fill(const problem_t *problem,
                 const iterate_t *iterate,
                 int32_t iterations,
                 sim_settled_t *out)
{
    const sim_terrain_t *terrain = problem->support.terrain;
    const sim_vehicle_t *vehicle = problem->vehicle;
    const linkage_t *linkage = &iterate->linkage;
    fill_unsettled(&problem->place, out);
    if (isnan(iterate->residual_m))
    {
        return;
    }
    out->z_m = iterate->q[Q_Z];
    out->roll_rad = iterate->q[Q_ROLL];
    out->pitch_rad = iterate->q[Q_PITCH];
    out->rocker_rad = iterate->q[Q_ROCKER];
    out->bogie_left_rad = iterate->q[Q_BOGIE_LEFT];
    out->bogie_right_rad = iterate->q[Q_BOGIE_RIGHT];
    out->tilt_rad = acos(fmin(1.0, fmax(-1.0, linkage->ez[2])));
    out->residual_m = iterate->residual_m;
    out->iterations = iterations;
    out->converged = (iterate->residual_m <= vehicle->tolerance_m) ? 1 : 0;
    out->on_map = 1;
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            out->contact_site_m[wheel][axis] = iterate->contact[wheel].point_m[axis];
        }
        body_to_site(linkage, linkage->hub_body_m[wheel], out->hub_site_m[wheel]);
    }
    if (terrain != NULL)
    {
        out->clearance_m = clearance_of(terrain, vehicle, linkage);
        out->wheel_drop_m = wheel_drop_of(terrain, vehicle, linkage);
    }
}

/* ------------------------------------------------------------------ public functions */

static void settle(const problem_t *problem, const sim_settled_t *guess, sim_settled_t *out)
{
    iterate_t iterate;
    int32_t iterations = 0;
    iterate.residual_m = NAN;
    if (guess != NULL)
    {
        start_warm(problem, guess, iterate.q);
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
    fill(problem, &iterate, iterations, out);
}

void sim_settle(const sim_terrain_t *terrain,
                const sim_vehicle_t *vehicle,
                const double *pose,
                const sim_settled_t *guess,
                sim_settled_t *out)
{
    problem_t problem = {.vehicle = vehicle};
    support_set(terrain, NULL, &problem.support);
    place_set(pose, &problem.place);
    settle(&problem, guess, out);
}

void sim_settle_path(const sim_terrain_t *terrain,
                     const sim_vehicle_t *vehicle,
                     const double *poses,
                     int32_t count,
                     int32_t chained,
                     sim_settled_t *out)
{
    problem_t problem = {.vehicle = vehicle};
    support_set(terrain, NULL, &problem.support);
    for (int32_t i = 0; i < count; i++)
    {
        const int is_warm = (chained != 0) && (i > 0) && (out[i - 1].on_map != 0);
        place_set(&poses[(ptrdiff_t) 3 * i], &problem.place);
        settle(&problem, is_warm ? &out[i - 1] : NULL, &out[i]);
    }
}

void sim_settle_hubs(const sim_vehicle_t *vehicle,
                     const double *pose,
                     const double *hub_z_site_m,
                     sim_settled_t *out)
{
    problem_t problem = {.vehicle = vehicle};
    iterate_t iterate = {.q = {0.0}};
    support_set(NULL, hub_z_site_m, &problem.support);
    place_set(pose, &problem.place);
    iterate.q[Q_Z] = hub_z_site_m[1] + vehicle->wheel_radius_m;
    const int32_t iterations = iterate_to_rest(&problem, 0, &iterate);
    fill(&problem, &iterate, iterations, out);
}
