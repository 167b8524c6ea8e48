// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include "nav_rover.hpp"
#include "nav_scene.hpp"

extern "C"
{
#include "nav_states.h"
}

namespace
{

constexpr double SOLVED_M = 1e-10;

struct Heights
{
    nav_interval_t wheels[NAV_WHEELS];
};

/// Random intervals within +/- half_m of a common height.
Heights random_heights(std::mt19937 &random, double common_m, double half_m)
{
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Heights heights;
    for (nav_interval_t &wheel : heights.wheels)
    {
        const double a = common_m + (half_m * unit(random));
        const double b = common_m + (half_m * unit(random));
        wheel = {std::min(a, b), std::max(a, b)};
    }
    return heights;
}

/// A state for heights within the intervals, often at their ends.
nav_linkage_t state_within(std::mt19937 &random, const nav_vehicle_t &rover, const Heights &heights)
{
    std::uniform_real_distribution<double> unit(-0.5, 1.5);
    double height_m[NAV_WHEELS];
    for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
    {
        const nav_interval_t &in = heights.wheels[wheel];
        const double part = std::min(std::max(unit(random), 0.0), 1.0);
        height_m[wheel] = in.low_m + (part * (in.high_m - in.low_m));
    }
    nav_linkage_t linkage = {};
    EXPECT_TRUE(nav_vehicle_settle(&rover, height_m, SOLVED_M, &linkage));
    return linkage;
}

void expect_inside(const nav_linkage_t &linkage, const nav_spanned_t &spanned)
{
    for (int k = 0; k < NAV_LINKAGE_STATES; k++)
    {
        EXPECT_LE(std::fabs(linkage.state[k] - spanned.linkage.state[k]), spanned.half[k] + 1e-9)
            << k;
    }
}

TEST(States, solved_hold_every_state_of_heights_within_the_intervals)
{
    std::mt19937 random(11);
    const nav_vehicle_t rover = vehicle_of();
    for (int trial = 0; trial < 2000; trial++)
    {
        const Heights heights = random_heights(random, 0.0, 0.3);
        nav_spanned_t spanned = {};
        ASSERT_TRUE(nav_states_solve(&rover, heights.wheels, &spanned));
        for (int k = 0; k < 5; k++)
        {
            expect_inside(state_within(random, rover, heights), spanned);
        }
    }
}

TEST(States, as_on_flat_ground_they_hold_them_too)
{
    std::mt19937 random(12);
    const nav_vehicle_t rover = vehicle_of();
    for (double common_m : {-0.25, 0.0, 0.25})
    {
        for (int trial = 0; trial < 2000; trial++)
        {
            const Heights heights = random_heights(random, common_m, 0.1);
            nav_spanned_t spanned = {};
            ASSERT_TRUE(nav_states_flat(&rover, heights.wheels, &spanned));
            for (int k = 0; k < 5; k++)
            {
                expect_inside(state_within(random, rover, heights), spanned);
            }
        }
    }
}

TEST(States, heights_too_different_for_flat_ground_are_told)
{
    const nav_vehicle_t rover = vehicle_of();
    Heights heights = {};
    heights.wheels[1] = {-0.05, 0.0};
    heights.wheels[4] = {0.1, 0.16};
    nav_spanned_t spanned = {};
    EXPECT_FALSE(nav_states_flat(&rover, heights.wheels, &spanned));
    heights.wheels[4].high_m = 0.14;
    EXPECT_TRUE(nav_states_flat(&rover, heights.wheels, &spanned));
}

TEST(States, heights_no_linkage_can_take_have_none)
{
    const nav_vehicle_t rover = vehicle_of();
    Heights heights = {};
    heights.wheels[1] = {3.0, 3.0};
    heights.wheels[4] = {-3.0, -3.0};
    nav_spanned_t spanned = {};
    EXPECT_FALSE(nav_states_solve(&rover, heights.wheels, &spanned));
}

} // namespace
