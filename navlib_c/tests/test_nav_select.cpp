// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include "nav_scene.hpp"

extern "C"
{
#include "nav_arc.h"
}

namespace
{

double distance_to(const nav_waydisc_t &goal, const nav_point_t &point)
{
    return std::hypot(goal.x_site_m - point.x_m, goal.y_site_m - point.y_m);
}

bool is_rock(double x_m, double y_m, double x, double y, double radius)
{
    return std::hypot(x_m - x, y_m - y) < radius;
}

TEST(Select, on_flat_ground_the_straight_path_is_selected_and_one_metre_of_it_driven)
{
    Scene scene;
    scene.show(flat);
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_DOUBLE_EQ(1.0, out->arc.length_m);
    EXPECT_DOUBLE_EQ(0.0, out->arc.heading_change_rad);
    EXPECT_EQ(24U, out->ace_evaluations);
    EXPECT_EQ(1U, out->paths_tested);
    EXPECT_NEAR(0.60, out->bounds.clearance_min_m, 0.02);
    EXPECT_NEAR(6.0, out->path_points[out->path_point_count - 1].x_m, 1e-5);
    EXPECT_GT(out->global_point_count, 5U);
    EXPECT_LT(distance_to(scene.goal, out->global_points[out->global_point_count - 1]), 1.6);
}

TEST(Select, every_path_has_one_verdict)
{
    Scene scene;
    scene.show([](double x, double y) { return is_rock(x, y, 4.0, 0.0, 0.5) ? 0.6 : 0.0; });
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    const uint32_t sum = std::accumulate(out->rejections, out->rejections + NAV_REASON_COUNT, 0U);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_PATHS), sum);
    EXPECT_EQ(1U, out->rejections[NAV_REASON_NONE]);
}

/// Distance at which the selected path passes the place (4, 0), m.
double passes_rock_m(const nav_select_arc_out_t &out)
{
    double nearest_m = 100.0;
    for (uint32_t k = 0; k < out.path_point_count; k++)
    {
        nearest_m = std::min(nearest_m, static_cast<double>(std::hypot(out.path_points[k].x_m - 4.0,
                                                                       out.path_points[k].y_m)));
    }
    return nearest_m;
}

TEST(Select, a_rock_ahead_is_driven_round_by_the_first_path_tested)
{
    Scene scene;
    scene.show([](double x, double y) { return is_rock(x, y, 4.0, 0.0, 0.5) ? 0.6 : 0.0; });
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_GT(passes_rock_m(*out), 0.5 + 0.7);
    EXPECT_EQ(1U, out->paths_tested);
}

TEST(Select, a_rock_that_bars_no_way_is_driven_round_once_ace_has_refused_it)
{
    Scene scene([](nav_params_t &params) { params.cost_barred_factor = 1.0; });
    scene.show([](double x, double y) { return is_rock(x, y, 4.0, 0.0, 0.5) ? 0.6 : 0.0; });
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_GT(passes_rock_m(*out), 0.5 + 0.7);
    EXPECT_GT(out->rejections[NAV_REASON_CLEARANCE] + out->rejections[NAV_REASON_WHEEL_DROP], 0U);
}

TEST(Select, a_rover_that_stands_in_the_waydisc_is_not_given_an_empty_arc)
{
    Scene scene;
    scene.goal = {0.2, 0.0, 1.0};
    scene.show(flat);
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_GT(out->arc.length_m + std::fabs(out->arc.heading_change_rad), 0.1);
    EXPECT_GE(out->path_point_count, 2U);
}

TEST(Select, an_enclosed_rover_has_no_path)
{
    Scene scene;
    scene.show(
        [](double x, double y)
        {
            const double r = std::hypot(x, y);
            return ((r > 2.2) && (r < 3.2)) ? 1.0 : 0.0;
        });
    const auto out = scene.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH);
    EXPECT_EQ(static_cast<uint32_t>(NAV_NO_PATH), out->status);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_NONE), out->path_index);
    EXPECT_EQ(0U, out->rejections[NAV_REASON_NONE]);
}

TEST(Select, the_budget_bounds_the_evaluations_of_candidates_and_the_tree_those_of_last_resorts)
{
    Scene scene([](nav_params_t &params) { params.ace_budget_poses = 50.0; });
    scene.show(ring(2.2));
    const auto out = scene.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH);
    EXPECT_GT(out->rejections[NAV_REASON_BUDGET], 0U);
    uint32_t last_resorts = NAV_TREE_ARCS * 4U;
    for (uint32_t turn = 0; turn < NAV_TREE_TURNS; turn++)
    {
        const nav_arc_t turning = {0.0, std::fmin(turn, NAV_TREE_TURNS - turn) * 360.0 * DEG /
                                            NAV_TREE_TURNS};
        last_resorts += NAV_TREE_ARCS * 12U + nav_arc_pose_count(&scene.ctx->params, &turning);
    }
    EXPECT_LE(out->ace_evaluations, 2U * (50U + 60U + last_resorts));
}

/// The tree's first arc straight on.
constexpr uint32_t STRAIGHT_FIRST = NAV_TREE_ARCS / 2;

/* last resorts: a first arc alone, an arc backwards */

TEST(Select, where_no_whole_path_passes_a_first_arc_does)
{
    Scene scene;
    scene.show(ring(5.0));
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_SHORT) + STRAIGHT_FIRST, out->path_index);
    EXPECT_DOUBLE_EQ(scene.ctx->tree.first_cost_s[STRAIGHT_FIRST], out->path_cost_s);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_PATHS), out->paths_tested);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_PATHS),
              std::accumulate(out->rejections, out->rejections + NAV_REASON_COUNT, 0U));
    EXPECT_EQ(0U, out->rejections[NAV_REASON_NONE]);
    EXPECT_EQ(0U, out->is_leaving);
    EXPECT_DOUBLE_EQ(1.0, out->arc.length_m);
    EXPECT_NEAR(3.0, out->path_points[out->path_point_count - 1].x_m, 1e-6);
    EXPECT_GE(out->bounds.clearance_min_m, scene.ctx->params.clearance_min_m);
}

TEST(Select, where_no_first_arc_passes_either_an_arc_backwards_does)
{
    Scene scene;
    scene.show(ring(4.0));
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_BACK) + STRAIGHT_FIRST, out->path_index);
    EXPECT_DOUBLE_EQ(-1.0, out->arc.length_m);
    EXPECT_EQ(0U, out->is_leaving);
    EXPECT_NEAR(-1.0, out->path_points[out->path_point_count - 1].x_m, 1e-6);
    EXPECT_EQ(0U, scene.ctx->tree.kept.is_kept);
    EXPECT_EQ(1U, scene.evaluate(out->arc.length_m, out->arc.heading_change_rad)->is_safe);
}

TEST(Select, last_resorts_come_again_under_the_leave_limits)
{
    const auto within_stones = [](double inner_m)
    {
        return [=](double x, double y)
        { return ring(inner_m)(x, y) + (is_rock(x, std::fabs(y), 0.0, 1.47, 0.17) ? 0.38 : 0.0); };
    };
    Scene scene;
    scene.show(within_stones(5.0));
    auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_SHORT) + STRAIGHT_FIRST, out->path_index);
    EXPECT_EQ(1U, out->is_leaving);
    EXPECT_GT(out->bounds.wheel_drop_max_m, scene.ctx->params.wheel_drop_max_m);
    scene.time_s = 2.0;
    scene.show(within_stones(4.0));
    out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_LE(static_cast<uint32_t>(NAV_TREE_BACK), out->path_index);
    EXPECT_EQ(1U, out->is_leaving);
    EXPECT_LT(out->arc.length_m, 0.0);
}

/// A zone that a rover at the origin must stay in, on flat ground: 6 m of path do not fit into 3.6 m,
/// nor 3 m into 2.5 m.
class Zone : public ::testing::Test
{
  protected:
    std::unique_ptr<nav_select_arc_out_t> within(double radius_m,
                                                 nav_mode_t mode,
                                                 nav_status_t expected = NAV_OK)
    {
        scene.zones({circle(NAV_ZONE_KEEP_IN, 0.0, 0.0, radius_m)});
        scene.show(flat);
        return scene.select(mode, expected);
    }

    Scene scene;
};

TEST_F(Zone, a_first_arc_costs_its_time_and_what_is_to_go_from_its_end)
{
    const auto out = within(3.6, NAV_MODE_AVOID_KOZ);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_SHORT) + STRAIGHT_FIRST, out->path_index);
    EXPECT_EQ(0U, out->paths_tested); /* each crosses the zone's border */
    const nav_arc_t arc = {3.0, 0.0};
    EXPECT_NEAR(nav_arc_duration_s(&scene.ctx->params, &arc) + out->cost_to_go_s, out->path_cost_s,
                1e-9);
    EXPECT_GT(out->cost_to_go_s, 0.0);
}

TEST_F(Zone, an_arc_backwards_costs_its_time_its_steering_and_what_is_to_go_from_its_end)
{
    const auto out = within(2.5, NAV_MODE_AVOID_KOZ);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_BACK) + STRAIGHT_FIRST, out->path_index);
    EXPECT_NEAR(nav_arc_duration_s(&scene.ctx->params, &out->arc) + out->cost_to_go_s,
                out->path_cost_s, 1e-9);
    EXPECT_GT(out->cost_to_go_s, 0.0);
}

TEST_F(Zone, a_mode_of_one_path_takes_no_last_resort)
{
    for (nav_mode_t mode : {NAV_MODE_UNGUARDED, NAV_MODE_GUARDED})
    {
        for (double radius_m : {2.5, 3.6})
        {
            const auto out = within(radius_m, mode, NAV_NO_PATH);
            EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_NONE), out->path_index);
            EXPECT_EQ(1U, out->paths_tested);
        }
    }
}

TEST_F(Zone, without_room_for_an_arc_there_is_no_path)
{
    const auto out = within(0.4, NAV_MODE_AVOID_KOZ, NAV_NO_PATH);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_NONE), out->path_index);
}

/* a rover that slipped to where no path passes gets away from there */

/// Stones of 38 cm against both middle wheels, which a turn in place does not move.
double stones_at_the_middle(double x, double y)
{
    return is_rock(x, std::fabs(y), 0.0, 1.47, 0.17) ? 0.38 : 0.0;
}

TEST(Select, a_rover_without_a_path_leaves_within_the_leave_limits)
{
    Scene scene;
    scene.show(stones_at_the_middle);
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(1U, out->is_leaving);
    EXPECT_GT(out->bounds.wheel_drop_max_m, scene.ctx->params.wheel_drop_max_m);
    EXPECT_LE(out->bounds.wheel_drop_max_m, scene.ctx->params.leave_wheel_drop_max_m);
    EXPECT_EQ(0U, scene.evaluate(out->arc.length_m, out->arc.heading_change_rad)->is_safe);
    nav_evaluate_arc_in_t in = {};
    auto verdict = std::make_unique<nav_evaluate_arc_out_t>();
    in.time_s = scene.time_s;
    in.arc = out->arc;
    in.mode = NAV_MODE_AVOID_ALL;
    in.is_leaving = 1;
    ASSERT_EQ(NAV_OK, nav_evaluate_arc(scene.ctx.get(), &in, verdict.get()));
    EXPECT_EQ(1U, verdict->is_safe);
}

TEST(Select, beyond_the_leave_limits_there_is_no_leaving)
{
    Scene scene([](nav_params_t &params) { params.leave_wheel_drop_max_m = 0.36; });
    scene.show(stones_at_the_middle);
    EXPECT_EQ(0U, scene.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH)->is_leaving);
}

TEST(Select, where_a_path_passes_the_leave_limits_are_not_used)
{
    Scene scene;
    scene.show(flat);
    EXPECT_EQ(0U, scene.select(NAV_MODE_AVOID_ALL)->is_leaving);
}

/* the four modes of SIM, on one scene: a zone and a rock on the straight line */

class Modes : public ::testing::Test
{
  protected:
    void world(bool has_rock, bool has_zone)
    {
        scene.zones(has_zone ? std::vector<nav_zone_t>{circle(NAV_ZONE_KEEP_OUT, 4.0, 0.0, 0.8)}
                             : std::vector<nav_zone_t>{});
        scene.show([=](double x, double y)
                   { return (has_rock && is_rock(x, y, 4.0, 0.0, 0.4)) ? 0.45 : 0.0; });
    }

    Scene scene;
};

TEST_F(Modes, unguarded_drives_over_the_rock)
{
    world(true, false);
    const auto out = scene.select(NAV_MODE_UNGUARDED);
    EXPECT_DOUBLE_EQ(0.0, out->arc.heading_change_rad);
    EXPECT_EQ(0U, out->ace_evaluations);
}

TEST_F(Modes, unguarded_refuses_at_the_zone_without_another_try)
{
    world(false, true);
    const auto out = scene.select(NAV_MODE_UNGUARDED, NAV_NO_PATH);
    EXPECT_EQ(1U, out->rejections[NAV_REASON_KIOZ]);
    EXPECT_EQ(1U, out->paths_tested);
}

TEST_F(Modes, guarded_refuses_at_the_rock_without_another_try)
{
    world(true, false);
    const auto out = scene.select(NAV_MODE_GUARDED, NAV_NO_PATH);
    EXPECT_EQ(1U, out->paths_tested);
    EXPECT_GT(out->rejections[NAV_REASON_CLEARANCE] + out->rejections[NAV_REASON_WHEEL_DROP], 0U);
}

TEST_F(Modes, guarded_drives_where_nothing_is_in_the_way)
{
    world(false, false);
    EXPECT_DOUBLE_EQ(1.0, scene.select(NAV_MODE_GUARDED)->arc.length_m);
}

TEST_F(Modes, avoid_koz_goes_round_the_zone_and_ignores_the_rock)
{
    world(true, true);
    const auto out = scene.select(NAV_MODE_AVOID_KOZ);
    EXPECT_EQ(0U, out->ace_evaluations);
    for (uint32_t k = 0; k < out->path_point_count; k++)
    {
        EXPECT_GE(std::hypot(out->path_points[k].x_m - 4.0, out->path_points[k].y_m), 0.8);
    }
    world(true, false);
    EXPECT_DOUBLE_EQ(0.0, scene.select(NAV_MODE_AVOID_KOZ)->arc.heading_change_rad);
}

TEST_F(Modes, avoid_all_goes_round_both)
{
    world(true, true);
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_GT(out->ace_evaluations, 0U);
    for (uint32_t k = 0; k < out->path_point_count; k++)
    {
        EXPECT_GE(std::hypot(out->path_points[k].x_m - 4.0, out->path_points[k].y_m), 0.8);
    }
}

TEST_F(Modes, a_goal_off_the_map_is_driven_towards)
{
    scene.goal = {60.0, 0.0, 1.0};
    world(false, false);
    for (nav_mode_t mode : {NAV_MODE_UNGUARDED, NAV_MODE_AVOID_KOZ, NAV_MODE_AVOID_ALL})
    {
        const auto out = scene.select(mode);
        EXPECT_DOUBLE_EQ(1.0, out->arc.length_m);
        EXPECT_NEAR(0.0, out->arc.heading_change_rad, 0.1);
    }
}

} // namespace
