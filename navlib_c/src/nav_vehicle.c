/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_vehicle.c
 * @brief The six-wheel rocker-bogie linkage with differential.
 */
#include "nav_vehicle.h"

#include <math.h>

#include "nav_math.h"
#include "nav_minmax.h"

#define STEPS_MAX 10U
#define NEAR_M 0.03 /* derivatives taken further away than this are taken anew */
#define PIVOT_MIN 1.0e-9
#define SIDES 2U
#define FRONT 0U
#define MIDDLE 1U
#define REAR 2U
#define WHEELS_PER_SIDE 3U
#define TURNS 3 /* roll, pitch, rocker: what is left of a side without height and bogie */

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

/** Arms from the rocker pivot and, behind it, from the bogie pivot to the hubs of one side. */
typedef struct
{
    link_t on_rocker[WHEELS_PER_SIDE];
    link_t
        on_bogie[WHEELS_PER_SIDE]; /* zero for the front wheel, which the rocker carries itself */
} arms_t;

static link_t turned_nose_down(double forward_m, double down_m, double sine, double cosine)
{
    const link_t link = {(forward_m * cosine) - (down_m * sine),
                         (forward_m * sine) + (down_m * cosine)};
    return link;
}

/** Change of a point's height per radian that its link turns nose down. */
static double height_per_turn(const body_t *body, const link_t *arm)
{
    return -((body->sin_pitch * arm->down_m) + (body->cos_pitch * body->cos_roll * arm->forward_m));
}

static double rocker_sign(uint32_t side)
{
    return (side == 0U) ? 1.0 : -1.0;
}

static arms_t arms_of(const nav_vehicle_t *vehicle,
                      const double state[NAV_LINKAGE_STATES],
                      uint32_t side)
{
    const double *hub_x_m = vehicle->hub_x_m; /* the same on both sides */
    const double rocker = rocker_sign(side) * state[NAV_LINKAGE_ROCKER];
    const double bogie = rocker + state[(uint32_t) NAV_LINKAGE_BOGIE_LEFT + side];
    arms_t arms;
    double sine = 0.0;
    double cosine = 1.0;

    nav_sincos(rocker, &sine, &cosine);
    const link_t to_bogie = turned_nose_down(
        vehicle->bogie_pivot_x_m - vehicle->rocker_pivot_x_m,
        vehicle->rocker_pivot_height_m - vehicle->bogie_pivot_height_m, sine, cosine);
    arms.on_rocker[FRONT] =
        turned_nose_down(hub_x_m[FRONT] - vehicle->rocker_pivot_x_m,
                         vehicle->rocker_pivot_height_m - vehicle->hub_height_m, sine, cosine);
    arms.on_bogie[FRONT].forward_m = 0.0;
    arms.on_bogie[FRONT].down_m = 0.0;
    nav_sincos(bogie, &sine, &cosine);
    for (uint32_t place = MIDDLE; place <= REAR; place++)
    {
        arms.on_bogie[place] =
            turned_nose_down(hub_x_m[place] - vehicle->bogie_pivot_x_m,
                             vehicle->bogie_pivot_height_m - vehicle->hub_height_m, sine, cosine);
        arms.on_rocker[place].forward_m = to_bogie.forward_m + arms.on_bogie[place].forward_m;
        arms.on_rocker[place].down_m = to_bogie.down_m + arms.on_bogie[place].down_m;
    }
    return arms;
}

static body_t body_of(const double state[NAV_LINKAGE_STATES])
{
    body_t body;
    nav_sincos(state[NAV_LINKAGE_PITCH], &body.sin_pitch, &body.cos_pitch);
    nav_sincos(state[NAV_LINKAGE_ROLL], &body.sin_roll, &body.cos_roll);
    return body;
}

void nav_vehicle_wheel_heights(const nav_vehicle_t *vehicle,
                               const double state[NAV_LINKAGE_STATES],
                               double height_m[NAV_WHEELS],
                               double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES])
{
    const body_t body = body_of(state);
    for (uint32_t side = 0U; side < SIDES; side++)
    {
        const arms_t arms = arms_of(vehicle, state, side);
        for (uint32_t place = 0U; place < WHEELS_PER_SIDE; place++)
        {
            const uint32_t wheel = (side * WHEELS_PER_SIDE) + place;
            const double x_m = vehicle->rocker_pivot_x_m + arms.on_rocker[place].forward_m;
            const double y_m = vehicle->hub_y_m[wheel];
            const double z_m = arms.on_rocker[place].down_m - vehicle->rocker_pivot_height_m;
            const double leaned_m = (body.sin_roll * y_m) + (body.cos_roll * z_m);
            double *row = jacobian[wheel];

            height_m[wheel] = ((state[NAV_LINKAGE_HEIGHT] + (body.sin_pitch * x_m)) -
                               (body.cos_pitch * leaned_m)) -
                              vehicle->hub_height_m;
            row[NAV_LINKAGE_HEIGHT] = 1.0;
            row[NAV_LINKAGE_ROLL] =
                body.cos_pitch * ((body.sin_roll * z_m) - (body.cos_roll * y_m));
            row[NAV_LINKAGE_PITCH] = (body.cos_pitch * x_m) + (body.sin_pitch * leaned_m);
            row[NAV_LINKAGE_ROCKER] =
                rocker_sign(side) * height_per_turn(&body, &arms.on_rocker[place]);
            row[NAV_LINKAGE_BOGIE_LEFT] = 0.0;
            row[NAV_LINKAGE_BOGIE_RIGHT] = 0.0;
            row[(uint32_t) NAV_LINKAGE_BOGIE_LEFT + side] =
                height_per_turn(&body, &arms.on_bogie[place]);
        }
    }
}

void nav_vehicle_wheel_places(const nav_vehicle_t *vehicle,
                              const double state[NAV_LINKAGE_STATES],
                              double forward_m[NAV_WHEELS],
                              double right_m[NAV_WHEELS])
{
    const body_t body = body_of(state);
    for (uint32_t side = 0U; side < SIDES; side++)
    {
        const arms_t arms = arms_of(vehicle, state, side);
        for (uint32_t place = 0U; place < WHEELS_PER_SIDE; place++)
        {
            const uint32_t wheel = (side * WHEELS_PER_SIDE) + place;
            const double x_m = vehicle->rocker_pivot_x_m + arms.on_rocker[place].forward_m;
            const double y_m = vehicle->hub_y_m[wheel];
            const double z_m = arms.on_rocker[place].down_m - vehicle->rocker_pivot_height_m;
            forward_m[wheel] = (body.cos_pitch * x_m) +
                               (body.sin_pitch * ((body.sin_roll * y_m) + (body.cos_roll * z_m)));
            right_m[wheel] =
                (body.cos_roll * y_m) - (body.sin_roll * (z_m + vehicle->hub_height_m));
        }
    }
}

/** How middle and rear wheel of a side share the load on their bogie's pivot: its height is
 * middle * middle height + rear * rear height, whatever the bogie's angle. */
typedef struct
{
    double middle;
    double rear;
    double per_bogie;    /* bogie angle per difference of the two heights */
    double turns[TURNS]; /* height of the pivot per roll, pitch, rocker */
} pivot_t;

static pivot_t pivot_of(double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES], uint32_t side)
{
    const double *middle = jacobian[(side * WHEELS_PER_SIDE) + MIDDLE];
    const double *rear = jacobian[(side * WHEELS_PER_SIDE) + REAR];
    const uint32_t bogie = (uint32_t) NAV_LINKAGE_BOGIE_LEFT + side;
    const double apart = middle[bogie] - rear[bogie];
    pivot_t pivot = {0.5, 0.5, 0.0, {0.0, 0.0, 0.0}};
    if (fabs(apart) > PIVOT_MIN)
    {
        pivot.per_bogie = 1.0 / apart;
        pivot.middle = -rear[bogie] * pivot.per_bogie;
        pivot.rear = middle[bogie] * pivot.per_bogie;
    }
    for (uint32_t k = 0U; k < (uint32_t) TURNS; k++)
    {
        const uint32_t state = (uint32_t) NAV_LINKAGE_ROLL + k;
        pivot.turns[k] = (pivot.middle * middle[state]) + (pivot.rear * rear[state]);
    }
    return pivot;
}

/** Inverse of a 3 x 3 matrix by its cofactors. @return false when it is singular */
static bool invert_turns(double m[TURNS][TURNS], double inverse[TURNS][TURNS])
{
    const double c0 = (m[1][1] * m[2][2]) - (m[1][2] * m[2][1]);
    const double c1 = (m[1][2] * m[2][0]) - (m[1][0] * m[2][2]);
    const double c2 = (m[1][0] * m[2][1]) - (m[1][1] * m[2][0]);
    const double determinant = (m[0][0] * c0) + (m[0][1] * c1) + (m[0][2] * c2);
    const bool is_regular = fabs(determinant) > PIVOT_MIN;
    const double scale = is_regular ? (1.0 / determinant) : 0.0;
    inverse[0][0] = c0 * scale;
    inverse[1][0] = c1 * scale;
    inverse[2][0] = c2 * scale;
    inverse[0][1] = ((m[0][2] * m[2][1]) - (m[0][1] * m[2][2])) * scale;
    inverse[1][1] = ((m[0][0] * m[2][2]) - (m[0][2] * m[2][0])) * scale;
    inverse[2][1] = ((m[0][1] * m[2][0]) - (m[0][0] * m[2][1])) * scale;
    inverse[0][2] = ((m[0][1] * m[1][2]) - (m[0][2] * m[1][1])) * scale;
    inverse[1][2] = ((m[0][2] * m[1][0]) - (m[0][0] * m[1][2])) * scale;
    inverse[2][2] = ((m[0][0] * m[1][1]) - (m[0][1] * m[1][0])) * scale;
    return is_regular;
}

/** Derivatives of a state by the heights of front wheels and bogie pivots, taken on to the wheels. */
static void spread_to_wheels(const pivot_t pivots[SIDES],
                             const double fronts[SIDES],
                             const double of_pivots[SIDES],
                             double inverse[NAV_WHEELS])
{
    for (uint32_t side = 0U; side < SIDES; side++)
    {
        double *wheels = &inverse[side * WHEELS_PER_SIDE];
        wheels[FRONT] = fronts[side];
        wheels[MIDDLE] = of_pivots[side] * pivots[side].middle;
        wheels[REAR] = of_pivots[side] * pivots[side].rear;
    }
}

/** Derivatives of a bogie: what is left of the difference of its wheels when the body has moved. */
static void invert_bogie(double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES],
                         const pivot_t *pivot,
                         uint32_t side,
                         double inverse[NAV_LINKAGE_STATES][NAV_WHEELS])
{
    const double *middle = jacobian[(side * WHEELS_PER_SIDE) + MIDDLE];
    const double *rear = jacobian[(side * WHEELS_PER_SIDE) + REAR];
    double *bogie = inverse[(uint32_t) NAV_LINKAGE_BOGIE_LEFT + side];
    const double roll = middle[NAV_LINKAGE_ROLL] - rear[NAV_LINKAGE_ROLL];
    const double pitch = middle[NAV_LINKAGE_PITCH] - rear[NAV_LINKAGE_PITCH];
    const double rocker = middle[NAV_LINKAGE_ROCKER] - rear[NAV_LINKAGE_ROCKER];
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        bogie[wheel] = -((roll * inverse[NAV_LINKAGE_ROLL][wheel]) +
                         (pitch * inverse[NAV_LINKAGE_PITCH][wheel]) +
                         (rocker * inverse[NAV_LINKAGE_ROCKER][wheel])) *
                       pivot->per_bogie;
    }
    bogie[(side * WHEELS_PER_SIDE) + MIDDLE] += pivot->per_bogie;
    bogie[(side * WHEELS_PER_SIDE) + REAR] -= pivot->per_bogie;
}

/**
 * Inverse of the Jacobian. Each bogie turns without moving its pivot's height, so that four heights,
 * of front wheels and bogie pivots, determine height, roll, pitch and rocker; the height of the body
 * cancels in their differences, which leaves 3 x 3 equations.
 */
static bool invert(double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES],
                   double inverse[NAV_LINKAGE_STATES][NAV_WHEELS])
{
    const double *fronts[SIDES] = {jacobian[FRONT], jacobian[WHEELS_PER_SIDE + FRONT]};
    const pivot_t pivots[SIDES] = {pivot_of(jacobian, 0U), pivot_of(jacobian, 1U)};
    double differences[TURNS][TURNS];
    double turns[TURNS][TURNS];

    for (uint32_t k = 0U; k < (uint32_t) TURNS; k++)
    {
        const uint32_t state = (uint32_t) NAV_LINKAGE_ROLL + k;
        differences[0][k] = fronts[0][state] - pivots[0].turns[k];
        differences[1][k] = fronts[1][state] - pivots[1].turns[k];
        differences[2][k] = pivots[0].turns[k] - pivots[1].turns[k];
    }
    const bool is_regular =
        invert_turns(differences, turns) && (fabs(pivots[0].per_bogie * pivots[1].per_bogie) > 0.0);
    double front_height[SIDES] = {0.0, 0.0};
    double pivot_height[SIDES] = {1.0, 0.0};
    for (uint32_t k = 0U; k < (uint32_t) TURNS; k++)
    {
        const double front[SIDES] = {turns[k][0], turns[k][1]};
        const double pivot[SIDES] = {turns[k][2] - turns[k][0], -(turns[k][1] + turns[k][2])};
        spread_to_wheels(pivots, front, pivot, inverse[(uint32_t) NAV_LINKAGE_ROLL + k]);
        for (uint32_t side = 0U; side < SIDES; side++)
        {
            front_height[side] -= pivots[0].turns[k] * front[side];
            pivot_height[side] -= pivots[0].turns[k] * pivot[side];
        }
    }
    spread_to_wheels(pivots, front_height, pivot_height, inverse[NAV_LINKAGE_HEIGHT]);
    invert_bogie(jacobian, &pivots[0], 0U, inverse);
    invert_bogie(jacobian, &pivots[1], 1U, inverse);
    return is_regular;
}

/** How far a hub moves forward, per height of each wheel, on flat ground: what turns nose down about a
 * pivot above moves back what hangs below. */
static void forward_of_heights(nav_vehicle_t *vehicle, uint32_t wheel)
{
    const uint32_t side = wheel / WHEELS_PER_SIDE;
    const bool is_front = (wheel % WHEELS_PER_SIDE) == FRONT;
    const double per_pitch_m = -vehicle->hub_height_m;
    const double per_rocker_m =
        -rocker_sign(side) * (vehicle->rocker_pivot_height_m - vehicle->hub_height_m);
    const double per_bogie_m =
        is_front ? 0.0 : -(vehicle->bogie_pivot_height_m - vehicle->hub_height_m);
    for (uint32_t k = 0U; k < (uint32_t) NAV_WHEELS; k++)
    {
        vehicle->forward_per_height[wheel][k] =
            (per_pitch_m * vehicle->flat_inverse[NAV_LINKAGE_PITCH][k]) +
            (per_rocker_m * vehicle->flat_inverse[NAV_LINKAGE_ROCKER][k]) +
            (per_bogie_m * vehicle->flat_inverse[(uint32_t) NAV_LINKAGE_BOGIE_LEFT + side][k]);
    }
}

void nav_vehicle_init(const nav_params_t *params, nav_vehicle_t *vehicle)
{
    const double x_m[WHEELS_PER_SIDE] = {params->front_x_m, params->middle_x_m, params->rear_x_m};
    const double y_m[WHEELS_PER_SIDE] = {params->front_y_m, params->middle_y_m, params->rear_y_m};
    const double flat[NAV_LINKAGE_STATES] = {0.0};
    double height_m[NAV_WHEELS];
    double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES];

    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const uint32_t place = wheel % WHEELS_PER_SIDE;
        const double side = (wheel < WHEELS_PER_SIDE) ? -1.0 : 1.0;
        vehicle->hub_x_m[wheel] = x_m[place];
        vehicle->hub_y_m[wheel] = side * y_m[place];
    }
    vehicle->hub_height_m = params->wheel_radius_m;
    vehicle->rocker_pivot_x_m = params->rocker_pivot_x_m;
    vehicle->rocker_pivot_height_m = params->rocker_pivot_height_m;
    vehicle->bogie_pivot_x_m = params->bogie_pivot_x_m;
    vehicle->bogie_pivot_height_m = params->bogie_pivot_height_m;
    nav_vehicle_wheel_heights(vehicle, flat, height_m, jacobian);
    (void) invert(jacobian, vehicle->flat_inverse);
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        forward_of_heights(vehicle, wheel);
    }
}

void nav_vehicle_flat_state(const nav_vehicle_t *vehicle,
                            const double height_m[NAV_WHEELS],
                            double state[NAV_LINKAGE_STATES])
{
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        state[k] = 0.0;
        for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
        {
            state[k] += vehicle->flat_inverse[k][wheel] * height_m[wheel];
        }
    }
}

/** Moves the state by what is missing of the wheel heights. */
static void move_state(const double missing_m[NAV_WHEELS], nav_linkage_t *linkage)
{
    for (uint32_t k = 0U; k < (uint32_t) NAV_LINKAGE_STATES; k++)
    {
        for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
        {
            linkage->state[k] += linkage->inverse[k][wheel] * missing_m[wheel];
        }
    }
}

bool nav_vehicle_settle(const nav_vehicle_t *vehicle,
                        const double height_m[NAV_WHEELS],
                        double tolerance_m,
                        nav_linkage_t *linkage)
{
    double reached_m[NAV_WHEELS];
    double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES];
    bool is_regular = true;
    bool is_done = false;

    for (uint32_t step = 0U; (step < STEPS_MAX) && is_regular && !is_done; step++)
    {
        double missing_m[NAV_WHEELS];
        double missing_max_m = 0.0;
        nav_vehicle_wheel_heights(vehicle, linkage->state, reached_m, jacobian);
        for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
        {
            missing_m[wheel] = height_m[wheel] - reached_m[wheel];
            missing_max_m = nav_max(missing_max_m, fabs(missing_m[wheel]));
        }
        linkage->residual_max_m = missing_max_m;
        if ((step == 0U) || (linkage->moved_max_m > NEAR_M))
        {
            linkage->moved_max_m = missing_max_m;
            is_regular = invert(jacobian, linkage->inverse);
        }
        is_done = (step > 0U) && (missing_max_m <= tolerance_m);
        if (is_regular && !is_done)
        {
            move_state(missing_m, linkage);
        }
    }
    return is_done;
}
