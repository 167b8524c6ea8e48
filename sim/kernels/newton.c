/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file newton.c
 * @brief Damped Newton iteration on the six vertical gaps.
 */
#include "newton.h"

#include <math.h>

#define HALVINGS_MAX 6
#define STEP_ANGLE_MAX_RAD 0.3
#define PIVOT_MIN 1e-9

static void evaluate(const problem_t *problem, iterate_t *iterate)
{
    linkage_set(problem->vehicle, &problem->place, iterate->q, &iterate->linkage);
    iterate->square_sum = 0.0;
    iterate->residual_m = 0.0;
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        contact_t *contact = &iterate->contact[wheel];
        wheel_contact(&problem->support, problem->vehicle, &iterate->linkage, wheel, contact);
        iterate->square_sum += contact->gap_m * contact->gap_m;
        iterate->residual_m = fmax(iterate->residual_m, fabs(contact->gap_m));
    }
    if (isnan(iterate->square_sum))
    {
        iterate->residual_m = NAN;
    }
}

/* row of the Jacobian: d(gap)/dq = slope . d(point xy) - d(point z) */
static void jacobian_row(
    const place_t *place, const iterate_t *iterate, int wheel, double slope_weight, double *row)
{
    const linkage_t *linkage = &iterate->linkage;
    const contact_t *contact = &iterate->contact[wheel];
    const double arm[3] = {contact->point_m[0] - linkage->origin_m[0],
                           contact->point_m[1] - linkage->origin_m[1],
                           contact->point_m[2] - linkage->origin_m[2]};
    const double g[3] = {slope_weight * contact->slope_north, slope_weight * contact->slope_east,
                         -1.0};
    const double *ex = linkage->ex;
    const double gx = dot(g, ex);
    const double gz = dot(g, linkage->ez);
    row[Q_Z] = g[2];
    /* roll turns about the body x axis, pitch about the horizontal axis right of the heading */
    row[Q_ROLL] = (g[0] * ((ex[1] * arm[2]) - (ex[2] * arm[1]))) +
                  (g[1] * ((ex[2] * arm[0]) - (ex[0] * arm[2]))) +
                  (g[2] * ((ex[0] * arm[1]) - (ex[1] * arm[0])));
    row[Q_PITCH] = (g[0] * place->cos_yaw * arm[2]) + (g[1] * place->sin_yaw * arm[2]) -
                   (g[2] * ((place->sin_yaw * arm[1]) + (place->cos_yaw * arm[0])));
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
        if (!(fabs(a[pivot][k]) > PIVOT_MIN))
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

int newton_step(const place_t *place, const iterate_t *iterate, double slope_weight, double *step)
{
    double jacobian[UNKNOWN_COUNT][UNKNOWN_COUNT];
    for (int wheel = 0; wheel < SIM_WHEEL_COUNT; wheel++)
    {
        jacobian_row(place, iterate, wheel, slope_weight, jacobian[wheel]);
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
        if (!newton_step(&problem->place, iterate, slope_weight[attempt], step))
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

int32_t iterate_to_rest(const problem_t *problem, int first_weight, iterate_t *iterate)
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
