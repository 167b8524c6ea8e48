// SPDX-License-Identifier: Apache-2.0
#include <numeric>

#include "nav_scene.hpp"

extern "C"
{
#include "nav_arc.h"
}

namespace
{

TEST(Show, a_goal_behind_is_reached_by_turning_in_place_one_step_of_the_tree_first)
{
    Scene scene;
    scene.goal = {-10.0, 0.3, 1.0};
    scene.show(flat);
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_DOUBLE_EQ(0.0, out->arc.length_m);
    EXPECT_NEAR(360.0 / NAV_TREE_TURNS * DEG, std::fabs(out->arc.heading_change_rad), 1e-9);
}

TEST(Show, a_path_ends_where_it_enters_the_waydisc)
{
    Scene scene;
    scene.goal = {1.6, 0.0, 1.0};
    scene.show(flat);
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_NEAR(0.75, out->arc.length_m, 1e-9);
    EXPECT_DOUBLE_EQ(0.0, out->cost_to_go_s);
    EXPECT_EQ(3U, out->ace_evaluations);
    EXPECT_EQ(0U, out->global_point_count);
}

TEST(Show, the_rest_of_a_path_is_driven_where_the_tree_holds_no_other)
{
    Scene scene;
    scene.show(flat);
    scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(1U, scene.ctx->tree.kept.is_kept);
    EXPECT_DOUBLE_EQ(2.0, scene.ctx->tree.kept.first.length_m);
    /* driven: the rest begins where it was expected, and is the cheapest way to go on straight */
    nav_select_arc_in_t in = {};
    auto out = std::make_unique<nav_select_arc_out_t>();
    in.time_s = scene.time_s;
    in.goal = scene.goal;
    in.mode = NAV_MODE_AVOID_ALL;
    in.pose.x_site_m = 1.0;
    ASSERT_EQ(NAV_OK, nav_select_arc(scene.ctx.get(), &in, out.get()));
    EXPECT_DOUBLE_EQ(1.0, out->arc.length_m);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_CANDIDATES),
              std::accumulate(out->rejections, out->rejections + NAV_REASON_COUNT, 0U));
    /* elsewhere it is of no use */
    in.pose.x_site_m = 0.0;
    in.pose.y_site_m = 3.0;
    ASSERT_EQ(NAV_OK, nav_select_arc(scene.ctx.get(), &in, out.get()));
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_PATHS),
              std::accumulate(out->rejections, out->rejections + NAV_REASON_COUNT, 0U));
}

TEST(Show, the_rest_of_a_first_arc_is_kept)
{
    Scene scene;
    scene.zones({circle(NAV_ZONE_KEEP_IN, 0.0, 0.0, 3.6)}); /* no room for 6 m */
    scene.show(flat);
    scene.select(NAV_MODE_AVOID_KOZ);
    EXPECT_EQ(1U, scene.ctx->tree.kept.is_kept);
    EXPECT_DOUBLE_EQ(2.0, scene.ctx->tree.kept.first.length_m);
    EXPECT_DOUBLE_EQ(0.0, scene.ctx->tree.kept.second.length_m);
    nav_select_arc_in_t in = {};
    auto out = std::make_unique<nav_select_arc_out_t>();
    in.time_s = scene.time_s;
    in.goal = scene.goal;
    in.mode = NAV_MODE_AVOID_KOZ;
    in.pose.x_site_m = 1.0;
    ASSERT_EQ(NAV_OK, nav_select_arc(scene.ctx.get(), &in, out.get()));
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_PATHS), out->path_index);
    EXPECT_DOUBLE_EQ(1.0, out->arc.length_m);
    EXPECT_DOUBLE_EQ(scene.ctx->tree.path_cost_s[NAV_TREE_PATHS], out->path_cost_s);
}

TEST(Show, a_turn_that_is_left_of_a_first_arc_alone_is_kept_with_it)
{
    Scene scene;
    scene.goal = {-12.0, 0.3, 1.0};
    scene.zones({circle(NAV_ZONE_KEEP_IN, 0.0, 0.0, 3.6)});
    scene.show(flat);
    const auto out = scene.select(NAV_MODE_AVOID_KOZ);
    EXPECT_GE(out->path_index, static_cast<uint32_t>(NAV_TREE_SHORT));
    EXPECT_DOUBLE_EQ(0.0, out->arc.length_m);
    const nav_path_t &kept = scene.ctx->tree.kept;
    EXPECT_EQ(1U, kept.is_kept);
    EXPECT_DOUBLE_EQ(3.0, kept.first.length_m);
    EXPECT_GT(std::fabs(kept.turn.heading_change_rad), 1.0);
}

} // namespace
