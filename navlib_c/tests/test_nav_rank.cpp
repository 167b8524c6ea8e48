// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "nav_scene.hpp"

extern "C"
{
#include "nav_rank.h"
}

namespace
{

/// The tree's path that goes straight on.
constexpr uint32_t STRAIGHT_FIRST = NAV_TREE_ARCS / 2;
constexpr uint32_t STRAIGHT = (STRAIGHT_FIRST * NAV_TREE_ARCS) + STRAIGHT_FIRST;

TEST(Rank, paths_are_ordered_by_cost)
{
    Scene scene;
    scene.show([](double x, double y) { return 0.05 * std::sin(3.0 * x) * std::cos(2.0 * y); });
    scene.select(NAV_MODE_AVOID_ALL);
    const nav_tree_t &tree = scene.ctx->tree;
    std::vector<bool> is_seen(NAV_TREE_PATHS, false);
    for (int k = 0; k < NAV_TREE_PATHS; k++)
    {
        is_seen[tree.order[k]] = true;
        if (k > 0)
        {
            EXPECT_LE(tree.path_cost_s[tree.order[k - 1]], tree.path_cost_s[tree.order[k]]);
        }
    }
    EXPECT_TRUE(std::all_of(is_seen.begin(), is_seen.end(), [](bool seen) { return seen; }));
}

TEST(Rank, paths_that_lead_away_are_rejected_as_negative_progress)
{
    Scene scene([](nav_params_t &params) { params.negative_progress_max_m = 1.0; });
    scene.show(flat);
    const auto out = scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_GT(out->rejections[NAV_REASON_NEGATIVE_PROGRESS], 300U);
}

TEST(Rank, poses_on_a_cell_barred_along_their_heading_cost_the_factor_as_much)
{
    Scene scene;
    scene.show(flat);
    scene.select(NAV_MODE_AVOID_ALL);
    const double plain_s = scene.ctx->tree.path_cost_s[STRAIGHT];
    uint32_t index = 0;
    ASSERT_TRUE(nav_costmap_find(&scene.ctx->costmap, 2.1, 0.0, &index));
    nav_cost_cell_t &cell = scene.ctx->costmap.cells[index];
    /* poses 0.25 m apart: two of them on the cell */
    const double dearer_s = 0.5 * cell.cost_s_per_m * (scene.ctx->params.cost_barred_factor - 1.0);
    cell.barred_headings = 0b1110U;
    scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_NEAR(plain_s, scene.ctx->tree.path_cost_s[STRAIGHT], 1e-9);
    cell.barred_headings = 0b0001U;
    scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_NEAR(plain_s + dearer_s, scene.ctx->tree.path_cost_s[STRAIGHT], 1e-6);
    cell.barred_headings = 0U;
    cell.ace_failed_headings = 0b0001U;
    scene.select(NAV_MODE_AVOID_ALL);
    EXPECT_NEAR(plain_s + dearer_s, scene.ctx->tree.path_cost_s[STRAIGHT], 1e-6);
    scene.select(NAV_MODE_AVOID_KOZ);
    const double zones_only_s = scene.ctx->tree.path_cost_s[STRAIGHT];
    cell.ace_failed_headings = 0U;
    scene.select(NAV_MODE_AVOID_KOZ);
    EXPECT_DOUBLE_EQ(zones_only_s, scene.ctx->tree.path_cost_s[STRAIGHT]);
}

TEST(Rank, a_path_into_an_enclosure_has_the_reason_of_its_last_cell_or_is_unexpected)
{
    Scene scene;
    scene.show(flat);
    const nav_tree_scene_t tree_scene = scene.tree_scene();
    nav_select_arc_in_t in = {};
    in.goal = scene.goal;
    in.mode = NAV_MODE_AVOID_ALL;
    const nav_request_t request = nav_walk_request(&tree_scene, &in);
    uint32_t index = 0;
    ASSERT_TRUE(nav_costmap_find(&scene.ctx->costmap, 5.1, 0.1, &index));
    nav_cost_cell_t &cell = scene.ctx->costmap.cells[index];
    for (int row = -1; row <= 1; row++)
    {
        for (int col = -1; col <= 1; col++)
        {
            (&cell)[row * NAV_COSTMAP_SIZE + col].is_forbidden =
                static_cast<uint8_t>((row != 0) || (col != 0));
        }
    }
    nav_global_plan(&scene.ctx->global, &scene.ctx->costmap, &scene.ctx->params, &in.goal, true,
                    true);
    const nav_branch_t leaf = {{5.1, 0.1, 0.0}, 10.0, 12U, false, NAV_REASON_NONE};
    double cost_s = 0.0;
    EXPECT_EQ(NAV_REASON_UNEXPECTED, nav_rank_path(&request, 0.0, &leaf, &cost_s));
    EXPECT_EQ(NAV_COST_INFINITE, cost_s);
    cell.ace_failed_headings = 0xFU;
    cell.ace_reason = NAV_REASON_WHEEL_DROP;
    EXPECT_EQ(NAV_REASON_WHEEL_DROP, nav_rank_path(&request, 0.0, &leaf, &cost_s));
    /* so far off the map that no cost is finite */
    const nav_branch_t far = {{1.0e15, 0.0, 0.0}, 10.0, 12U, false, NAV_REASON_NONE};
    nav_select_arc_in_t away = in;
    away.goal.x_site_m = -1.0e15;
    nav_request_t beyond = nav_walk_request(&tree_scene, &away);
    beyond.start_distance_m = 4.0e15;
    EXPECT_EQ(NAV_REASON_UNEXPECTED, nav_rank_path(&beyond, 0.0, &far, &cost_s));
}

} // namespace
