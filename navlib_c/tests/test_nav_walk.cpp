// SPDX-License-Identifier: Apache-2.0
#include "nav_scene.hpp"

extern "C"
{
#include "nav_walk.h"
}

namespace
{

class Walk : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        scene.show(flat);
        tree_scene = scene.tree_scene();
        in.goal = scene.goal;
        in.mode = NAV_MODE_AVOID_ALL;
    }

    nav_request_t request() const
    {
        return nav_walk_request(&tree_scene, &in);
    }

    Scene scene;
    nav_tree_scene_t tree_scene = {};
    nav_select_arc_in_t in = {};
    const nav_pose2_t start = {1.0, -2.0, 0.7};
};

TEST_F(Walk, a_mode_decides_what_costs_and_what_is_tested)
{
    const struct
    {
        nav_mode_t mode;
        bool terrain_cost, zone_cost, terrain_test, one_path;
    } modes[] = {{NAV_MODE_UNGUARDED, false, false, false, true},
                 {NAV_MODE_GUARDED, false, false, true, true},
                 {NAV_MODE_AVOID_KOZ, false, true, false, false},
                 {NAV_MODE_AVOID_ALL, true, true, true, false}};
    for (const auto &expected : modes)
    {
        in.mode = expected.mode;
        EXPECT_EQ(expected.terrain_cost, request().use_terrain_cost);
        EXPECT_EQ(expected.zone_cost, request().use_zone_cost);
        EXPECT_EQ(expected.terrain_test, request().test_terrain);
        EXPECT_EQ(expected.one_path, request().is_one_path);
    }
    EXPECT_DOUBLE_EQ(12.0, request().start_distance_m);
}

TEST_F(Walk, an_arc_of_the_tree_is_the_same_walked_as_any_arc)
{
    const nav_request_t here = request();
    for (uint32_t k = 0; k < NAV_TREE_ARCS; k++)
    {
        const nav_arc_t arc = nav_walk_tree_arc(&here, k);
        const nav_walk_t of_tree = nav_walk_tree(&here, &start, k);
        const nav_walk_t of_arc = nav_walk_arc(&here, &start, &arc);
        ASSERT_EQ(of_arc.pose_count, of_tree.pose_count);
        EXPECT_DOUBLE_EQ(of_arc.spacing_m, of_tree.spacing_m);
        for (uint32_t place = 0; place < of_arc.pose_count; place++)
        {
            const nav_pose2_t expected = nav_walk_pose(&of_arc, place);
            const nav_pose2_t pose = nav_walk_pose(&of_tree, place);
            EXPECT_NEAR(expected.x_m, pose.x_m, 1e-9);
            EXPECT_NEAR(expected.y_m, pose.y_m, 1e-9);
            EXPECT_NEAR(expected.yaw_rad, pose.yaw_rad, 1e-9);
        }
    }
}

TEST_F(Walk, an_empty_arc_has_no_poses_and_costs_nothing)
{
    const nav_request_t here = request();
    const nav_arc_t none = {};
    const nav_walk_t walk = nav_walk_arc(&here, &start, &none);
    const nav_branch_t branch = nav_walk_follow(&here, &walk);
    EXPECT_EQ(0U, walk.pose_count);
    EXPECT_DOUBLE_EQ(0.0, branch.cost_s);
    EXPECT_DOUBLE_EQ(start.x_m, branch.end.x_m);
}

TEST_F(Walk, an_arc_backwards_leads_back_along_what_is_driven_of_the_same_arc_forwards)
{
    const nav_request_t here = request();
    for (uint32_t k = 0; k < NAV_TREE_ARCS; k++)
    {
        const nav_arc_t back = nav_walk_back_arc(&here, k);
        const nav_arc_t forward = nav_walk_tree_arc(&here, k);
        EXPECT_DOUBLE_EQ(-1.0, back.length_m);
        EXPECT_NEAR(-forward.heading_change_rad / 3.0, back.heading_change_rad, 1e-12);
        const nav_walk_t walk = nav_walk_arc(&here, &start, &back);
        EXPECT_DOUBLE_EQ(0.25, walk.spacing_m);
        const nav_branch_t branch = nav_walk_follow(&here, &walk);
        EXPECT_NEAR(nav_arc_duration_s(here.params, &back), branch.cost_s, 1e-5);
        EXPECT_LT(std::cos(start.yaw_rad) * (branch.end.x_m - start.x_m) +
                      std::sin(start.yaw_rad) * (branch.end.y_m - start.y_m),
                  -0.9);
    }
}

TEST_F(Walk, following_ends_at_the_waydisc)
{
    in.goal = {start.x_m + std::cos(0.7) * 2.0, start.y_m + std::sin(0.7) * 2.0, 1.1};
    const nav_request_t here = request();
    const nav_walk_t walk = nav_walk_tree(&here, &start, NAV_TREE_ARCS / 2);
    const nav_branch_t branch = nav_walk_follow(&here, &walk);
    EXPECT_TRUE(branch.is_at_goal);
    EXPECT_EQ(4U, branch.pose_count);
}

TEST_F(Walk, following_names_the_first_infinite_cell_but_none_that_ace_closed)
{
    const nav_request_t here = request();
    const nav_walk_t walk = nav_walk_tree(&here, &start, NAV_TREE_ARCS / 2);
    const nav_pose2_t middle = nav_walk_pose(&walk, 5U);
    uint32_t index = 0;
    ASSERT_TRUE(nav_costmap_find(&scene.ctx->costmap, middle.x_m, middle.y_m, &index));
    nav_cost_cell_t &cell = scene.ctx->costmap.cells[index];
    cell.ace_failed_headings = 0xFU;
    cell.ace_reason = NAV_REASON_CLEARANCE;
    EXPECT_EQ(NAV_REASON_NONE, nav_walk_follow(&here, &walk).reason);
    cell.terrain_reason = NAV_REASON_TILT;
    EXPECT_EQ(NAV_REASON_TILT, nav_walk_follow(&here, &walk).reason);
}

} // namespace
