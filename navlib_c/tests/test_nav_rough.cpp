// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "nav_standing.hpp"

extern "C"
{
#include "nav_rough.h"
}

namespace
{

bool is_nothing(const nav_interval_t &height)
{
    return (height.low_m <= -NAV_ETA_NONE) && (height.high_m >= NAV_ETA_NONE);
}

TEST(Rough, a_wheel_on_a_plane_stands_on_it_give_or_take_two_centimetres)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.3 * x) - (0.2 * y); });
    for (double yaw = -3.0; yaw < 3.0; yaw += 0.37)
    {
        const nav_ground_t ground = placed(scene, yaw);
        const nav_box_t places = {1.0, -1.0, 0.05, 0.05};
        const nav_interval_t height = nav_rough_interval(&ground, &places, 0.0, RADIUS_M);
        EXPECT_LE(height.low_m, 0.0) << yaw;
        EXPECT_GE(height.low_m, -0.005) << yaw;
        EXPECT_GE(height.high_m, 0.0) << yaw;
        EXPECT_LE(height.high_m, 0.02) << yaw;
    }
}

TEST(Rough, it_holds_every_height_a_wheel_can_stand_at)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int world = 0; world < 4; world++)
    {
        std::mt19937 rough(static_cast<unsigned>(world));
        std::uniform_real_distribution<double> height(0.0, 0.1);
        Scene scene;
        scene.show([&](double, double)
                   { return height(rough) + ((rough() % 40U == 0U) ? 0.15 : 0.0); });
        for (int trial = 0; trial < 60; trial++)
        {
            const nav_ground_t ground = placed(scene, 3.1 * unit(random));
            const nav_box_t places = {1.2 * unit(random), 1.1 * unit(random), 0.06, 0.04};
            const nav_interval_t found = nav_rough_interval(&ground, &places, 0.1, RADIUS_M);
            ASSERT_FALSE(is_nothing(found));
            for (int k = 0; k < 40; k++)
            {
                /* the fitted plane leans a little: foot and place differ by millimetres */
                const double slack_m =
                    0.4 * (std::fabs(ground.forward_up) + std::fabs(ground.right_up)) + 1e-6;
                const double height_m = standing_m(ground, places.u_m + 0.06 * unit(random),
                                                   places.v_m + 0.04 * unit(random));
                EXPECT_GE(height_m, found.low_m - slack_m);
                EXPECT_LE(height_m, found.high_m + slack_m);
            }
        }
    }
}

TEST(Rough, ground_far_from_what_was_expected_or_unknown_says_nothing)
{
    Scene scene;
    scene.show(flat, [](double x, double y) { return (std::hypot(x - 4.0, y) < 0.4) ? 1.0 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0);
    const nav_box_t places = {1.0, 1.0, 0.05, 0.05};
    EXPECT_FALSE(is_nothing(nav_rough_interval(&ground, &places, 0.25, RADIUS_M)));
    EXPECT_TRUE(is_nothing(nav_rough_interval(&ground, &places, 0.35, RADIUS_M)));
    EXPECT_TRUE(is_nothing(nav_rough_interval(&ground, &places, -0.35, RADIUS_M)));
    const nav_box_t hidden = {3.5, 0.0, 0.05, 0.05};
    EXPECT_TRUE(is_nothing(nav_rough_interval(&ground, &hidden, 0.0, RADIUS_M)));
}

TEST(Rough, off_the_map_it_says_nothing)
{
    Scene scene;
    scene.show(flat);
    for (double yaw : {0.0, 1.5707963267948966, 3.141592653589793, -1.5707963267948966})
    {
        const nav_ground_t ground = placed(scene, yaw);
        for (double ahead_m : {15.1, 15.24, 15.5, 30.0})
        {
            const nav_box_t places = {ahead_m, 0.0, 0.05, 0.05};
            EXPECT_TRUE(is_nothing(nav_rough_interval(&ground, &places, 0.0, RADIUS_M)))
                << yaw << " " << ahead_m;
        }
    }
}

TEST(Rough, at_the_last_rows_and_columns_it_sees_the_ground_that_is_there)
{
    Scene scene;
    scene.show([](double x, double y)
               { return ((std::fabs(x) > 14.85) || (std::fabs(y) > 14.85)) ? 0.2 : 0.0; });
    for (double yaw : {0.0, 1.5707963267948966, 3.141592653589793, -1.5707963267948966})
    {
        const nav_ground_t ground = placed(scene, yaw, 0.0, 0.0);
        for (double ahead_m : {14.61, 14.64, 14.65, 14.66})
        {
            /* the wall at the edge is within its radius, and is seen where the window is on the map */
            const nav_box_t places = {ahead_m, 0.0, 0.03, 0.03};
            const nav_interval_t height = nav_rough_interval(&ground, &places, 0.0, RADIUS_M);
            EXPECT_TRUE(is_nothing(height) || (height.high_m > 0.05)) << yaw << " " << ahead_m;
        }
    }
}

TEST(Rough, places_larger_than_the_map_say_nothing)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
    const nav_box_t places = {0.0, 0.0, 20.0, 0.1};
    EXPECT_TRUE(is_nothing(nav_rough_interval(&ground, &places, 0.0, RADIUS_M)));
}

TEST(Rough, a_stone_beside_it_counts_for_less_the_further_it_is)
{
    Scene scene;
    scene.show([](double x, double y)
               { return (std::hypot(x - 1.25, y - 0.65) < 0.12) ? 0.2 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0);
    double before_m = 1.0;
    for (double beside_m : {0.0, 0.2, 0.3, 0.4})
    {
        const nav_box_t places = {1.0, 0.4 - beside_m, 0.03, 0.03};
        const double high_m = nav_rough_interval(&ground, &places, 0.0, RADIUS_M).high_m;
        EXPECT_LT(high_m, before_m) << beside_m;
        before_m = high_m;
    }
    EXPECT_LT(before_m, 0.03);
}

} // namespace
