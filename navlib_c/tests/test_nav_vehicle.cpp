// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include "nav_rover.hpp"
#include "nav_scene.hpp"

namespace
{

constexpr double TOLERANCE_M = 1e-10;

/// The state for six wheel heights, looked for from level standing.
nav_linkage_t settled(const nav_vehicle_t &vehicle, const double height_m[NAV_WHEELS])
{
    nav_linkage_t linkage = {};
    EXPECT_TRUE(nav_vehicle_settle(&vehicle, height_m, TOLERANCE_M, &linkage));
    return linkage;
}

/// Curiosity's official geometry: wheels of 25 cm under the same links.
nav_vehicle_t curiosity()
{
    return vehicle_of(
        [](nav_params_t &params)
        {
            params.wheel_radius_m = 0.25;
            params.rocker_pivot_height_m = 0.88;
            params.bogie_pivot_height_m = 0.65;
        });
}

struct Golden
{
    double height_m[NAV_WHEELS];
    double rocker_deg, bogie_left_deg, bogie_right_deg, nose_down_deg, roll_deg;
};

/// Independent computation from the published link geometry, flat ground with wheels raised.
const Golden GOLDEN[] = {
    {{0.10, 0, 0, 0, 0, 0}, -1.79, 3.67, -0.19, -1.74, 1.18},
    {{0.25, 0, 0, 0, 0, 0}, -4.45, 9.09, -0.45, -4.32, 2.88},
    {{0.35, 0, 0, 0, 0, 0}, -6.21, 12.69, -0.62, -6.02, 3.98},
    {{0.46, 0, 0, 0, 0, 0}, -8.15, 16.65, -0.80, -7.89, 5.16},
    {{0, 0.35, 0, 0, 0, 0}, 3.14, -25.11, -0.39, 3.25, 2.50},
    {{0, 0, 0.35, 0, 0, 0}, 2.13, 14.89, -0.27, 2.20, 1.71},
    {{0.35, 0, 0, 0.35, 0, 0}, 0.0, 12.05, 12.05, -12.05, 0.0},
    {{0, 0.35, 0, 0, 0.35, 0}, 0.0, -25.47, -25.47, 6.47, 0.0},
    {{0.35, 0.35, 0.35, 0, 0, 0}, -0.40, 1.45, -1.45, 0.0, 9.15},
    {{0.35, 0, 0, -0.35, 0, 0}, -12.90, 13.51, -14.23, 0.36, 8.46},
};

TEST(Vehicle, settles_to_the_golden_table_within_a_hundredth_of_a_degree)
{
    const nav_vehicle_t vehicle = curiosity();
    for (const Golden &golden : GOLDEN)
    {
        const nav_linkage_t linkage = settled(vehicle, golden.height_m);
        const double *state = linkage.state;
        EXPECT_NEAR(golden.rocker_deg, state[NAV_LINKAGE_ROCKER] / DEG, 0.01);
        EXPECT_NEAR(golden.bogie_left_deg, state[NAV_LINKAGE_BOGIE_LEFT] / DEG, 0.01);
        EXPECT_NEAR(golden.bogie_right_deg, state[NAV_LINKAGE_BOGIE_RIGHT] / DEG, 0.01);
        EXPECT_NEAR(golden.nose_down_deg, -state[NAV_LINKAGE_PITCH] / DEG, 0.01);
        EXPECT_NEAR(golden.roll_deg, state[NAV_LINKAGE_ROLL] / DEG, 0.01);
    }
}

TEST(Vehicle, stands_level_on_flat_ground)
{
    const nav_vehicle_t vehicle = vehicle_of();
    const double zero[NAV_LINKAGE_STATES] = {0};
    double height_m[NAV_WHEELS];
    double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES];
    nav_vehicle_wheel_heights(&vehicle, zero, height_m, jacobian);
    for (double height : height_m)
    {
        EXPECT_NEAR(0.0, height, 1e-15);
    }
}

TEST(Vehicle, raising_all_wheels_raises_the_body_and_nothing_else)
{
    const nav_vehicle_t vehicle = vehicle_of();
    const double raised[NAV_WHEELS] = {0.2, 0.2, 0.2, 0.2, 0.2, 0.2};
    const nav_linkage_t linkage = settled(vehicle, raised);
    const double *state = linkage.state;
    EXPECT_NEAR(0.2, state[NAV_LINKAGE_HEIGHT], 1e-9);
    for (int k = NAV_LINKAGE_ROLL; k < NAV_LINKAGE_STATES; k++)
    {
        EXPECT_NEAR(0.0, state[k], 1e-9);
    }
}

TEST(Vehicle, shares_of_the_six_wheels_in_the_body_height_add_up_to_one)
{
    const nav_vehicle_t vehicle = vehicle_of();
    const double flat_m[NAV_WHEELS] = {0};
    const nav_linkage_t linkage = settled(vehicle, flat_m);
    const auto &inverse = linkage.inverse;
    double sum = 0.0;
    for (double share : inverse[NAV_LINKAGE_HEIGHT])
    {
        sum += share;
    }
    EXPECT_NEAR(1.0, sum, 1e-9);
    EXPECT_NEAR(0.1376, inverse[NAV_LINKAGE_HEIGHT][0], 5e-4);
    EXPECT_NEAR(0.2107, inverse[NAV_LINKAGE_HEIGHT][1], 5e-4);
    EXPECT_NEAR(0.1517, inverse[NAV_LINKAGE_HEIGHT][2], 5e-4);
}

TEST(Vehicle, the_jacobian_is_the_derivative_of_the_heights)
{
    const nav_vehicle_t vehicle = vehicle_of();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(-0.3, 0.3);
    for (int trial = 0; trial < 200; trial++)
    {
        double state[NAV_LINKAGE_STATES];
        for (double &x : state)
        {
            x = angle(random);
        }
        double height_m[NAV_WHEELS];
        double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES];
        nav_vehicle_wheel_heights(&vehicle, state, height_m, jacobian);
        for (int k = 0; k < NAV_LINKAGE_STATES; k++)
        {
            const double step = 1e-6;
            double there[NAV_LINKAGE_STATES];
            std::copy_n(state, NAV_LINKAGE_STATES, there);
            there[k] += step;
            double high_m[NAV_WHEELS];
            double low_m[NAV_WHEELS];
            double unused[NAV_WHEELS][NAV_LINKAGE_STATES];
            nav_vehicle_wheel_heights(&vehicle, there, high_m, unused);
            there[k] -= 2.0 * step;
            nav_vehicle_wheel_heights(&vehicle, there, low_m, unused);
            for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
            {
                EXPECT_NEAR((high_m[wheel] - low_m[wheel]) / (2.0 * step), jacobian[wheel][k],
                            1e-8);
            }
        }
    }
}

TEST(Vehicle, settling_finds_the_state_that_made_the_heights)
{
    const nav_vehicle_t vehicle = vehicle_of();
    std::mt19937 random(2);
    std::uniform_real_distribution<double> angle(-0.25, 0.25);
    for (int trial = 0; trial < 500; trial++)
    {
        double made[NAV_LINKAGE_STATES];
        for (double &x : made)
        {
            x = angle(random);
        }
        double height_m[NAV_WHEELS];
        double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES];
        nav_vehicle_wheel_heights(&vehicle, made, height_m, jacobian);
        const nav_linkage_t linkage = settled(vehicle, height_m);
        for (int k = 0; k < NAV_LINKAGE_STATES; k++)
        {
            EXPECT_NEAR(made[k], linkage.state[k], 1e-7);
        }
    }
}

TEST(Vehicle, heights_no_linkage_can_take_are_refused)
{
    const nav_vehicle_t vehicle = vehicle_of();
    const double torn_m[NAV_WHEELS] = {0.0, 5.0, 0.0, 0.0, -5.0, 0.0};
    nav_linkage_t linkage = {};
    EXPECT_FALSE(nav_vehicle_settle(&vehicle, torn_m, TOLERANCE_M, &linkage));
}

TEST(Vehicle, a_linkage_without_levers_is_refused)
{
    nav_vehicle_t vehicle = vehicle_of();
    for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
    {
        vehicle.hub_y_m[wheel] = 0.0;
    }
    const double flat_m[NAV_WHEELS] = {0};
    nav_linkage_t linkage = {};
    EXPECT_FALSE(nav_vehicle_settle(&vehicle, flat_m, TOLERANCE_M, &linkage));
}

TEST(Vehicle, a_bogie_whose_wheels_stand_on_one_spot_is_refused)
{
    const double raised_m[NAV_WHEELS] = {0.0, 0.1, 0.0, 0.0, 0.0, 0.0};
    for (int side = 0; side < 2; side++)
    {
        nav_vehicle_t vehicle = vehicle_of();
        vehicle.hub_x_m[1] = -0.5;
        vehicle.hub_x_m[2] = -0.5;
        nav_linkage_t linkage = {};
        EXPECT_FALSE(nav_vehicle_settle(&vehicle, raised_m, TOLERANCE_M, &linkage)) << side;
    }
}

TEST(Vehicle, the_inverse_is_that_of_the_jacobian)
{
    const nav_vehicle_t vehicle = vehicle_of();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> height(-0.15, 0.15);
    for (int trial = 0; trial < 200; trial++)
    {
        double height_m[NAV_WHEELS];
        for (double &h : height_m)
        {
            h = height(random);
        }
        const nav_linkage_t linkage = settled(vehicle, height_m);
        nav_linkage_t again = linkage; /* starts at the solution: derivatives are taken there */
        ASSERT_TRUE(nav_vehicle_settle(&vehicle, height_m, TOLERANCE_M, &again));
        double reached_m[NAV_WHEELS];
        double jacobian[NAV_WHEELS][NAV_LINKAGE_STATES];
        nav_vehicle_wheel_heights(&vehicle, linkage.state, reached_m, jacobian);
        for (int row = 0; row < NAV_LINKAGE_STATES; row++)
        {
            for (int col = 0; col < NAV_LINKAGE_STATES; col++)
            {
                double product = 0.0;
                for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
                {
                    product += again.inverse[row][wheel] * jacobian[wheel][col];
                }
                EXPECT_NEAR((row == col) ? 1.0 : 0.0, product, 1e-6);
            }
        }
    }
}

TEST(Vehicle, what_is_left_over_and_how_far_the_derivatives_are_is_told)
{
    const nav_vehicle_t vehicle = vehicle_of();
    const double height_m[NAV_WHEELS] = {0.02, 0.0, 0.0, 0.0, 0.0, 0.0};
    nav_linkage_t near = {};
    ASSERT_TRUE(nav_vehicle_settle(&vehicle, height_m, 1e-3, &near));
    EXPECT_LE(near.residual_max_m, 1e-3);
    EXPECT_NEAR(0.02, near.moved_max_m, 1e-9);
    /* far from the guess the derivatives are taken anew */
    const double far_m[NAV_WHEELS] = {0.2, 0.0, 0.0, 0.0, 0.0, 0.0};
    nav_linkage_t far = {};
    ASSERT_TRUE(nav_vehicle_settle(&vehicle, far_m, 1e-3, &far));
    EXPECT_LT(far.moved_max_m, 0.03);
}

} // namespace
