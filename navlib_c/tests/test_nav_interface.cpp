// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <limits>

#include "nav_scene.hpp"

namespace
{

constexpr double NAN_D = std::numeric_limits<double>::quiet_NaN();
constexpr double INF = std::numeric_limits<double>::infinity();

/// Kinds of the records captured since the last clear, in order.
std::vector<uint32_t> captured()
{
    std::vector<uint32_t> kinds;
    const uint8_t *data = nav_stub_data();
    for (uint32_t at = 0; at < nav_stub_size();)
    {
        nav_stub_header_t header;
        std::memcpy(&header, data + at, sizeof(header));
        kinds.push_back(header.kind);
        at += static_cast<uint32_t>(sizeof(header)) + ((header.size_bytes + 7U) / 8U) * 8U;
    }
    return kinds;
}

class Interface : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        scene.show(flat);
        nav_stub_clear();
        cloud = std::make_unique<nav_process_disparity_in_t>();
        cloud->image_id = 1000;
        cloud->chunk_count = 1;
        cloud->point_count = 1;
        select.time_s = evaluate.time_s = analyze.time_s = zones.time_s = 5.0;
        select.goal = analyze.goal = {10.0, 0.0, 1.0};
        select.mode = evaluate.mode = NAV_MODE_AVOID_ALL;
        evaluate.arc = {1.0, 0.0};
    }

    /// The call is refused with the status, reported, and changes nothing in the context.
    template <typename In, typename Out>
    void refused(nav_status_t status,
                 nav_status_t (*call)(nav_ctx_t *, const In *, Out *),
                 const In &in)
    {
        auto before = std::make_unique<nav_ctx_t>(*scene.ctx);
        auto out = std::make_unique<Out>();
        nav_stub_clear();
        EXPECT_EQ(status, call(scene.ctx.get(), &in, out.get()));
        EXPECT_EQ(static_cast<uint32_t>(status), out->status);
        EXPECT_EQ(0, std::memcmp(before.get(), scene.ctx.get(), sizeof(nav_ctx_t)));
        const std::vector<uint32_t> kinds = captured();
        EXPECT_GE(kinds.size(), 3U);
        EXPECT_EQ(NAV_DP_EVR, static_cast<int>(kinds[kinds.size() - 2]));
    }

    Scene scene;
    std::unique_ptr<nav_process_disparity_in_t> cloud;
    nav_analyze_terrain_in_t analyze = {};
    nav_select_arc_in_t select = {};
    nav_evaluate_arc_in_t evaluate = {};
    nav_set_kioz_in_t zones = {};
};

TEST_F(Interface, null_pointers_are_refused_one_at_a_time)
{
    nav_ctx_t *ctx = scene.ctx.get();
    auto init_in = std::make_unique<nav_init_in_t>();
    nav_init_out_t init_out;
    EXPECT_EQ(NAV_NULL_POINTER, nav_init(nullptr, init_in.get(), &init_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_init(ctx, nullptr, &init_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_init(ctx, init_in.get(), nullptr));
    nav_set_kioz_out_t kioz_out;
    EXPECT_EQ(NAV_NULL_POINTER, nav_set_kioz(nullptr, &zones, &kioz_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_set_kioz(ctx, nullptr, &kioz_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_set_kioz(ctx, &zones, nullptr));
    nav_process_disparity_out_t cloud_out;
    EXPECT_EQ(NAV_NULL_POINTER, nav_process_disparity(nullptr, cloud.get(), &cloud_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_process_disparity(ctx, nullptr, &cloud_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_process_disparity(ctx, cloud.get(), nullptr));
    nav_analyze_terrain_out_t analyze_out;
    EXPECT_EQ(NAV_NULL_POINTER, nav_analyze_terrain(nullptr, &analyze, &analyze_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_analyze_terrain(ctx, nullptr, &analyze_out));
    EXPECT_EQ(NAV_NULL_POINTER, nav_analyze_terrain(ctx, &analyze, nullptr));
    auto select_out = std::make_unique<nav_select_arc_out_t>();
    EXPECT_EQ(NAV_NULL_POINTER, nav_select_arc(nullptr, &select, select_out.get()));
    EXPECT_EQ(NAV_NULL_POINTER, nav_select_arc(ctx, nullptr, select_out.get()));
    EXPECT_EQ(NAV_NULL_POINTER, nav_select_arc(ctx, &select, nullptr));
    auto evaluate_out = std::make_unique<nav_evaluate_arc_out_t>();
    EXPECT_EQ(NAV_NULL_POINTER, nav_evaluate_arc(nullptr, &evaluate, evaluate_out.get()));
    EXPECT_EQ(NAV_NULL_POINTER, nav_evaluate_arc(ctx, nullptr, evaluate_out.get()));
    EXPECT_EQ(NAV_NULL_POINTER, nav_evaluate_arc(ctx, &evaluate, nullptr));
}

TEST_F(Interface, a_context_that_was_not_initialized_is_refused)
{
    scene.ctx = std::make_unique<nav_ctx_t>();
    refused(NAV_NOT_INITIALIZED, nav_set_kioz, zones);
    refused(NAV_NOT_INITIALIZED, nav_process_disparity, *cloud);
    refused(NAV_NOT_INITIALIZED, nav_analyze_terrain, analyze);
    refused(NAV_NOT_INITIALIZED, nav_select_arc, select);
    refused(NAV_NOT_INITIALIZED, nav_evaluate_arc, evaluate);
}

TEST_F(Interface, calls_before_what_they_depend_on_are_refused)
{
    Scene fresh;
    scene.ctx = std::make_unique<nav_ctx_t>(*fresh.ctx);
    refused(NAV_ORDER, nav_analyze_terrain, analyze);
    refused(NAV_ORDER, nav_select_arc, select);
    refused(NAV_ORDER, nav_evaluate_arc, evaluate);
}

TEST_F(Interface, time_must_not_run_backwards)
{
    zones.time_s = analyze.time_s = select.time_s = evaluate.time_s = 0.5;
    refused(NAV_ORDER, nav_set_kioz, zones);
    refused(NAV_ORDER, nav_analyze_terrain, analyze);
    refused(NAV_ORDER, nav_select_arc, select);
    refused(NAV_ORDER, nav_evaluate_arc, evaluate);
}

TEST_F(Interface, numbers_that_are_not_finite_are_refused_wherever_they_stand)
{
    for (double bad : {NAN_D, INF, -INF})
    {
        for (size_t k = 0; k < sizeof(select) / sizeof(double) - 2U; k++)
        {
            nav_select_arc_in_t in = select;
            reinterpret_cast<double *>(&in)[k] = bad;
            refused(NAV_NOT_FINITE, nav_select_arc, in);
        }
        for (size_t k = 0; k < sizeof(evaluate) / sizeof(double) - 1U; k++)
        {
            nav_evaluate_arc_in_t in = evaluate;
            reinterpret_cast<double *>(&in)[k] = bad;
            refused(NAV_NOT_FINITE, nav_evaluate_arc, in);
        }
        for (size_t k = 0; k < sizeof(analyze) / sizeof(double); k++)
        {
            nav_analyze_terrain_in_t in = analyze;
            reinterpret_cast<double *>(&in)[k] = bad;
            refused(NAV_NOT_FINITE, nav_analyze_terrain, in);
        }
        for (size_t k = 0; k < 7U; k++)
        {
            nav_process_disparity_in_t in = *cloud;
            reinterpret_cast<double *>(&in)[k] = bad;
            refused(NAV_NOT_FINITE, nav_process_disparity, in);
        }
        nav_set_kioz_in_t in = zones;
        in.time_s = bad;
        refused(NAV_NOT_FINITE, nav_set_kioz, in);
        cloud->points[0].z_m = static_cast<float>(bad);
        refused(NAV_NOT_FINITE, nav_process_disparity, *cloud);
    }
}

TEST_F(Interface, values_beyond_their_range_are_refused)
{
    select.mode = NAV_MODE_COUNT;
    refused(NAV_OUT_OF_RANGE, nav_select_arc, select);
    select.mode = NAV_MODE_GUARDED;
    select.uncertainty.position_m = -1e-9;
    refused(NAV_OUT_OF_RANGE, nav_select_arc, select);
    evaluate.arc.length_m = 10.1;
    refused(NAV_OUT_OF_RANGE, nav_evaluate_arc, evaluate);
    analyze.goal.radius_m = -1.0;
    refused(NAV_OUT_OF_RANGE, nav_analyze_terrain, analyze);
    cloud->pose.pitch_rad = 1.6;
    refused(NAV_OUT_OF_RANGE, nav_process_disparity, *cloud);
}

TEST_F(Interface, counts_that_do_not_fit_are_refused)
{
    cloud->point_count = NAV_CHUNK_POINTS_MAX + 1;
    refused(NAV_COUNT, nav_process_disparity, *cloud);
    cloud->point_count = std::numeric_limits<uint32_t>::max();
    refused(NAV_COUNT, nav_process_disparity, *cloud);
    cloud->point_count = 1;
    cloud->chunk_count = 0;
    refused(NAV_COUNT, nav_process_disparity, *cloud);
    zones.zone_count = NAV_ZONES_MAX + 1;
    refused(NAV_COUNT, nav_set_kioz, zones);
}

TEST_F(Interface, chunks_out_of_order_are_refused)
{
    nav_process_disparity_out_t out;
    cloud->chunk_count = 3;
    cloud->chunk_index = 1;
    refused(NAV_ORDER, nav_process_disparity, *cloud);
    cloud->chunk_index = 0;
    ASSERT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
    refused(NAV_ORDER, nav_process_disparity, *cloud);
    cloud->chunk_index = 2;
    refused(NAV_ORDER, nav_process_disparity, *cloud);
    cloud->chunk_index = 1;
    ASSERT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
    cloud->image_id++;
    cloud->chunk_index = 0;
    EXPECT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
}

TEST_F(Interface, an_empty_cloud_is_fine_and_merges_nothing)
{
    nav_process_disparity_out_t out;
    cloud->point_count = 0;
    EXPECT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
    EXPECT_EQ(0U, out.merged_count);
}

TEST_F(Interface, points_outside_the_map_are_counted)
{
    nav_process_disparity_out_t out;
    cloud->point_count = 2;
    cloud->points[0] = {1.0F, 1.0F, 0.0F};
    cloud->points[1] = {40.0F, 1.0F, 0.0F};
    EXPECT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
    EXPECT_EQ(1U, out.merged_count);
    EXPECT_EQ(1U, out.outside_count);
}

TEST_F(Interface, a_bad_zone_is_named_and_the_old_zones_stay)
{
    nav_zone_t good = {};
    good.shape = NAV_ZONE_CIRCLE;
    good.radius_m = 1.0;
    scene.zones({good});
    zones.zone_count = 2;
    zones.zones[0] = good;
    zones.zones[1] = good;
    zones.zones[1].radius_m = 0.0;
    refused(NAV_ZONE, nav_set_kioz, zones);
    nav_set_kioz_out_t out;
    nav_set_kioz(scene.ctx.get(), &zones, &out);
    EXPECT_EQ(1U, out.refused_index);
    EXPECT_EQ(1U, scene.ctx->kioz.zone_count);
}

TEST_F(Interface, a_bad_parameter_is_named_and_leaves_the_context_as_it_was)
{
    auto in = std::make_unique<nav_init_in_t>();
    nav_params_t params;
    nav_params_default(&params);
    std::copy_n(reinterpret_cast<const double *>(&params), NAV_PARAM_COUNT, in->params);
    in->params[0] = NAN_D;
    refused(NAV_PARAMETER_RANGE, nav_init, *in);
    nav_init_out_t out;
    nav_init(scene.ctx.get(), in.get(), &out);
    EXPECT_EQ(0U, out.refused_index);
    in->params[0] = params.heightmap_cell_m;
    in->time_s = INF;
    refused(NAV_NOT_FINITE, nav_init, *in);
}

TEST_F(Interface, initializing_again_forgets_everything)
{
    Scene fresh;
    auto in = std::make_unique<nav_init_in_t>();
    nav_init_out_t out;
    std::copy_n(reinterpret_cast<const double *>(&scene.ctx->params), NAV_PARAM_COUNT, in->params);
    ASSERT_EQ(NAV_OK, nav_init(scene.ctx.get(), in.get(), &out));
    EXPECT_EQ(0, std::memcmp(fresh.ctx.get(), scene.ctx.get(), sizeof(nav_ctx_t)));
}

TEST_F(Interface, in_and_out_are_sent_around_the_events_of_a_call)
{
    auto out = std::make_unique<nav_select_arc_out_t>();
    nav_stub_clear();
    ASSERT_EQ(NAV_OK, nav_select_arc(scene.ctx.get(), &select, out.get()));
    const std::vector<uint32_t> kinds = captured();
    ASSERT_EQ(3U, kinds.size());
    EXPECT_EQ(NAV_DP_SELECT_ARC_IN, static_cast<int>(kinds[0]));
    EXPECT_EQ(NAV_DP_EVR, static_cast<int>(kinds[1]));
    EXPECT_EQ(NAV_DP_SELECT_ARC_OUT, static_cast<int>(kinds[2]));
}

TEST_F(Interface, tree_and_grids_are_sent_at_their_levels)
{
    Scene full([](nav_params_t &params) { params.product_level = 2.0; });
    full.show(flat);
    nav_stub_clear();
    nav_analyze_terrain_out_t analyzed;
    ASSERT_EQ(NAV_OK, nav_analyze_terrain(full.ctx.get(), &analyze, &analyzed));
    auto out = std::make_unique<nav_select_arc_out_t>();
    ASSERT_EQ(NAV_OK, nav_select_arc(full.ctx.get(), &select, out.get()));
    const std::vector<uint32_t> kinds = captured();
    for (uint32_t kind : {NAV_DP_TREE, NAV_DP_SURFACE, NAV_DP_COSTMAP})
    {
        EXPECT_EQ(1, std::count(kinds.begin(), kinds.end(), kind)) << kind;
    }
    EXPECT_EQ(0U, nav_stub_lost_count());
}

TEST_F(Interface, a_full_sink_is_reported_and_does_not_stop_the_call)
{
    nav_stub_clear();
    cloud->point_count = NAV_CHUNK_POINTS_MAX;
    nav_process_disparity_out_t out;
    for (uint32_t k = 0; (k < 100U) && (nav_stub_lost_count() == 0U); k++)
    {
        cloud->image_id++;
        EXPECT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
    }
    EXPECT_GT(nav_stub_lost_count(), 0U);
    nav_stub_clear();
}

TEST_F(Interface, the_same_calls_on_two_contexts_interleaved_give_the_same_bytes)
{
    Scene one;
    Scene two;
    const auto rocks = [](double x, double y)
    { return (std::hypot(x - 4.0, y - 0.3) < 0.4) ? 0.5 : (0.02 * std::sin(x + y)); };
    one.show(rocks);
    two.show(rocks);
    const auto first = one.select(NAV_MODE_AVOID_ALL);
    const auto second = two.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(0, std::memcmp(first.get(), second.get(), sizeof(*first)));
    EXPECT_EQ(0, std::memcmp(one.ctx.get(), two.ctx.get(), sizeof(nav_ctx_t)));
}

TEST_F(Interface, a_safe_arc_has_margins_at_every_pose)
{
    const auto out = scene.evaluate(1.0, 0.2);
    EXPECT_EQ(1U, out->is_safe);
    EXPECT_EQ(4U, out->pose_count);
    EXPECT_EQ(4U, out->failing_index);
    for (uint32_t k = 0; k < out->pose_count; k++)
    {
        EXPECT_NEAR(0.60, out->bounds[k].clearance_min_m, 0.02);
    }
}

TEST_F(Interface, an_unsafe_arc_names_its_first_failing_pose_and_why)
{
    scene.time_s = 6.0;
    scene.show([](double x, double y) { return (std::hypot(x - 3.5, y) < 0.3) ? 0.5 : 0.0; });
    const auto out = scene.evaluate(4.0, 0.0);
    EXPECT_EQ(0U, out->is_safe);
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_CLEARANCE), out->reason);
    EXPECT_NEAR(2.5, out->failing_at, 0.26);
    EXPECT_EQ(1U, scene.evaluate(4.0, 0.0, NAV_MODE_UNGUARDED)->is_safe);
}

TEST_F(Interface, turns_in_place_and_backward_arcs_are_evaluated)
{
    EXPECT_EQ(1U, scene.evaluate(0.0, 1.0)->is_safe);
    EXPECT_EQ(1U, scene.evaluate(-3.0, 0.3)->is_safe);
    EXPECT_EQ(1U, scene.evaluate(0.0, 0.0)->pose_count);
    nav_zone_t zone = {};
    zone.shape = NAV_ZONE_CIRCLE;
    zone.center_x_site_m = -2.5;
    zone.radius_m = 0.5;
    scene.zones({zone});
    const auto out = scene.evaluate(-3.0, 0.0, NAV_MODE_AVOID_KOZ);
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_KIOZ), out->reason);
    EXPECT_NEAR(-2.0, out->failing_at, 0.26);
}

/// Two contexts are driven alike; before each analysis one of them forgets what it could reuse.
TEST_F(Interface, an_analysis_does_not_depend_on_what_earlier_ones_left_to_reuse)
{
    Scene forgetful;
    forgetful.show(flat);
    for (int step = 0; step < 12; step++)
    {
        nav_analyze_terrain_out_t out[2];
        analyze.time_s = 5.0 + 400.0 * step; // the first clouds expire on the way
        analyze.pose.x_site_m = 1.3 * step;
        analyze.pose.y_site_m = -0.7 * step;
        forgetful.ctx->surface_state = {};
        forgetful.ctx->costmap_state = {};
        forgetful.ctx->relief = {};
        nav_ctx_t *contexts[2] = {scene.ctx.get(), forgetful.ctx.get()};
        for (int k = 0; k < 2; k++)
        {
            nav_process_disparity_out_t merged;
            cloud->image_id = 2000U + static_cast<uint32_t>(step);
            cloud->time_s = analyze.time_s;
            cloud->pose = analyze.pose;
            cloud->point_count = 4000U;
            for (uint32_t p = 0; p < cloud->point_count; p++)
            {
                const double angle = 0.01 * p;
                cloud->points[p] = {static_cast<float>(4.0 + 2.0 * std::cos(angle)),
                                    static_cast<float>(0.001 * p * std::sin(angle)),
                                    static_cast<float>(0.3 * std::sin(0.37 * angle))};
            }
            ASSERT_EQ(NAV_OK, nav_process_disparity(contexts[k], cloud.get(), &merged));
            ASSERT_EQ(NAV_OK, nav_analyze_terrain(contexts[k], &analyze, &out[k]));
            nav_stub_clear();
        }
        ASSERT_EQ(0, std::memcmp(&out[0], &out[1], sizeof(out[0]))) << step;
        ASSERT_EQ(0,
                  std::memcmp(&scene.ctx->surface, &forgetful.ctx->surface, sizeof(nav_surface_t)));
        ASSERT_EQ(0,
                  std::memcmp(&scene.ctx->costmap, &forgetful.ctx->costmap, sizeof(nav_costmap_t)));
        ASSERT_EQ(0, std::memcmp(&scene.ctx->relief, &forgetful.ctx->relief, sizeof(nav_relief_t)));
    }
}

TEST_F(Interface, a_keep_in_zone_is_shrunk_by_the_global_uncertainty)
{
    nav_zone_t zone = {};
    zone.kind = NAV_ZONE_KEEP_IN;
    zone.shape = NAV_ZONE_CIRCLE;
    zone.radius_m = 3.0;
    scene.zones({zone});
    EXPECT_EQ(1U, scene.evaluate(2.9, 0.0)->is_safe);
    evaluate.arc = {2.9, 0.0};
    evaluate.uncertainty.global_position_m = 0.5;
    auto out = std::make_unique<nav_evaluate_arc_out_t>();
    ASSERT_EQ(NAV_OK, nav_evaluate_arc(scene.ctx.get(), &evaluate, out.get()));
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_KIOZ), out->reason);
}

TEST_F(Interface, what_ace_refused_is_forgotten_only_where_it_left_no_path_to_test)
{
    const auto failures = [this]
    {
        uint32_t count = 0U;
        for (const nav_cost_cell_t &cell : scene.ctx->costmap.cells)
        {
            count += (cell.ace_failed_headings != 0U) ? 1U : 0U;
        }
        return count;
    };
    scene.show(
        [](double x, double y)
        {
            const double r = std::hypot(x, y);
            return ((r > 2.2) && (r < 3.2)) ? 1.0 : 0.0;
        });
    EXPECT_GT(scene.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH)->paths_tested, 0U);
    EXPECT_GT(failures(), 0U);
    scene.zones({circle(NAV_ZONE_KEEP_IN, 0.0, 0.0, 0.4)});
    scene.analyze();
    EXPECT_EQ(0U, scene.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH)->paths_tested);
    EXPECT_EQ(0U, failures());
}

} // namespace
