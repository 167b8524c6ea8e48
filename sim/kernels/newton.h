/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file newton.h
 * @brief Damped Newton iteration on the six vertical gaps.
 */
#ifndef SIM_NEWTON_H
#define SIM_NEWTON_H

#include "contact.h"

/** How much of the ground's slope a step trusts: 1, 1/2, 0, each tried when the one before fails. */
#define SLOPE_WEIGHTS 3

/** What is to be solved: this vehicle at this place on this support. */
typedef struct
{
    support_t support;
    const sim_vehicle_t *vehicle;
    place_t place;
} problem_t;

/** A posture and all that is known about it; residual_m is the largest |gap|, NaN without ground. */
typedef struct
{
    double q[UNKNOWN_COUNT];
    double square_sum;
    double residual_m;
    linkage_t linkage;
    contact_t contact[SIM_WHEEL_COUNT];
} iterate_t;

/**
 * Full step that would close the gaps, from the linkage and the contacts of the iterate, no longer
 * than its angles allow; 0 when there is none.
 */
int newton_step(const place_t *place, const iterate_t *iterate, double slope_weight, double *step);

/**
 * Steps from iterate->q until the residual is in tolerance, no step improves it, or iterations_max;
 * first_weight is the slope weight to begin with. Returns the number of steps.
 */
int32_t iterate_to_rest(const problem_t *problem, int first_weight, iterate_t *iterate);

#endif
