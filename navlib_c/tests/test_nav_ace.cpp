// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "nav_scene.hpp"

namespace
{

/// A plateau of the given height over [x - half, x + half] x [y - half, y + half].
double block(
    double x_m, double y_m, double x, double y, double half_x, double half_y, double height)
{
    return ((std::fabs(x_m - x) <= half_x) && (std::fabs(y_m - y) <= half_y)) ? height : 0.0;
}

/// Bounds for a rover that stands on the terrain's origin, in the middle of a costmap cell.
nav_ace_bounds_t on(const Scene::Elevation &elevation, double yaw_rad = 0.0)
{
    constexpr double MIDDLE_M = 0.25;
    Scene scene;
    scene.show([&](double x, double y) { return elevation(x - MIDDLE_M, y - MIDDLE_M); });
    return scene.ace(MIDDLE_M, MIDDLE_M, yaw_rad);
}

/// How far bounds of a pose that is safe by far may be from what is true: rough heights of the wheels.
constexpr double ROUGH_M = 0.025;
constexpr double ROUGH_RAD = 0.03;

TEST(Ace, flat_ground_has_bounds_a_wheel_height_of_two_centimetres_wide)
{
    const nav_ace_bounds_t bounds = on(flat, 0.3);
    EXPECT_EQ(NAV_REASON_NONE, bounds.reason);
    EXPECT_EQ(1U, bounds.is_certified);
    EXPECT_LE(bounds.clearance_min_m, 0.60 + 1e-6);
    EXPECT_GE(bounds.clearance_min_m, 0.60 - ROUGH_M);
    EXPECT_NEAR(0.0, bounds.wheel_drop_max_m, 1e-6);
    EXPECT_GE(bounds.tilt_max_rad, 0.0);
    EXPECT_LE(bounds.tilt_max_rad, ROUGH_RAD);
    EXPECT_LE(bounds.rocker_min_rad, 0.0);
    EXPECT_GE(bounds.rocker_max_rad, 0.0);
    EXPECT_LE(bounds.rocker_max_rad - bounds.rocker_min_rad, ROUGH_RAD);
    EXPECT_LE(bounds.z_min_site_m, 1e-6);
    EXPECT_GE(bounds.z_max_site_m, -1e-6);
    EXPECT_LE(bounds.z_max_site_m - bounds.z_min_site_m, ROUGH_M);
}

TEST(Ace, a_plain_slope_is_not_a_hazard)
{
    for (double slope_deg : {5.0, 15.0, 25.0, 29.0})
    {
        const double rise = std::tan(slope_deg * DEG);
        for (double yaw : {0.0, 0.6, 1.5707963267948966, 2.5})
        {
            const nav_ace_bounds_t bounds = on([=](double x, double) { return rise * x; }, yaw);
            EXPECT_EQ(NAV_REASON_NONE, bounds.reason) << slope_deg << " " << yaw;
            EXPECT_NEAR(0.60, bounds.clearance_min_m, ROUGH_M);
            EXPECT_GE(bounds.tilt_max_rad, slope_deg * DEG - 2e-4);
            EXPECT_LE(bounds.tilt_max_rad, slope_deg * DEG + ROUGH_RAD);
            EXPECT_NEAR(0.0, bounds.rocker_max_rad, ROUGH_RAD);
        }
    }
}

TEST(Ace, attitude_on_a_slope_follows_the_heading)
{
    const double rise = std::tan(20.0 * DEG);
    const auto slope = [=](double x, double) { return rise * x; };
    const nav_ace_bounds_t up = on(slope, 0.0);
    EXPECT_NEAR(20.0 * DEG, up.pitch_min_rad, ROUGH_RAD);
    EXPECT_NEAR(20.0 * DEG, up.pitch_max_rad, ROUGH_RAD);
    EXPECT_NEAR(0.0, up.roll_max_rad, ROUGH_RAD);
    const nav_ace_bounds_t east = on(slope, 90.0 * DEG);
    EXPECT_NEAR(0.0, east.pitch_max_rad, ROUGH_RAD);
    /* north is up: on a heading to the east the left side is up, the right side down */
    EXPECT_NEAR(20.0 * DEG, east.roll_min_rad, ROUGH_RAD);
    EXPECT_NEAR(20.0 * DEG, east.roll_max_rad, ROUGH_RAD);
}

TEST(Ace, a_slope_beyond_the_limit_is_refused_for_its_tilt)
{
    const double rise = std::tan(31.0 * DEG);
    EXPECT_EQ(NAV_REASON_TILT, on([=](double x, double) { return rise * x; }).reason);
}

/* the three hazard heights of SIM's GUI, each on its own */

TEST(Ace, a_bump_under_the_belly_alone_is_a_hazard_from_25_cm)
{
    const auto reason = [](double height)
    {
        return on([=](double x, double y) { return block(x, y, -0.1, 0.0, 0.15, 0.15, height); })
            .reason;
    };
    EXPECT_NEAR(0.25, threshold(0.1, 0.5, [&](double h) { return reason(h) == NAV_REASON_NONE; }),
                0.005);
    EXPECT_EQ(NAV_REASON_NONE, reason(0.24));
    EXPECT_EQ(NAV_REASON_CLEARANCE, reason(0.26));
}

TEST(Ace, a_step_inside_one_wheel_box_is_a_hazard_from_35_cm)
{
    const auto reason = [](double height)
    {
        return on([=](double x, double y) { return block(x, y, 1.35, -1.06, 0.1, 0.1, height); })
            .reason;
    };
    EXPECT_NEAR(0.35, threshold(0.1, 0.5, [&](double h) { return reason(h) == NAV_REASON_NONE; }),
                0.01);
    EXPECT_EQ(NAV_REASON_NONE, reason(0.34));
    EXPECT_EQ(NAV_REASON_WHEEL_DROP, reason(0.36));
}

TEST(Ace, a_plateau_under_one_front_wheel_is_a_hazard_from_46_cm)
{
    for (double side : {-1.0, 1.0})
    {
        const auto reason = [=](double height)
        {
            return on([=](double x, double y)
                      { return block(x, y, 1.185, side * 1.0625, 0.45, 0.26, height); })
                .reason;
        };
        EXPECT_NEAR(0.46,
                    threshold(0.2, 0.7, [&](double h) { return reason(h) == NAV_REASON_NONE; }),
                    0.01);
        EXPECT_EQ(NAV_REASON_NONE, reason(0.45));
        EXPECT_EQ(NAV_REASON_ROCKER, reason(0.47));
    }
}

TEST(Ace, a_hole_under_one_wheel_is_a_hazard_too)
{
    const nav_ace_bounds_t bounds =
        on([](double x, double y) { return block(x, y, 0.0, 1.1845, 0.15, 0.15, -0.5); });
    EXPECT_EQ(NAV_REASON_WHEEL_DROP, bounds.reason);
}

TEST(Ace, a_middle_wheel_raised_to_the_bogie_limit_is_refused_for_the_bogie)
{
    const auto reason = [](double height)
    {
        Scene scene(
            [](nav_params_t &params)
            {
                params.wheel_drop_max_m = 1.0;
                params.clearance_min_m = 0.1;
                params.rocker_max_rad = 0.5;
            });
        scene.show([=](double x, double y) { return block(x, y, 0.0, -1.4, 0.5, 0.5, height); });
        return scene.ace(0.0, 0.0, 0.0).reason;
    };
    EXPECT_EQ(NAV_REASON_NONE, reason(0.36));
    EXPECT_EQ(NAV_REASON_BOGIE, reason(0.44));
}

TEST(Ace, either_bogie_at_either_end_of_its_range_is_refused)
{
    nav_params_t params;
    nav_params_default(&params);
    nav_ace_bounds_t fine = on(flat);
    const double beyond_rad = params.bogie_max_rad + 0.01;
    for (int k = 0; k < 4; k++)
    {
        nav_ace_bounds_t bounds = fine;
        double *const ends[4] = {&bounds.bogie_left_max_rad, &bounds.bogie_right_max_rad,
                                 &bounds.bogie_left_min_rad, &bounds.bogie_right_min_rad};
        *ends[k] = (k < 2) ? beyond_rad : -beyond_rad;
        EXPECT_EQ(NAV_REASON_BOGIE, nav_ace_refuse(&params, &bounds, false)) << k;
        EXPECT_EQ(NAV_REASON_NONE, nav_ace_refuse(&params, &bounds, true)) << k;
    }
}

TEST(Ace, raising_a_rock_under_a_wheel_or_the_belly_never_makes_a_pose_safer)
{
    const double places_m[4][2] = {{1.2, -1.06}, {0.5, -0.4}, {0.0, 1.2}, {-1.0, 1.0}};
    for (const auto &place_m : places_m)
    {
        nav_ace_bounds_t before = on(flat);
        for (double height = 0.03; height < 0.5; height += 0.04)
        {
            const nav_ace_bounds_t after =
                on([&](double x_m, double y_m)
                   { return block(x_m, y_m, place_m[0], place_m[1], 0.12, 0.12, height); });
            EXPECT_GE(after.wheel_drop_max_m, before.wheel_drop_max_m - 0.005);
            EXPECT_TRUE((before.reason == NAV_REASON_NONE) || (after.reason != NAV_REASON_NONE));
            if (std::fabs(place_m[1]) < 0.6)
            {
                EXPECT_LE(after.clearance_min_m, before.clearance_min_m + 1e-9);
            }
            before = after;
        }
    }
}

/// With such limits hardly a pose is accepted, and their bounds are as tight as they can be.
void refuse_all(nav_params_t &params)
{
    params.clearance_min_m = 0.59;
    params.rocker_max_rad = 0.02;
}

TEST(Ace, uncertainty_widens_every_bound)
{
    Scene scene(refuse_all);
    scene.show(
        [](double x, double y)
        {
            return block(x, y, 1.9, -1.0, 0.15, 0.15, 0.2) +
                   block(x, y, 0.3, 0.9, 0.12, 0.12, 0.15);
        });
    nav_ace_bounds_t before = scene.ace(0.0, 0.0, 0.2);
    for (double p : {0.05, 0.1, 0.2, 0.4})
    {
        const nav_uncertainty_t u = {p, 0.1 * p, 0.0};
        const nav_ace_bounds_t after = scene.ace(0.0, 0.0, 0.2, u);
        EXPECT_LE(after.clearance_min_m, before.clearance_min_m + 1e-6);
        EXPECT_GE(after.wheel_drop_max_m, before.wheel_drop_max_m - 1e-6);
        EXPECT_LE(after.rocker_min_rad, before.rocker_min_rad + 1e-6);
        EXPECT_GE(after.rocker_max_rad, before.rocker_max_rad - 1e-6);
        before = after;
    }
}

TEST(Ace, a_mirrored_world_has_mirrored_bounds)
{
    const auto rocks = [](double x, double y)
    { return block(x, y, 1.2, -1.0, 0.2, 0.2, 0.2) + block(x, y, -0.9, 0.9, 0.2, 0.2, 0.12); };
    Scene left;
    Scene right;
    left.show(rocks);
    right.show([&](double x, double y) { return rocks(x, -y); });
    const nav_ace_bounds_t one = left.ace(0.2, 0.1, 0.05);
    const nav_ace_bounds_t other = right.ace(0.2, -0.1, -0.05);
    EXPECT_NEAR(one.clearance_min_m, other.clearance_min_m, 1e-3);
    EXPECT_NEAR(one.roll_min_rad, -other.roll_max_rad, 1e-3);
    EXPECT_NEAR(one.pitch_max_rad, other.pitch_max_rad, 1e-3);
    EXPECT_NEAR(one.rocker_min_rad, -other.rocker_max_rad, 1e-3);
    EXPECT_NEAR(one.bogie_left_max_rad, other.bogie_right_max_rad, 1e-3);
}

TEST(Ace, unknown_ground_under_wheels_or_belly_is_refused)
{
    Scene scene;
    scene.show(flat,
               [](double x, double y)
               {
                   const bool is_under_wheel =
                       (std::fabs(x - 1.185) < 0.5) && (std::fabs(y + 1.06) < 0.35);
                   const bool is_under_belly = (std::fabs(x - 5.9) < 1.2) && (std::fabs(y) < 0.6);
                   return (is_under_wheel || is_under_belly) ? 1.0 : 0.0;
               });
    EXPECT_EQ(NAV_REASON_UNKNOWN, scene.ace(0.0, 0.0, 0.0).reason);
    EXPECT_DOUBLE_EQ(1.0, scene.ace(0.0, 0.0, 0.0).wheel_unknown);
    const nav_ace_bounds_t belly = scene.ace(6.0, 0.0, 0.0);
    EXPECT_EQ(NAV_REASON_UNKNOWN, belly.reason);
    EXPECT_GT(belly.belly_unknown, 0.5);
    EXPECT_LT(belly.wheel_unknown, 0.5);
}

TEST(Ace, a_wheel_over_a_shadow_of_any_size_is_refused_as_over_unknown_ground)
{
    for (double radius_m = 0.46; radius_m < 0.66; radius_m += 0.01)
    {
        Scene scene;
        scene.show(flat, [&](double x, double y)
                   { return (std::hypot(x - 1.435, y + 0.8) < radius_m) ? 1.0 : 0.0; });
        EXPECT_EQ(NAV_REASON_UNKNOWN, scene.ace(0.25, 0.25, 0.0).reason) << radius_m;
    }
}

TEST(Ace, a_shadow_behind_a_stone_is_tolerated)
{
    Scene scene;
    scene.show(flat, [](double x, double y)
               { return ((x > 1.2) && (std::fabs(y + 1.06) < 0.5)) ? 1.0 : 0.0; });
    const nav_ace_bounds_t bounds = scene.ace(0.0, 0.0, 0.0);
    EXPECT_EQ(NAV_REASON_NONE, bounds.reason);
    EXPECT_GT(bounds.wheel_unknown, 0.0);
}

TEST(Ace, off_the_map_is_unknown)
{
    Scene scene;
    scene.show(flat);
    EXPECT_EQ(NAV_REASON_UNKNOWN, scene.ace(100.0, 0.0, 0.0).reason);
    EXPECT_EQ(NAV_REASON_UNKNOWN, scene.ace(14.9, 0.0, 0.0).reason);
    EXPECT_EQ(0U, scene.ace(100.0, 0.0, 0.0).is_certified);
}

TEST(Ace, heights_no_linkage_can_take_are_unexpected)
{
    const nav_ace_bounds_t bounds = on(
        [](double x, double y)
        { return block(x, y, 0.0, -1.5, 0.5, 0.7, 3.0) + block(x, y, 0.0, 1.5, 0.5, 0.7, -3.0); });
    EXPECT_NE(NAV_REASON_NONE, bounds.reason);
    EXPECT_EQ(0U, bounds.is_certified);
}

TEST(Ace, growth_along_a_path_is_bounded)
{
    nav_params_t params;
    nav_params_default(&params);
    const nav_uncertainty_t start = {0.01, 0.004, 0.3};
    const nav_uncertainty_t near = nav_ace_grow(&params, &start, 1.0);
    const nav_uncertainty_t far = nav_ace_grow(&params, &start, 100.0);
    EXPECT_NEAR(0.01 + params.uncertainty_growth, near.position_m, 1e-12);
    EXPECT_NEAR(0.004 + params.uncertainty_yaw_growth_rad_per_m, near.yaw_rad, 1e-12);
    EXPECT_DOUBLE_EQ(params.uncertainty_position_max_m, far.position_m);
    EXPECT_DOUBLE_EQ(params.uncertainty_yaw_max_rad, far.yaw_rad);
    EXPECT_DOUBLE_EQ(0.3, far.global_position_m);
    const nav_uncertainty_t large = {0.5, 0.2, 0.0};
    EXPECT_DOUBLE_EQ(0.5, nav_ace_grow(&params, &large, 3.0).position_m);
    EXPECT_DOUBLE_EQ(0.2, nav_ace_grow(&params, &large, 3.0).yaw_rad);
}

TEST(Ace, a_belly_too_small_to_hold_a_cell_is_over_nothing_known)
{
    Scene scene(
        [](nav_params_t &params)
        {
            params.belly_front_x_m = 0.001;
            params.belly_rear_x_m = 0.0;
            params.belly_half_width_m = 0.05;
        });
    scene.show(flat);
    const nav_ace_bounds_t bounds = scene.ace(0.0, 0.0, 0.0);
    EXPECT_DOUBLE_EQ(1.0, bounds.belly_unknown);
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_UNKNOWN), bounds.reason);
}

TEST(Ace, an_uncertainty_too_large_to_bound_certifies_nothing)
{
    Scene scene;
    scene.show(flat);
    for (const nav_uncertainty_t &u :
         {nav_uncertainty_t{0.9, 0.0, 0.0}, nav_uncertainty_t{0.0, 0.5, 0.0}})
    {
        const nav_ace_bounds_t bounds = scene.ace(0.25, 0.25, 0.3, u);
        EXPECT_EQ(0U, bounds.is_certified);
        EXPECT_NE(static_cast<uint32_t>(NAV_REASON_NONE), bounds.reason);
    }
}

TEST(Ace, on_very_rough_ground_nothing_is_safe_and_what_is_certified_is_finite)
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> height(0.0, 0.6);
    Scene scene;
    scene.show([&](double, double) { return height(random); });
    for (double x = -8.0; x <= 8.0; x += 0.9)
    {
        for (double y = -8.0; y <= 8.0; y += 1.1)
        {
            const nav_ace_bounds_t bounds = scene.ace(x, y, x + y);
            EXPECT_NE(static_cast<uint32_t>(NAV_REASON_NONE), bounds.reason);
            EXPECT_TRUE(nav_isfinite(bounds.clearance_min_m));
            EXPECT_TRUE(nav_isfinite(bounds.tilt_max_rad));
        }
    }
}

TEST(Ace, on_ground_of_any_roughness_with_holes_bounds_are_finite)
{
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (double most_m : {0.1, 0.2, 0.3, 0.4})
    {
        Scene scene;
        /* cells of half a metre, some of them unknown */
        scene.show(
            [&](double x, double y)
            {
                const auto cell = static_cast<unsigned>((static_cast<int>(2.0 * (x + 20.0)) * 100) +
                                                        static_cast<int>(2.0 * (y + 20.0)));
                std::mt19937 height(cell);
                return most_m * unit(height);
            },
            [&](double, double) { return (random() % 8U == 0U) ? 1.0 : 0.0; });
        for (int k = 0; k < 800; k++)
        {
            const nav_uncertainty_t uncertainty = {0.1 * unit(random), 0.05 * unit(random), 0.0};
            const nav_ace_bounds_t bounds =
                scene.ace(16.0 * unit(random) - 8.0, 16.0 * unit(random) - 8.0, 6.0 * unit(random),
                          uncertainty);
            EXPECT_TRUE(nav_isfinite(bounds.clearance_min_m));
            EXPECT_TRUE(nav_isfinite(bounds.tilt_max_rad));
            EXPECT_TRUE(nav_isfinite(bounds.wheel_drop_max_m));
            EXPECT_TRUE((bounds.reason != NAV_REASON_NONE) || (bounds.is_certified == 1U));
        }
    }
}

TEST(Ace, towers_and_shafts_are_refused_at_once)
{
    std::mt19937 random(3);
    for (double height_m : {3.0, 50.0, 900.0})
    {
        Scene scene;
        scene.show(
            [&](double, double)
            { return (random() % 60U == 0U) ? height_m * ((random() % 2U) ? 1.0 : -1.0) : 0.0; });
        for (double yaw = -3.0; yaw < 3.0; yaw += 0.2)
        {
            /* a box as high as that would hold millions of lines of the grid */
            EXPECT_NE(NAV_REASON_NONE, scene.ace(0.3, -0.4, yaw).reason) << height_m << " " << yaw;
        }
    }
}

TEST(Ace, yaw_uncertainty_widens_the_bound_of_tilt_on_a_slope_with_rocks)
{
    Scene scene(refuse_all);
    scene.show([](double x, double y)
               { return (0.25 * x) + block(x, y, 1.2, -1.0, 0.4, 0.3, 0.25); });
    const double exact_rad = scene.ace(0.0, 0.0, 0.0).tilt_max_rad;
    const double uncertain_rad = scene.ace(0.0, 0.0, 0.0, {0.0, 0.05, 0.0}).tilt_max_rad;
    /* turning by 0.05 rad with the body leaning some 4 deg against the plane */
    EXPECT_GT(uncertain_rad, exact_rad + (0.05 * 0.05));
}

} // namespace
