// SPDX-License-Identifier: Apache-2.0
#include "nav_scene.hpp"

extern "C"
{
#include "nav_trial.h"
}

namespace
{

/// A round of tests among the stones of a scene.
class Trial : public ::testing::Test
{
  protected:
    void world(const Scene::Elevation &elevation, nav_mode_t mode = NAV_MODE_AVOID_ALL)
    {
        scene.show(elevation);
        tree_scene = scene.tree_scene();
        in.goal = scene.goal;
        in.mode = mode;
        request = nav_walk_request(&tree_scene, &in);
        trial = {&request, &scene.ctx->tree, false, 0U};
        nav_trial_begin(&trial);
    }

    nav_reason_t path(uint32_t index)
    {
        const nav_reason_t reason = nav_trial_first(&trial, index / NAV_TREE_ARCS);
        return (reason == NAV_REASON_NONE) ? nav_trial_second(&trial, index, &bounds) : reason;
    }

    Scene scene;
    nav_tree_scene_t tree_scene = {};
    nav_select_arc_in_t in = {};
    nav_request_t request = {};
    nav_trial_t trial = {};
    nav_ace_bounds_t bounds = {};
    static constexpr uint32_t STRAIGHT_FIRST = NAV_TREE_ARCS / 2;
    static constexpr uint32_t STRAIGHT = (STRAIGHT_FIRST * NAV_TREE_ARCS) + STRAIGHT_FIRST;
};

TEST_F(Trial, arcs_that_paths_share_are_tested_once)
{
    world(flat);
    EXPECT_EQ(NAV_REASON_NONE, path(STRAIGHT));
    EXPECT_EQ(24U, trial.ace_evaluations);
    EXPECT_EQ(NAV_REASON_NONE, path(STRAIGHT + 1U));
    EXPECT_EQ(36U, trial.ace_evaluations);
    EXPECT_EQ(NAV_REASON_NONE, nav_trial_first(&trial, STRAIGHT_FIRST));
    EXPECT_EQ(36U, trial.ace_evaluations);
    nav_trial_begin(&trial);
    EXPECT_EQ(NAV_REASON_NONE, nav_trial_first(&trial, STRAIGHT_FIRST));
    EXPECT_EQ(48U, trial.ace_evaluations);
}

TEST_F(Trial, what_was_refused_may_not_pass_and_what_was_not_tested_may)
{
    world(ring(4.0));
    EXPECT_TRUE(nav_trial_may_pass(&trial, STRAIGHT_FIRST));
    EXPECT_NE(NAV_REASON_NONE, nav_trial_first(&trial, STRAIGHT_FIRST));
    EXPECT_FALSE(nav_trial_may_pass(&trial, STRAIGHT_FIRST));
    EXPECT_TRUE(nav_trial_may_pass(&trial, STRAIGHT_FIRST + 1U));
    scene.ctx->tree.turn_verdict[0] = NAV_REASON_TILT;
    EXPECT_FALSE(nav_trial_may_pass(&trial, STRAIGHT_FIRST + 1U));
    EXPECT_EQ(NAV_REASON_TILT, path(STRAIGHT + NAV_TREE_ARCS));
}

TEST_F(Trial, bounds_are_the_worst_of_the_whole_path)
{
    /* a step up at 5 m: the first arc sees none of it */
    world([](double x, double) { return (x > 5.0) ? 0.12 : 0.0; });
    ASSERT_EQ(NAV_REASON_NONE, path(STRAIGHT));
    const nav_ace_bounds_t &first = scene.ctx->tree.first_bounds[STRAIGHT_FIRST];
    EXPECT_LT(bounds.clearance_min_m, first.clearance_min_m - 0.01);
    EXPECT_GT(bounds.pitch_max_rad, first.pitch_max_rad);
}

TEST(TrialOfScene, failures_of_ace_bar_the_headings_along_which_it_failed)
{
    Scene scene([](nav_params_t &params) { params.cost_barred_factor = 1.0; });
    scene.show([](double x, double y)
               { return ((x > 4.0) && (x < 4.3) && (std::fabs(y) < 3.0)) ? 0.5 : 0.0; });
    scene.select(NAV_MODE_AVOID_ALL);
    uint32_t failed = 0;
    for (const nav_cost_cell_t &cell : scene.ctx->costmap.cells)
    {
        failed += (cell.ace_failed_headings != 0U) ? 1U : 0U;
        EXPECT_TRUE((cell.ace_failed_headings == 0U) || (cell.ace_reason > NAV_REASON_KIOZ));
    }
    EXPECT_GT(failed, 0U);
}

} // namespace
