// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "nav_rover.hpp"
#include "nav_scene.hpp"

extern "C"
{
#include "nav_belly.h"
}

namespace
{

constexpr double HEIGHT_M = 0.6;
const nav_box_t BELLY = {-0.14, 0.0, 1.04, 0.775};

nav_ground_t placed(const Scene &scene, double yaw_rad, double x_m = 0.25, double y_m = 0.25)
{
    const nav_pose2_t pose = {x_m, y_m, yaw_rad};
    nav_ground_t ground;
    EXPECT_TRUE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap,
                                 &scene.ctx->relief, &pose));
    return ground;
}

/// A state without spread: level on the plane, or with some numbers changed.
nav_spanned_t standing(double height_m = 0.0, double roll_rad = 0.0, double pitch_rad = 0.0)
{
    const nav_vehicle_t vehicle = vehicle_of();
    nav_spanned_t spanned = {};
    spanned.linkage.state[NAV_LINKAGE_HEIGHT] = height_m;
    spanned.linkage.state[NAV_LINKAGE_ROLL] = roll_rad;
    spanned.linkage.state[NAV_LINKAGE_PITCH] = pitch_rad;
    std::memcpy(spanned.linkage.inverse, vehicle.flat_inverse, sizeof(vehicle.flat_inverse));
    spanned.sin_roll = std::sin(roll_rad);
    spanned.cos_roll = std::cos(roll_rad);
    spanned.sin_pitch = std::sin(pitch_rad);
    spanned.cos_pitch = std::cos(pitch_rad);
    return spanned;
}

/// Widens every wheel's interval.
nav_spanned_t spread(nav_spanned_t spanned, double half_m)
{
    for (double &wheel : spanned.wheel_half_m)
    {
        wheel = half_m;
    }
    for (int k = 0; k < NAV_LINKAGE_STATES; k++)
    {
        for (double per_wheel : spanned.linkage.inverse[k])
        {
            spanned.half[k] += std::fabs(per_wheel) * half_m;
        }
    }
    return spanned;
}

double clearance(const nav_ground_t &ground, const nav_spanned_t &spanned)
{
    return nav_belly_clearance(&ground, &spanned, &BELLY, HEIGHT_M, 0.0, NAV_ETA_NONE)
        .clearance_min_m;
}

TEST(Belly, over_a_plane_it_is_at_its_height)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.3 * x) - (0.2 * y); });
    for (double yaw = -3.0; yaw < 3.0; yaw += 0.5)
    {
        EXPECT_NEAR(HEIGHT_M, clearance(placed(scene, yaw), standing()), 1e-5);
        EXPECT_NEAR(HEIGHT_M + 0.1, clearance(placed(scene, yaw), standing(0.1)), 1e-5);
    }
}

TEST(Belly, the_least_is_found_wherever_the_stone_is)
{
    for (double x = -1.0; x <= 0.8; x += 0.2)
    {
        for (double y = -0.7; y <= 0.7; y += 0.2)
        {
            /* a small stone beside the one that counts, so that the first look is not the last */
            Scene scene;
            scene.show(
                [=](double north, double east)
                {
                    const bool is_stone = std::hypot(north - 0.25 - x, east - 0.25 - y) < 0.08;
                    const bool is_small = std::hypot(north - 0.25, east - 0.25) < 0.08;
                    return std::max(is_stone ? 0.2 : 0.0, is_small ? 0.15 : 0.0);
                });
            const nav_ground_t ground = placed(scene, 0.0);
            double highest_m = -1.0;
            for (int row = 120; row < 180; row++)
            {
                for (int col = 120; col < 180; col++)
                {
                    const double north = (row - ground.row) * 0.1;
                    const double east = (col - ground.col) * 0.1;
                    const double above = ground.z_site_m + ground.dz_dx * north +
                                         ground.dz_dy * east -
                                         ground.surface->z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col];
                    if ((std::fabs(north + 0.14) < 1.0) && (std::fabs(east) < 0.75))
                    {
                        highest_m = std::max(highest_m, above);
                    }
                }
            }
            EXPECT_NEAR(HEIGHT_M - highest_m, clearance(ground, standing()), 0.012)
                << x << " " << y;
        }
    }
}

TEST(Belly, a_stone_beside_it_is_not_under_it)
{
    Scene scene;
    scene.show([](double x, double y)
               { return (std::hypot(x - 0.25, y - 1.35) < 0.1) ? 0.5 : 0.0; });
    EXPECT_GT(clearance(placed(scene, 0.0), standing()), 0.5);
    /* turned by a quarter, it is under the nose */
    Scene ahead;
    ahead.show([](double x, double y)
               { return (std::hypot(x - 0.25, y - 1.15) < 0.1) ? 0.5 : 0.0; });
    EXPECT_LT(clearance(placed(ahead, 90.0 * DEG), standing()), 0.2);
    EXPECT_GT(clearance(placed(ahead, 0.0), standing()), 0.5);
}

TEST(Belly, leaning_lowers_one_end)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.0);
    /* nose down by 0.1 rad: the front of the belly, 0.9 m ahead, comes down by 9 cm */
    EXPECT_NEAR(HEIGHT_M - 0.09, clearance(ground, standing(0.0, 0.0, -0.1)), 0.015);
    EXPECT_NEAR(HEIGHT_M - 0.0775, clearance(ground, standing(0.0, 0.1, 0.0)), 0.015);
}

TEST(Belly, intervals_of_the_wheels_take_away_at_least_what_they_take_on_average)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.4);
    const double exact_m = clearance(ground, standing());
    const double spread_m = clearance(ground, spread(standing(), 0.05));
    /* all wheels 5 cm lower bring the belly down by 5 cm; tilting takes more at the ends */
    EXPECT_LT(spread_m, exact_m - 0.05);
    EXPECT_GT(spread_m, exact_m - 0.15);
}

TEST(Belly, unknown_ground_is_told_by_its_share)
{
    Scene scene([](nav_params_t &params) { params.surface_fill_neighbors = 9.0; });
    scene.show(flat, [](double x, double) { return (x > 0.5) ? 1.0 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0);
    const nav_spanned_t level = standing();
    const nav_clearance_t half =
        nav_belly_clearance(&ground, &level, &BELLY, HEIGHT_M, 0.0, NAV_ETA_NONE);
    EXPECT_GT(half.unknown, 0.2);
    EXPECT_LT(half.unknown, 0.6);
    EXPECT_NEAR(HEIGHT_M, half.clearance_min_m, 1e-5);
    /* what lies beside the belly does not count */
    const nav_ground_t aside = placed(scene, 0.0, 0.25, 0.45);
    EXPECT_NEAR(half.unknown,
                nav_belly_clearance(&aside, &level, &BELLY, HEIGHT_M, 0.0, NAV_ETA_NONE).unknown,
                0.06);
}

TEST(Belly, over_nothing_known_all_is_unknown)
{
    Scene scene([](nav_params_t &params) { params.costmap_patch_known_min = 0.05; });
    scene.show(
        flat, [](double x, double y)
        { return ((std::fabs(x - 0.11) < 1.6) && (std::fabs(y - 0.25) < 1.2)) ? 1.0 : 0.0; });
    const nav_pose2_t pose = {0.25, 0.25, 0.0};
    nav_ground_t ground;
    /* no plane was fitted here: one is lent */
    uint32_t index = 0;
    ASSERT_TRUE(nav_costmap_find(&scene.ctx->costmap, pose.x_m, pose.y_m, &index));
    scene.ctx->costmap.cells[index].is_known = 1U;
    ASSERT_TRUE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap,
                                 &scene.ctx->relief, &pose));
    const nav_spanned_t level = standing();
    EXPECT_DOUBLE_EQ(
        1.0, nav_belly_clearance(&ground, &level, &BELLY, HEIGHT_M, 0.0, NAV_ETA_NONE).unknown);
}

TEST(Belly, over_the_edge_of_the_map_all_is_unknown)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.0, 14.5, 0.0);
    const nav_spanned_t level = standing();
    EXPECT_DOUBLE_EQ(
        1.0, nav_belly_clearance(&ground, &level, &BELLY, HEIGHT_M, 0.0, NAV_ETA_NONE).unknown);
}

TEST(Belly, ground_that_leaves_enough_is_bounded_from_whole_cells)
{
    const auto stone = [](double x, double y)
    { return (std::hypot(x - 0.25, y - 0.25) < 0.1) ? 0.2 : 0.0; };
    Scene scene;
    scene.show(stone);
    const nav_ground_t ground = placed(scene, 0.7);
    const nav_spanned_t level = spread(standing(0.02, 0.03, -0.02), 0.02);
    const double exact_m = clearance(ground, level);
    for (double enough_m = 0.0; enough_m < 0.6; enough_m += 0.01)
    {
        const nav_clearance_t found =
            nav_belly_clearance(&ground, &level, &BELLY, HEIGHT_M, 0.0, enough_m);
        /* a lower bound, and the exact one where it is not enough */
        EXPECT_LE(found.clearance_min_m, exact_m);
        EXPECT_GE(found.clearance_min_m, std::min(exact_m, enough_m));
        EXPECT_DOUBLE_EQ(0.0, found.unknown);
    }
}

TEST(Belly, one_that_touches_very_many_cells_is_looked_at_wholly)
{
    Scene scene;
    scene.show([](double x, double y)
               { return (std::hypot(x - 3.85, y - 3.85) < 0.1) ? 0.3 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0);
    const nav_spanned_t level = standing();
    const nav_box_t large = {0.0, 0.0, 4.0, 4.0};
    EXPECT_NEAR(
        HEIGHT_M - 0.3,
        nav_belly_clearance(&ground, &level, &large, HEIGHT_M, 0.0, NAV_ETA_NONE).clearance_min_m,
        0.03);
}

} // namespace
