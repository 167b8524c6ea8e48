/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_vehicle.c
 * @brief The six-wheel rocker-bogie linkage with differential.
 */
#include "nav_vehicle.h"

#include <math.h>

#include "nav_math.h"

#define NEWTON_STEPS_MAX 8
#define RESIDUAL_MAX_M 1.0e-9
#define PIVOT_MIN 1.0e-9
#define WHEELS_PER_SIDE 3
#define FRONT 0U

/** A link seen from its pivot: forward and down. */
typedef struct
{
    double forward_m;
    double down_m;
} link_t;

/** Sine and cosine of the body's pitch and roll. */
typedef struct
{
    double sin_pitch;
    double cos_pitch;
    double sin_roll;
    double cos_roll;
} body_t;

static link_t turned_nose_down(double forward_m, double down_m, double angle_rad)
{
    const double s = nav_sin(angle_rad);
    const double c = nav_cos(angle_rad);
    const link_t link = {(forward_m * c) - (down_m * s), (forward_m * s) + (down_m * c)};
    return link;
}

/** Change of a point's height per radian that its link turns nose down. */
static double height_per_turn(const body_t *body, const link_t *arm)
{
    return -((body->sin_pitch * arm->down_m) + (body->cos_pitch * body->cos_roll * arm->forward_m));
}

void nav_vehicle_init(const nav_params_t *params, nav_vehicle_t *vehicle)
{
    const double x_m[WHEELS_PER_SIDE] = {params->front_x_m, params->middle_x_m, params->rear_x_m};
    const double y_m[WHEELS_PER_SIDE] = {params->front_y_m, params->middle_y_m, params->rear_y_m};

    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const uint32_t place = wheel % (uint32_t) WHEELS_PER_SIDE;
        const double side = (wheel < (uint32_t) WHEELS_PER_SIDE) ? -1.0 : 1.0;
        vehicle->hub_x_m[wheel] = x_m[place];
        vehicle->hub_y_m[wheel] = side * y_m[place];
    }
    vehicle->hub_height_m = params->wheel_radius_m;
    vehicle->rocker_pivot_x_m = params->rocker_pivot_x_m;
    vehicle->rocker_pivot_height_m = params->rocker_pivot_height_m;
    vehicle->bogie_pivot_x_m = params->bogie_pivot_x_m;
    vehicle->bogie_pivot_height_m = params->bogie_pivot_height_m;
}

/** Arms from the rocker pivot and, behind it, from the bogie pivot to a hub. */
typedef struct
{
    link_t on_rocker;
    link_t on_bogie; /* zero for the front wheel, which the rocker carries itself */
} arms_t;

static double rocker_sign(uint32_t side)
{
    return (side == 0U) ? 1.0 : -1.0;
}

static arms_t wheel_arms(const nav_vehicle_t *vehicle,
                         const double state[NAV_LINKAGE_STATES],
                         uint32_t wheel)
{
    const uint32_t side = wheel / (uint32_t) WHEELS_PER_SIDE;
    const double rocker = rocker_sign(side) * state[NAV_LINKAGE_ROCKER];
    const double bogie = rocker + state[(uint32_t) NAV_LINKAGE_BOGIE_LEFT + side];
    const double hub_x_m = vehicle->hub_x_m[wheel];
    arms_t arms = {{0.0, 0.0}, {0.0, 0.0}};

    if ((wheel % (uint32_t) WHEELS_PER_SIDE) == FRONT)
    {
        arms.on_rocker =
            turned_nose_down(hub_x_m - vehicle->rocker_pivot_x_m,
                             vehicle->rocker_pivot_height_m - vehicle->hub_height_m, rocker);
    }
    else
    {
        const link_t to_bogie = turned_nose_down(
            vehicle->bogie_pivot_x_m - vehicle->rocker_pivot_x_m,
            vehicle->rocker_pivot_height_m - vehicle->bogie_pivot_height_m, rocker);
        arms.on_bogie =
            turned_nose_down(hub_x_m - vehicle->bogie_pivot_x_m,
                             vehicle->bogie_pivot_height_m - vehicle->hub_height_m, bogie);
        arms.on_rocker.forward_m = to_bogie.forward_m + arms.on_bogie.forward_m;
        arms.on_rocker.down_m = to_bogie.down_m + arms.on_bogie.down_m;
    }
    return arms;
}

static body_t body_of(const double state[NAV_LINKAGE_STATES])
{
    const body_t body = {nav_sin(state[NAV_LINKAGE_PITCH]), nav_cos(state[NAV_LINKAGE_PITCH]),
                         nav_sin(state[NAV_LINKAGE_ROLL]), nav_cos(state[NAV_LINKAGE_ROLL])};
    return body;
}

void nav_vehicle_wheel_heights(const nav_vehicle_t *vehicle,
                               const double state[NAV_LINKAGE_STATES],
                               double height_m[NAV_WHEELS],
                               double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES])
{
    const body_t body = body_of(state);
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const uint32_t side = wheel / (uint32_t) WHEELS_PER_SIDE;
        const arms_t arms = wheel_arms(vehicle, state, wheel);
        const double x_m = vehicle->rocker_pivot_x_m + arms.on_rocker.forward_m;
        const double y_m = vehicle->hub_y_m[wheel];
        const double z_m = arms.on_rocker.down_m - vehicle->rocker_pivot_height_m;
        double *row = jacobian[wheel];

        height_m[wheel] = state[NAV_LINKAGE_HEIGHT] + (body.sin_pitch * x_m) -
                          (body.cos_pitch * body.sin_roll * y_m) -
                          (body.cos_pitch * body.cos_roll * z_m) - vehicle->hub_height_m;
        row[NAV_LINKAGE_HEIGHT] = 1.0;
        row[NAV_LINKAGE_ROLL] = body.cos_pitch * ((body.sin_roll * z_m) - (body.cos_roll * y_m));
        row[NAV_LINKAGE_PITCH] = (body.cos_pitch * x_m) +
                                 (body.sin_pitch * ((body.sin_roll * y_m) + (body.cos_roll * z_m)));
        row[NAV_LINKAGE_ROCKER] = rocker_sign(side) * height_per_turn(&body, &arms.on_rocker);
        row[NAV_LINKAGE_BOGIE_LEFT] = 0.0;
        row[NAV_LINKAGE_BOGIE_RIGHT] = 0.0;
        row[(uint32_t) NAV_LINKAGE_BOGIE_LEFT + side] = height_per_turn(&body, &arms.on_bogie);
    }
}

void nav_vehicle_wheel_places(const nav_vehicle_t *vehicle,
                              const double state[NAV_LINKAGE_STATES],
                              double forward_m[NAV_WHEELS],
                              double right_m[NAV_WHEELS])
{
    const body_t body = body_of(state);
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const arms_t arms = wheel_arms(vehicle, state, wheel);
        const double x_m = vehicle->rocker_pivot_x_m + arms.on_rocker.forward_m;
        const double y_m = vehicle->hub_y_m[wheel];
        const double z_m = arms.on_rocker.down_m - vehicle->rocker_pivot_height_m;
        forward_m[wheel] = (body.cos_pitch * x_m) +
                           (body.sin_pitch * ((body.sin_roll * y_m) + (body.cos_roll * z_m)));
        right_m[wheel] = (body.cos_roll * y_m) - (body.sin_roll * (z_m + vehicle->hub_height_m));
    }
}

static void swap_rows(double matrix[NAV_WHEELS][2 * NAV_WHEELS], uint32_t a, uint32_t b)
{
    for (uint32_t col = 0U; col < (2U * (uint32_t) NAV_WHEELS); col++)
    {
        const double kept = matrix[a][col];
        matrix[a][col] = matrix[b][col];
        matrix[b][col] = kept;
    }
}

static uint32_t pivot_row(double matrix[NAV_WHEELS][2 * NAV_WHEELS], uint32_t col)
{
    uint32_t best = col;
    for (uint32_t row = col + 1U; row < (uint32_t) NAV_WHEELS; row++)
    {
        if (fabs(matrix[row][col]) > fabs(matrix[best][col]))
        {
            best = row;
        }
    }
    return best;
}

/** Gauss-Jordan elimination of one column. */
static void eliminate(double matrix[NAV_WHEELS][2 * NAV_WHEELS], uint32_t col)
{
    const double scale = 1.0 / matrix[col][col];
    for (uint32_t k = col; k < (2U * (uint32_t) NAV_WHEELS); k++)
    {
        matrix[col][k] *= scale;
    }
    for (uint32_t row = 0U; row < (uint32_t) NAV_WHEELS; row++)
    {
        const double factor = matrix[row][col];
        if (row != col)
        {
            for (uint32_t k = col; k < (2U * (uint32_t) NAV_WHEELS); k++)
            {
                matrix[row][k] -= factor * matrix[col][k];
            }
        }
    }
}

static bool invert(double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES],
                   double inverse[NAV_LINKAGE_STATES][NAV_WHEELS])
{
    double matrix[NAV_WHEELS][2 * NAV_WHEELS] = {{0.0}};
    bool is_regular = true;

    for (uint32_t row = 0U; row < (uint32_t) NAV_WHEELS; row++)
    {
        for (uint32_t col = 0U; col < (uint32_t) NAV_WHEELS; col++)
        {
            matrix[row][col] = jacobian[row][col];
        }
        matrix[row][(uint32_t) NAV_WHEELS + row] = 1.0;
    }
    for (uint32_t col = 0U; (col < (uint32_t) NAV_WHEELS) && is_regular; col++)
    {
        swap_rows(matrix, col, pivot_row(matrix, col));
        is_regular = fabs(matrix[col][col]) > PIVOT_MIN;
        if (is_regular)
        {
            eliminate(matrix, col);
        }
    }
    for (uint32_t row = 0U; row < (uint32_t) NAV_WHEELS; row++)
    {
        for (uint32_t col = 0U; col < (uint32_t) NAV_WHEELS; col++)
        {
            inverse[row][col] = matrix[row][(uint32_t) NAV_WHEELS + col];
        }
    }
    return is_regular;
}

/** One Newton step. Returns the residual before it. */
static double newton_step(const double wanted_m[NAV_WHEELS],
                          const double height_m[NAV_WHEELS],
                          double inverse[NAV_LINKAGE_STATES][NAV_WHEELS],
                          double state[NAV_LINKAGE_STATES])
{
    double residual_max_m = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const double residual_m = wanted_m[wheel] - height_m[wheel];
        residual_max_m = nav_max(residual_max_m, fabs(residual_m));
        for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
        {
            state[k] += inverse[k][wheel] * residual_m;
        }
    }
    return residual_max_m;
}

bool nav_vehicle_settle(const nav_vehicle_t *vehicle,
                        const double height_m[NAV_WHEELS],
                        double state[NAV_LINKAGE_STATES],
                        double inverse[NAV_LINKAGE_STATES][NAV_WHEELS])
{
    double reached_m[NAV_WHEELS];
    double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES];
    bool is_regular = true;
    bool is_done = false;

    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        state[k] = 0.0;
    }
    for (uint32_t step = 0U; (step < (uint32_t) NEWTON_STEPS_MAX) && is_regular && !is_done; step++)
    {
        nav_vehicle_wheel_heights(vehicle, state, reached_m, jacobian);
        is_regular = invert(jacobian, inverse);
        if (is_regular)
        {
            is_done = newton_step(height_m, reached_m, inverse, state) < RESIDUAL_MAX_M;
        }
    }
    return is_done;
}
