// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "nav_standing.hpp"

extern "C"
{
#include "nav_wheel.h"
}

namespace
{

nav_footprint_t footprint_at(double u_m, double v_m)
{
    return {{u_m, v_m, RADIUS_M + 0.03, 0.165 + 0.03}, RADIUS_M, RADIUS_M, 0.0, 0.0};
}

TEST(Wheel, stands_on_a_plane_at_height_zero)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.3 * x) - (0.2 * y); });
    for (double yaw = -3.0; yaw < 3.0; yaw += 0.37)
    {
        const nav_ground_t ground = placed(scene, yaw);
        const nav_box_t places = {1.0, -1.0, 0.12, 0.08};
        const nav_interval_t above = {0.0, 0.0};
        const nav_interval_t hub = nav_wheel_interval(&ground, &places, &above, RADIUS_M);
        EXPECT_NEAR(0.0, hub.low_m, 1e-5) << yaw;
        EXPECT_NEAR(0.0, hub.high_m, 1e-5) << yaw;
    }
}

TEST(Wheel, its_interval_holds_every_height_it_can_stand_at)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int world = 0; world < 6; world++)
    {
        /* rough ground on a level: every cell up to 15 cm from its neighbour, and pillars */
        std::mt19937 rough(static_cast<unsigned>(world));
        std::uniform_real_distribution<double> height(0.0, 0.15);
        Scene scene;
        scene.show([&](double, double)
                   { return height(rough) + ((rough() % 40U == 0U) ? 0.2 : 0.0); });
        for (int trial = 0; trial < 60; trial++)
        {
            const nav_ground_t ground = placed(scene, 3.1 * unit(random), 0.25, 0.25);
            const nav_box_t places = {1.2 * unit(random), 1.1 * unit(random),
                                      0.08 * (1.0 + unit(random)), 0.06 * (1.0 + unit(random))};
            nav_footprint_t footprint = footprint_at(places.u_m, places.v_m);
            footprint.box.half_u_m += 0.2;
            footprint.box.half_v_m += 0.2;
            const nav_span_t span = nav_wheel_span(&ground, &footprint);
            const nav_interval_t hub = nav_wheel_interval(&ground, &places, &span.above, RADIUS_M);
            for (int k = 0; k < 40; k++)
            {
                const double u = places.u_m + places.half_u_m * unit(random);
                const double v = places.v_m + places.half_v_m * unit(random);
                /* slopes of the fitted plane are small here: foot and place differ by millimetres */
                const double slack_m =
                    0.4 * (std::fabs(ground.forward_up) + std::fabs(ground.right_up)) + 1e-6;
                const double height_m = standing_m(ground, u, v);
                EXPECT_GE(height_m, hub.low_m - slack_m);
                EXPECT_LE(height_m, hub.high_m + slack_m);
            }
        }
    }
}

TEST(Wheel, a_stone_beside_it_is_not_under_it)
{
    Scene scene;
    scene.show([](double x, double y)
               { return (std::hypot(x - 1.25, y - 0.65) < 0.12) ? 0.2 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0);
    /* the stone's middle is 0.4 m right of the pose: a wheel at 0.1 m has it 0.3 m beside */
    const nav_box_t beside = {1.0, 0.1, 0.03, 0.03};
    const nav_box_t under = {1.0, 0.4, 0.03, 0.03};
    const nav_interval_t above = {-0.05, 0.25};
    const double plane_m = eta_at(ground, 1.0, 0.1);
    EXPECT_NEAR(plane_m, nav_wheel_interval(&ground, &beside, &above, RADIUS_M).high_m, 0.02);
    EXPECT_NEAR(plane_m + 0.2, nav_wheel_interval(&ground, &under, &above, RADIUS_M).high_m, 0.02);
}

TEST(Wheel, a_ridge_that_it_crosses_between_two_lines_carries_it)
{
    /* one row of cells stands out; on these headings the wheel meets it between two lines of the grid */
    Scene scene;
    scene.show([](double x, double) { return (std::fabs(x - 1.05) < 0.04) ? 0.05 : 0.0; });
    const nav_interval_t above = {-0.02, 0.07};
    for (double yaw : {-0.95, -0.8, -0.7, 0.72, 0.79, 0.9})
    {
        /* dense sampling misses up to 2 mm at the rim of the disc */
        for (double ahead_m = 0.5; ahead_m < 1.7; ahead_m += 0.013)
        {
            const nav_ground_t ground = placed(scene, yaw);
            const nav_box_t places = {ahead_m, 0.1, 0.003, 0.002};
            const nav_interval_t hub = nav_wheel_interval(&ground, &places, &above, RADIUS_M);
            const double height_m = standing_m(ground, places.u_m, places.v_m);
            EXPECT_GE(height_m, hub.low_m - 2e-3) << yaw << " " << ahead_m;
            EXPECT_LE(height_m, hub.high_m + 2e-3) << yaw << " " << ahead_m;
        }
    }
}

TEST(Wheel, places_across_too_many_lines_get_the_heights_of_all_ground_around)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.3);
    const nav_box_t places = {0.0, 0.0, 2.0, 0.1};
    const nav_interval_t above = {-0.3, 0.4};
    const nav_interval_t hub = nav_wheel_interval(&ground, &places, &above, RADIUS_M);
    EXPECT_DOUBLE_EQ(-0.3 * ground.cos_slope, hub.low_m);
    EXPECT_DOUBLE_EQ(0.4 * ground.cos_slope, hub.high_m);
}

TEST(Wheel, unknown_ground_under_it_leaves_what_is_known_around)
{
    Scene scene;
    scene.show(flat, [](double x, double) { return (x > 1.0) ? 1.0 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0);
    const nav_interval_t above = {-0.1, 0.1};
    const nav_box_t hidden = {2.0, 0.0, 0.03, 0.03};
    const nav_interval_t hub = nav_wheel_interval(&ground, &hidden, &above, RADIUS_M);
    EXPECT_DOUBLE_EQ(-0.1, hub.low_m);
    EXPECT_DOUBLE_EQ(0.1, hub.high_m);
    /* partly in the shadow it stands on what is known */
    const nav_box_t edge = {0.75, 0.0, 0.03, 0.03};
    EXPECT_NEAR(0.0, nav_wheel_interval(&ground, &edge, &above, RADIUS_M).high_m, 2e-3);
    /* and known lines before unknown ones are found behind a shadow, too */
    const nav_ground_t back = placed(scene, 3.14159265358979);
    EXPECT_NEAR(0.0, nav_wheel_interval(&back, &edge, &above, RADIUS_M).high_m, 2e-3);
    /* where its places reach far into the shadow it could stand as low as the ground around */
    const nav_box_t far = {1.2, 0.0, 0.4, 0.03};
    EXPECT_DOUBLE_EQ(-0.1, nav_wheel_interval(&ground, &far, &above, RADIUS_M).low_m);
}

TEST(Wheel, its_box_counts_cells_and_finds_the_highest_and_lowest)
{
    Scene scene;
    scene.show(
        [](double x, double y)
        {
            const double stone = (std::hypot(x - 1.25, y - 0.25) < 0.04) ? 0.3 : 0.0;
            const double hole = (std::hypot(x - 1.15, y - 0.15) < 0.04) ? -0.2 : 0.0;
            return stone + hole;
        });
    for (double yaw : {0.0, 0.3, 1.2, -2.0})
    {
        const nav_ground_t ground = placed(scene, yaw, 1.25, 0.25);
        const nav_footprint_t footprint = footprint_at(0.0, 0.0);
        const nav_span_t span = nav_wheel_span(&ground, &footprint);
        EXPECT_NEAR(0.5, span.above.high_m - span.above.low_m, 0.05) << yaw;
        EXPECT_EQ(0U, span.unknown_count);
        EXPECT_NEAR(4.0 * footprint.box.half_u_m * footprint.box.half_v_m / 0.01, span.cell_count,
                    9.0);
    }
}

TEST(Wheel, at_the_edges_of_the_map_it_stands_on_what_is_there)
{
    Scene scene;
    scene.show(flat);
    const nav_interval_t above = {-0.1, 0.1};
    const nav_box_t here = {0.0, 0.0, 0.05, 0.05};
    for (double x_m : {-14.8, 0.0, 14.8})
    {
        for (double y_m : {-14.8, 0.0, 14.8})
        {
            for (double yaw : {0.0, 0.6, 1.5707963267948966, 2.4, -0.7, -1.9})
            {
                const nav_ground_t ground = placed(scene, yaw, x_m, y_m);
                const nav_interval_t hub = nav_wheel_interval(&ground, &here, &above, RADIUS_M);
                EXPECT_LE(hub.high_m, 0.1);
                EXPECT_GE(hub.high_m, -1e-3);
                EXPECT_GE(hub.low_m, -0.1);
                EXPECT_LE(hub.low_m, 1e-3);
            }
        }
    }
}

TEST(Wheel, cells_off_the_map_are_unknown)
{
    Scene scene;
    scene.show(flat);
    for (double yaw : {0.0, 1.5707963267948966, 0.7, -2.2})
    {
        const nav_ground_t ground = placed(scene, yaw, 14.2, 14.2);
        nav_footprint_t footprint = footprint_at(0.0, 0.0);
        footprint.box.half_u_m = 2.0;
        footprint.box.half_v_m = 2.0;
        const nav_span_t span = nav_wheel_span(&ground, &footprint);
        EXPECT_GT(span.unknown_count, 100U) << yaw;
        EXPECT_LT(span.unknown_count, span.cell_count) << yaw;
        EXPECT_NEAR(0.0, span.above.high_m, 1e-6) << yaw;
    }
    const nav_ground_t south = placed(scene, 0.0, -14.2, -14.2);
    nav_footprint_t wide = footprint_at(0.0, 0.0);
    wide.box.half_u_m = 2.0;
    EXPECT_GT(nav_wheel_span(&south, &wide).unknown_count, 5U);
    const nav_ground_t ground = placed(scene, 0.0, 14.2, 14.2);
    const nav_footprint_t beyond = footprint_at(3.0, 3.0);
    const nav_span_t nothing = nav_wheel_span(&ground, &beyond);
    EXPECT_EQ(nothing.cell_count, nothing.unknown_count);
    EXPECT_LT(nothing.above.high_m, nothing.above.low_m);
}

TEST(Wheel, a_leaning_box_holds_other_cells_than_an_upright_one)
{
    Scene scene;
    scene.show([](double x, double y)
               { return (std::hypot(x - 1.65, y - 0.25) < 0.04) ? 0.6 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0, 1.25, 0.25);
    nav_footprint_t footprint = footprint_at(0.0, 0.0);
    footprint.box.half_u_m = 0.35;
    const nav_span_t upright = nav_wheel_span(&ground, &footprint);
    /* nose up, the box leans back, away from what is high ahead, or forward over it */
    footprint.pitch_rad = -0.3;
    const nav_span_t forward = nav_wheel_span(&ground, &footprint);
    EXPECT_LT(upright.above.high_m, 0.1);
    EXPECT_GT(forward.above.high_m, 0.5);
}

} // namespace
