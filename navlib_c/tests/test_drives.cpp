// SPDX-License-Identifier: Apache-2.0
// Whole drives on known ground: arc after arc, each planned from where the one before ended.
#include "nav_scene.hpp"

extern "C"
{
#include "nav_arc.h"
}

namespace
{

nav_zone_t keep_out(double x_m, double y_m, double radius_m)
{
    nav_zone_t zone = {};
    zone.kind = NAV_ZONE_KEEP_OUT;
    zone.shape = NAV_ZONE_CIRCLE;
    zone.center_x_site_m = x_m;
    zone.center_y_site_m = y_m;
    zone.radius_m = radius_m;
    return zone;
}

class Drive
{
  public:
    explicit Drive(const std::function<void(nav_params_t &)> &change = {}) : scene(change)
    {
        in.mode = NAV_MODE_AVOID_ALL;
        in.time_s = scene.time_s;
    }

    nav_status_t select()
    {
        in.goal = scene.goal;
        in.time_s = scene.time_s;
        const nav_status_t status = nav_select_arc(scene.ctx.get(), &in, out.get());
        nav_stub_clear();
        return status;
    }

    void advance()
    {
        const nav_pose2_t start = {in.pose.x_site_m, in.pose.y_site_m, in.pose.yaw_rad};
        const nav_pose2_t end = nav_arc_pose(&start, &out->arc, 1.0);
        in.pose.x_site_m = end.x_m;
        in.pose.y_site_m = end.y_m;
        in.pose.yaw_rad = end.yaw_rad;
        in.steering = nav_arc_steering(&out->arc);
    }

    double distance_m() const
    {
        return std::hypot(scene.goal.x_site_m - in.pose.x_site_m,
                          scene.goal.y_site_m - in.pose.y_site_m);
    }

    /// Arcs driven until the goal is reached, or -1.
    int to_goal(int arcs_max = 60)
    {
        for (int arcs = 0; arcs < arcs_max; arcs++)
        {
            if (distance_m() <= scene.goal.radius_m)
            {
                return arcs;
            }
            if (select() != NAV_OK)
            {
                return -1;
            }
            advance();
        }
        return -1;
    }

    Scene scene;
    nav_select_arc_in_t in = {};
    std::unique_ptr<nav_select_arc_out_t> out = std::make_unique<nav_select_arc_out_t>();
};

TEST(Drives, every_goal_around_the_rover_is_reached_in_every_mode)
{
    for (uint32_t mode = 0; mode < NAV_MODE_COUNT; mode++)
    {
        for (double bearing = -3.0; bearing < 3.2; bearing += 0.7)
        {
            Drive drive;
            drive.in.mode = mode;
            drive.scene.goal = {9.0 * std::cos(bearing), 9.0 * std::sin(bearing), 0.8};
            drive.scene.show(flat);
            EXPECT_GT(drive.to_goal(), 7) << mode << " " << bearing;
        }
    }
}

TEST(Drives, goals_among_rocks_and_zones_are_reached_without_touching_a_zone)
{
    const auto rocks = [](double x, double y)
    {
        const bool is_rock = (std::hypot(x - 4.0, y - 0.2) < 0.5) ||
                             (std::hypot(x + 3.0, y - 2.0) < 0.4) || (std::hypot(x, y + 5.0) < 0.5);
        return (is_rock ? 0.5 : 0.0) + (0.03 * std::sin(x) * std::cos(1.3 * y));
    };
    for (double bearing = -3.0; bearing < 3.2; bearing += 0.7)
    {
        Drive drive;
        const nav_zone_t zone =
            keep_out(5.5 * std::cos(bearing + 0.2), 5.5 * std::sin(bearing + 0.2), 1.0);
        drive.scene.zones({zone});
        drive.scene.goal = {9.5 * std::cos(bearing), 9.5 * std::sin(bearing), 1.0};
        drive.scene.show(rocks);
        EXPECT_GT(drive.to_goal(), 6) << bearing;
    }
}

TEST(Drives, a_zone_put_across_the_rest_of_the_path_is_driven_round)
{
    for (double ahead_m : {2.5, 4.0, 5.5})
    {
        Drive drive;
        drive.scene.show(flat);
        ASSERT_EQ(NAV_OK, drive.select());
        drive.advance();
        drive.scene.zones({keep_out(ahead_m, 0.0, 0.6)});
        drive.scene.analyze();
        ASSERT_EQ(NAV_OK, drive.select());
        for (uint32_t k = 0; k < drive.out->path_point_count; k++)
        {
            const nav_point_t &point = drive.out->path_points[k];
            EXPECT_GE(std::hypot(point.x_m - ahead_m, point.y_m), 0.6);
        }
        EXPECT_GT(drive.to_goal(), 5) << ahead_m;
    }
}

TEST(Drives, a_rover_that_is_not_where_its_path_went_plans_afresh)
{
    for (double aside_m : {0.0, 0.3, 3.0})
    {
        for (double turned_rad : {0.0, 0.1, 1.0})
        {
            Drive drive;
            drive.scene.show(flat);
            ASSERT_EQ(NAV_OK, drive.select());
            drive.advance();
            drive.in.pose.y_site_m += aside_m;
            drive.in.pose.yaw_rad += turned_rad;
            EXPECT_GT(drive.to_goal(), 5) << aside_m << " " << turned_rad;
        }
    }
}

TEST(Drives, a_path_of_more_points_than_fit_is_shown_up_to_its_capacity)
{
    Drive drive([](nav_params_t &params) { params.pose_spacing_m = 0.05; });
    drive.scene.show(flat);
    ASSERT_EQ(NAV_OK, drive.select());
    EXPECT_EQ(static_cast<uint32_t>(NAV_PATH_POINTS_MAX), drive.out->path_point_count);
}

TEST(Drives, whole_arcs_may_be_driven_at_once)
{
    Drive drive([](nav_params_t &params) { params.execute_length_m = 3.0; });
    drive.scene.show(flat);
    EXPECT_EQ(4, drive.to_goal());
}

TEST(Drives, the_rest_of_a_path_may_compete_down_to_its_last_metre)
{
    for (double execute_m : {1.0, 3.0})
    {
        for (double bearing = -3.0; bearing < 3.2; bearing += 0.7)
        {
            Drive drive(
                [=](nav_params_t &params)
                {
                    params.keep_path_min_m = 0.0;
                    params.execute_length_m = execute_m;
                });
            drive.scene.goal = {11.0 * std::cos(bearing), 11.0 * std::sin(bearing), 0.5};
            drive.scene.show(flat);
            EXPECT_GT(drive.to_goal(), 3) << bearing;
        }
    }
}

TEST(Drives, a_rock_seen_across_the_rest_of_a_path_is_driven_round)
{
    for (double bearing : {0.0, 1.5, 3.0})
    {
        for (double ahead_m : {1.2, 2.5, 4.5})
        {
            Drive drive([](nav_params_t &params) { params.keep_path_min_m = 0.0; });
            drive.scene.goal = {11.0 * std::cos(bearing), 11.0 * std::sin(bearing), 0.5};
            drive.scene.show(flat);
            ASSERT_EQ(NAV_OK, drive.select());
            drive.advance();
            drive.scene.show(
                [=](double x, double y)
                {
                    const double dx = x - (ahead_m * std::cos(bearing));
                    const double dy = y - (ahead_m * std::sin(bearing));
                    return (std::hypot(dx, dy) < 0.4) ? 0.6 : 0.0;
                });
            for (int k = 0; (k < 3) && (drive.select() == NAV_OK); k++)
            {
                EXPECT_GE(drive.out->bounds.clearance_min_m,
                          drive.scene.ctx->params.leave_clearance_min_m);
                drive.advance();
            }
        }
    }
}

TEST(Drives, a_budget_of_one_pose_still_drives_on_level_ground)
{
    Drive drive([](nav_params_t &params) { params.ace_budget_poses = 1.0; });
    drive.scene.show(flat);
    EXPECT_GT(drive.to_goal(), 8);
}

TEST(Drives, guarded_evaluation_of_a_leaving_arc_uses_the_leave_limits_over_their_length_only)
{
    Scene scene;
    scene.show([](double x, double y)
               { return ((std::fabs(x - 0.4) < 0.15) && (std::fabs(y) < 0.15)) ? 0.28 : 0.0; });
    nav_evaluate_arc_in_t in = {};
    auto out = std::make_unique<nav_evaluate_arc_out_t>();
    in.time_s = scene.time_s;
    in.mode = NAV_MODE_AVOID_ALL;
    in.arc = {0.5, 0.0};
    ASSERT_EQ(NAV_OK, nav_evaluate_arc(scene.ctx.get(), &in, out.get()));
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_CLEARANCE), out->reason);
    in.is_leaving = 1;
    ASSERT_EQ(NAV_OK, nav_evaluate_arc(scene.ctx.get(), &in, out.get()));
    EXPECT_EQ(1U, out->is_safe);
    in.pose.x_site_m = -1.5;
    in.arc = {2.0, 0.0};
    ASSERT_EQ(NAV_OK, nav_evaluate_arc(scene.ctx.get(), &in, out.get()));
    EXPECT_EQ(0U, out->is_safe);
    nav_stub_clear();
}

} // namespace
