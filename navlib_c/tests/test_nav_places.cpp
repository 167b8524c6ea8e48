// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <random>

#include "nav_rover.hpp"
#include "nav_scene.hpp"

extern "C"
{
#include "nav_places.h"
}

namespace
{

constexpr nav_uncertainty_t CERTAIN = {0.0, 0.0, 0.0};

/// The frame on a plane that rises by so much per metre forward and right.
nav_ground_t ground_of(Scene &scene, double rise_forward, double rise_right)
{
    scene.show([&](double x, double y) { return (rise_forward * x) + (rise_right * y); });
    const nav_pose2_t pose = {0.25, 0.25, 0.0};
    nav_ground_t ground;
    EXPECT_TRUE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap,
                                 &scene.ctx->relief, &pose));
    return ground;
}

std::array<nav_interval_t, NAV_WHEELS> all_at(double low_m, double high_m)
{
    std::array<nav_interval_t, NAV_WHEELS> heights;
    heights.fill({low_m, high_m});
    return heights;
}

nav_places_t places_of(const nav_ground_t &ground,
                       const std::array<nav_interval_t, NAV_WHEELS> &heights,
                       const nav_uncertainty_t &uncertainty = CERTAIN)
{
    const nav_vehicle_t rover = vehicle_of();
    nav_places_t places;
    nav_places_find(&ground, &rover, &uncertainty, heights.data(), &places);
    return places;
}

TEST(Places, on_the_plane_the_wheels_are_where_they_are_mounted)
{
    Scene scene;
    const nav_vehicle_t rover = vehicle_of();
    const nav_places_t places = places_of(ground_of(scene, 0.0, 0.0), all_at(0.0, 0.0));
    EXPECT_TRUE(places.is_bounded);
    for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
    {
        EXPECT_NEAR(rover.hub_x_m[wheel], places.wheels[wheel].u_m, 1e-9);
        EXPECT_NEAR(rover.hub_y_m[wheel], places.wheels[wheel].v_m, 1e-9);
        EXPECT_NEAR(0.0, places.wheels[wheel].half_u_m, 1e-4);
        EXPECT_NEAR(0.0, places.wheels[wheel].half_v_m, 1e-4);
    }
}

TEST(Places, raising_all_wheels_moves_them_up_the_slope_alone)
{
    Scene scene;
    const nav_vehicle_t rover = vehicle_of();
    const nav_places_t places = places_of(ground_of(scene, 0.2, -0.1), all_at(0.1, 0.1));
    for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
    {
        EXPECT_NEAR(rover.hub_x_m[wheel] + 0.02, places.wheels[wheel].u_m, 1e-3);
        EXPECT_NEAR(rover.hub_y_m[wheel] - 0.01, places.wheels[wheel].v_m, 1e-3);
    }
}

TEST(Places, hold_where_the_wheels_are_for_all_heights_within_the_intervals)
{
    Scene scene;
    const nav_ground_t ground = ground_of(scene, 0.0, 0.0);
    const nav_vehicle_t rover = vehicle_of();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int trial = 0; trial < 4000; trial++)
    {
        const double most_m = 0.35 * std::fabs(unit(random));
        std::array<nav_interval_t, NAV_WHEELS> heights;
        for (nav_interval_t &wheel : heights)
        {
            const double a = most_m * unit(random);
            const double b = most_m * unit(random);
            wheel = {std::min(a, b), std::max(a, b)};
        }
        const nav_places_t places = places_of(ground, heights);
        ASSERT_TRUE(places.is_bounded);
        for (int k = 0; k < 8; k++)
        {
            double height_m[NAV_WHEELS];
            nav_linkage_t linkage = {};
            double forward_m[NAV_WHEELS];
            double right_m[NAV_WHEELS];
            for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
            {
                const double part = std::round(2.0 * std::fabs(unit(random))) / 2.0;
                height_m[wheel] =
                    heights[wheel].low_m + (part * (heights[wheel].high_m - heights[wheel].low_m));
            }
            ASSERT_TRUE(nav_vehicle_settle(&rover, height_m, 1e-10, &linkage));
            nav_vehicle_wheel_places(&rover, linkage.state, forward_m, right_m);
            EXPECT_LE(std::fabs(linkage.state[NAV_LINKAGE_ROLL] - places.roll_rad),
                      places.roll_half_rad);
            EXPECT_LE(std::fabs(linkage.state[NAV_LINKAGE_PITCH] - places.pitch_rad),
                      places.pitch_half_rad);
            for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
            {
                const nav_box_t &box = places.wheels[wheel];
                EXPECT_LE(std::fabs(forward_m[wheel] - box.u_m), box.half_u_m) << wheel;
                EXPECT_LE(std::fabs(right_m[wheel] - box.v_m), box.half_v_m) << wheel;
            }
        }
    }
}

TEST(Places, uncertainty_widens_them_and_yaw_those_far_from_the_middle_more)
{
    Scene scene;
    const nav_uncertainty_t uncertain = {0.05, 0.02, 0.0};
    const nav_places_t places = places_of(ground_of(scene, 0.0, 0.0), all_at(0.0, 0.0), uncertain);
    const nav_box_t &front = places.wheels[0];
    const nav_box_t &middle = places.wheels[1];
    EXPECT_GE(front.half_u_m, 0.05 + (0.02 * 1.0));
    EXPECT_GE(front.half_v_m, 0.05 + (0.02 * 1.1));
    EXPECT_GT(front.half_v_m, middle.half_v_m);
    EXPECT_LT(front.half_v_m, 0.1);
}

TEST(Places, a_wheel_that_leans_touches_beside_its_lowest_point)
{
    Scene scene;
    const nav_vehicle_t rover = vehicle_of();
    std::array<nav_interval_t, NAV_WHEELS> heights = all_at(0.0, 0.0);
    for (int wheel = 0; wheel < NAV_WHEELS / 2; wheel++)
    {
        heights[wheel] = {0.1, 0.1}; /* the left side is raised: it leans to the right */
    }
    const nav_places_t places = places_of(ground_of(scene, 0.0, 0.0), heights);
    EXPECT_GT(places.roll_rad, 0.03);
    const nav_box_t &middle = places.wheels[1];
    EXPECT_LE(middle.v_m - middle.half_v_m, rover.hub_y_m[1]);
    EXPECT_GE(middle.v_m + middle.half_v_m,
              rover.hub_y_m[1] + places.roll_rad * rover.hub_height_m);
}

TEST(Places, heights_too_different_are_not_bounded)
{
    Scene scene;
    const nav_ground_t ground = ground_of(scene, 0.0, 0.0);
    EXPECT_TRUE(places_of(ground, all_at(-0.34, 0.34)).is_bounded);
    EXPECT_FALSE(places_of(ground, all_at(-0.36, 0.36)).is_bounded);
}

TEST(Places, hold_others_only_when_all_of_them_lie_inside)
{
    Scene scene;
    const nav_ground_t ground = ground_of(scene, 0.0, 0.0);
    const nav_places_t outer = places_of(ground, all_at(-0.06, 0.06));
    const nav_places_t inner = places_of(ground, all_at(-0.03, 0.03));
    EXPECT_TRUE(nav_places_hold(&outer, &inner));
    EXPECT_TRUE(nav_places_hold(&outer, &outer));
    EXPECT_FALSE(nav_places_hold(&inner, &outer));
    for (int wheel = 0; wheel < NAV_WHEELS; wheel++)
    {
        nav_places_t moved = inner;
        moved.wheels[wheel].u_m += outer.wheels[wheel].half_u_m;
        EXPECT_FALSE(nav_places_hold(&outer, &moved)) << wheel;
        moved = inner;
        moved.wheels[wheel].v_m -= outer.wheels[wheel].half_v_m;
        EXPECT_FALSE(nav_places_hold(&outer, &moved)) << wheel;
    }
    nav_places_t boundless = inner;
    boundless.is_bounded = false;
    EXPECT_FALSE(nav_places_hold(&outer, &boundless));
    EXPECT_FALSE(nav_places_hold(&boundless, &inner));
}

} // namespace
