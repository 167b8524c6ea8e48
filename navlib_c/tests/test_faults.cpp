// SPDX-License-Identifier: Apache-2.0
// Bad inputs and faults, one by one, through the six calls. navlib_c/DESIGN.md lists which kinds of
// fault are shown here and which in the tests of the modules.
#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include "nav_scene.hpp"

namespace
{

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double NAN_D = std::numeric_limits<double>::quiet_NaN();
constexpr double DENORMAL = std::numeric_limits<double>::denorm_min();
constexpr double HUGE_D = std::numeric_limits<double>::max();
constexpr uint32_t UINT_MAX_D = std::numeric_limits<uint32_t>::max();

double nan_with(uint64_t sign_and_payload)
{
    const uint64_t bits = 0x7FF0000000000000ULL | sign_and_payload;
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
}

double below(double x)
{
    return std::nextafter(x, -INF);
}

double above(double x)
{
    return std::nextafter(x, INF);
}

/// A scene on flat ground, and one valid input of each call.
class Faults : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        scene.show(flat);
        cloud->time_s = zones->time_s = analyze.time_s = select.time_s = evaluate.time_s = 5.0;
        cloud->image_id = 1000;
        cloud->chunk_count = 1;
        cloud->point_count = 1;
        select.goal = analyze.goal = {10.0, 0.0, 1.0};
        select.mode = evaluate.mode = NAV_MODE_AVOID_ALL;
        evaluate.arc = {1.0, 0.0};
        zones->zone_count = 1;
        zones->zones[0] = circle(NAV_ZONE_KEEP_OUT, 8.0, 8.0, 1.0);
    }

    template <typename In, typename Out>
    nav_status_t answer(nav_status_t (*call)(nav_ctx_t *, const In *, Out *), const In &in)
    {
        auto out = std::make_unique<Out>();
        nav_stub_clear();
        const nav_status_t status = call(scene.ctx.get(), &in, out.get());
        EXPECT_EQ(static_cast<uint32_t>(status), out->status);
        return status;
    }

    /// The call is refused with the status and leaves the context as it was.
    template <typename In, typename Out>
    void refused(nav_status_t status,
                 nav_status_t (*call)(nav_ctx_t *, const In *, Out *),
                 const In &in)
    {
        auto before = std::make_unique<nav_ctx_t>(*scene.ctx);
        EXPECT_EQ(status, answer(call, in));
        EXPECT_EQ(0, std::memcmp(before.get(), scene.ctx.get(), sizeof(nav_ctx_t)));
    }

    std::unique_ptr<nav_select_arc_out_t> selected(nav_status_t expected = NAV_OK)
    {
        auto out = std::make_unique<nav_select_arc_out_t>();
        nav_stub_clear();
        EXPECT_EQ(expected, nav_select_arc(scene.ctx.get(), &select, out.get()));
        return out;
    }

    std::unique_ptr<nav_evaluate_arc_out_t> evaluated()
    {
        auto out = std::make_unique<nav_evaluate_arc_out_t>();
        nav_stub_clear();
        EXPECT_EQ(NAV_OK, nav_evaluate_arc(scene.ctx.get(), &evaluate, out.get()));
        return out;
    }

    Scene scene;
    std::unique_ptr<nav_process_disparity_in_t> cloud =
        std::make_unique<nav_process_disparity_in_t>();
    std::unique_ptr<nav_set_kioz_in_t> zones = std::make_unique<nav_set_kioz_in_t>();
    nav_analyze_terrain_in_t analyze = {};
    nav_select_arc_in_t select = {};
    nav_evaluate_arc_in_t evaluate = {};
};

/* contexts */

TEST_F(Faults, a_context_whose_initialization_failed_is_refused)
{
    auto in = std::make_unique<nav_init_in_t>();
    nav_init_out_t out;
    scene.ctx = std::make_unique<nav_ctx_t>();
    EXPECT_EQ(NAV_PARAMETER_RANGE, nav_init(scene.ctx.get(), in.get(), &out));
    refused(NAV_NOT_INITIALIZED, nav_select_arc, select);
}

TEST_F(Faults, a_foreign_or_stale_context_is_refused)
{
    for (uint32_t magic : {0U, 1U, static_cast<uint32_t>(NAV_CONTEXT_MAGIC) - 1U,
                           static_cast<uint32_t>(NAV_CONTEXT_MAGIC) + 1U, UINT_MAX_D})
    {
        scene.ctx->magic = magic;
        refused(NAV_NOT_INITIALIZED, nav_set_kioz, *zones);
        refused(NAV_NOT_INITIALIZED, nav_process_disparity, *cloud);
        refused(NAV_NOT_INITIALIZED, nav_analyze_terrain, analyze);
        refused(NAV_NOT_INITIALIZED, nav_select_arc, select);
        refused(NAV_NOT_INITIALIZED, nav_evaluate_arc, evaluate);
    }
}

TEST_F(Faults, initializing_a_context_of_any_content_is_the_same)
{
    auto in = std::make_unique<nav_init_in_t>();
    nav_init_out_t out;
    std::copy_n(reinterpret_cast<const double *>(&scene.ctx->params), NAV_PARAM_COUNT, in->params);
    Scene fresh;
    std::memset(static_cast<void *>(scene.ctx.get()), 0xA5, sizeof(nav_ctx_t));
    ASSERT_EQ(NAV_OK, nav_init(scene.ctx.get(), in.get(), &out));
    EXPECT_EQ(0, std::memcmp(fresh.ctx.get(), scene.ctx.get(), sizeof(nav_ctx_t)));
}

/* numbers */

/// Every double of an input, by its place, with the range it may have.
struct Range
{
    size_t place;
    double low;
    double high;
};

constexpr double PI = 3.14159265358979323846;
/* SITE coordinates, then roll, pitch, yaw, from a place on */
std::vector<Range> pose_ranges(size_t first)
{
    return {{first, -1.0e6, 1.0e6}, {first + 1U, -1.0e6, 1.0e6},       {first + 2U, -1.0e6, 1.0e6},
            {first + 3U, -PI, PI},  {first + 4U, -0.5 * PI, 0.5 * PI}, {first + 5U, -1.0e4, 1.0e4}};
}

std::vector<Range> joined(std::vector<Range> a, const std::vector<Range> &b)
{
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

const std::vector<Range> SELECT_RANGES = joined(pose_ranges(1),
                                                {{7, 0.0, 100.0},
                                                 {8, 0.0, PI},
                                                 {9, 0.0, 100.0},
                                                 {10, -1.0e6, 1.0e6},
                                                 {11, -1.0e6, 1.0e6},
                                                 {12, 0.0, 1.0e4},
                                                 {13, -100.0, 100.0}});
const std::vector<Range> EVALUATE_RANGES = joined(
    pose_ranges(1),
    {{7, 0.0, 100.0}, {8, 0.0, PI}, {9, 0.0, 100.0}, {10, -10.0, 10.0}, {11, -2.0 * PI, 2.0 * PI}});
const std::vector<Range> ANALYZE_RANGES = joined(
    pose_ranges(1), {{7, -1.0e6, 1.0e6}, {8, -1.0e6, 1.0e6}, {9, 0.0, 1.0e4}, {10, 0.0, 100.0}});

template <typename In> In with(const In &in, size_t place, double value)
{
    In changed = in;
    reinterpret_cast<double *>(&changed)[place] = value;
    return changed;
}

TEST_F(Faults, a_step_beyond_any_limit_is_refused_and_the_largest_double_too)
{
    for (const Range &range : SELECT_RANGES)
    {
        for (double bad : {below(range.low), above(range.high), HUGE_D, -HUGE_D})
        {
            refused(NAV_OUT_OF_RANGE, nav_select_arc, with(select, range.place, bad));
        }
    }
    for (const Range &range : EVALUATE_RANGES)
    {
        for (double bad : {below(range.low), above(range.high), HUGE_D, -HUGE_D})
        {
            refused(NAV_OUT_OF_RANGE, nav_evaluate_arc, with(evaluate, range.place, bad));
        }
    }
    for (const Range &range : ANALYZE_RANGES)
    {
        for (double bad : {below(range.low), above(range.high), HUGE_D, -HUGE_D})
        {
            refused(NAV_OUT_OF_RANGE, nav_analyze_terrain, with(analyze, range.place, bad));
        }
    }
    for (const Range &range : pose_ranges(1))
    {
        auto in = std::make_unique<nav_process_disparity_in_t>(*cloud);
        for (double bad : {below(range.low), above(range.high), HUGE_D, -HUGE_D})
        {
            reinterpret_cast<double *>(in.get())[range.place] = bad;
            refused(NAV_OUT_OF_RANGE, nav_process_disparity, *in);
        }
    }
}

TEST_F(Faults, the_limits_themselves_and_what_is_nearly_zero_are_taken)
{
    const auto is_answer = [](nav_status_t status)
    { return (status == NAV_OK) || (status == NAV_NO_PATH); };
    for (const Range &range : SELECT_RANGES)
    {
        for (double fine : {range.low, range.high, -0.0, DENORMAL})
        {
            EXPECT_TRUE(is_answer(answer(nav_select_arc, with(select, range.place, fine))))
                << range.place << " " << fine;
        }
    }
    for (const Range &range : EVALUATE_RANGES)
    {
        for (double fine : {range.low, range.high, -0.0, DENORMAL})
        {
            EXPECT_EQ(NAV_OK, answer(nav_evaluate_arc, with(evaluate, range.place, fine)))
                << range.place << " " << fine;
        }
    }
    for (const Range &range : ANALYZE_RANGES)
    {
        for (double fine : {range.low, range.high, -0.0, DENORMAL})
        {
            EXPECT_EQ(NAV_OK, answer(nav_analyze_terrain, with(analyze, range.place, fine)))
                << range.place << " " << fine;
        }
    }
}

TEST_F(Faults, a_nan_of_any_sign_and_payload_is_refused_in_every_number)
{
    for (double bad : {nan_with(1ULL), nan_with(0x8000000000000000ULL | 0xFFFFULL),
                       nan_with(0x000FFFFFFFFFFFFFULL)})
    {
        for (const Range &range : SELECT_RANGES)
        {
            refused(NAV_NOT_FINITE, nav_select_arc, with(select, range.place, bad));
        }
        for (const Range &range : EVALUATE_RANGES)
        {
            refused(NAV_NOT_FINITE, nav_evaluate_arc, with(evaluate, range.place, bad));
        }
        for (const Range &range : ANALYZE_RANGES)
        {
            refused(NAV_NOT_FINITE, nav_analyze_terrain, with(analyze, range.place, bad));
        }
        auto in = std::make_unique<nav_init_in_t>();
        in->time_s = bad;
        refused(NAV_NOT_FINITE, nav_init, *in);
    }
}

TEST_F(Faults, a_negative_zero_and_a_denormal_mean_the_same_as_zero)
{
    const auto expected = selected();
    for (const Range &range : SELECT_RANGES)
    {
        if ((range.low <= 0.0) && (range.place != 10U) && (range.place != 12U))
        {
            for (double zero : {-0.0, DENORMAL})
            {
                const nav_select_arc_in_t kept = select;
                select = with(select, range.place, zero);
                const auto out = selected();
                EXPECT_DOUBLE_EQ(expected->arc.length_m, out->arc.length_m) << range.place;
                EXPECT_DOUBLE_EQ(expected->arc.heading_change_rad, out->arc.heading_change_rad);
                select = kept;
            }
        }
    }
}

TEST_F(Faults, points_at_their_limits_are_taken_and_beyond_them_refused)
{
    constexpr float LIMIT_M = 1.0e5F;
    for (size_t axis = 0; axis < 3U; axis++)
    {
        float *number = reinterpret_cast<float *>(&cloud->points[0]) + axis;
        for (float fine : {LIMIT_M, -LIMIT_M, -0.0F, std::numeric_limits<float>::denorm_min()})
        {
            *number = fine;
            EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud));
            cloud->image_id++;
        }
        for (float bad : {std::nextafter(LIMIT_M, 2.0F * LIMIT_M), -2.0F * LIMIT_M, 1.0e30F,
                          std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()})
        {
            *number = bad;
            refused(NAV_OUT_OF_RANGE, nav_process_disparity, *cloud);
        }
        for (float bad :
             {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::quiet_NaN(),
              std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()})
        {
            *number = bad;
            refused(NAV_NOT_FINITE, nav_process_disparity, *cloud);
        }
        *number = 0.0F;
    }
}

TEST_F(Faults, extremes_that_add_up_are_outside_the_map)
{
    cloud->pose = {1.0e6, 1.0e6, 1.0e6, 0.0, 0.0, 0.0};
    cloud->points[0] = {1.0e5F, 1.0e5F, 1.0e5F};
    nav_process_disparity_out_t out;
    ASSERT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
    EXPECT_EQ(1U, out.outside_count);
    EXPECT_EQ(0U, out.merged_count);
}

TEST_F(Faults, a_spacecraft_clock_of_any_size_keeps_the_age_of_cells)
{
    for (double clock_s : {0.0, 7.0e8, 4.0e9})
    {
        Scene later([](nav_params_t &params) { params.heightmap_expiry_s = 10.0; });
        auto in = std::make_unique<nav_process_disparity_in_t>(*cloud);
        nav_process_disparity_out_t merged;
        in->time_s = clock_s;
        in->points[0] = {0.05F, 0.05F, 0.5F};
        ASSERT_EQ(NAV_OK, nav_process_disparity(later.ctx.get(), in.get(), &merged));
        const size_t middle =
            (NAV_HEIGHTMAP_SIZE / 2) * NAV_HEIGHTMAP_SIZE + NAV_HEIGHTMAP_SIZE / 2;
        later.time_s = clock_s + 9.0;
        later.analyze();
        EXPECT_FLOAT_EQ(0.5F, later.ctx->surface.z_site_m[middle]) << clock_s;
        later.time_s = clock_s + 11.0;
        later.analyze();
        EXPECT_FLOAT_EQ(NAV_SURFACE_UNKNOWN_M, later.ctx->surface.z_site_m[middle]) << clock_s;
    }
}

/* counts */

TEST_F(Faults, every_count_up_to_its_capacity_is_taken_and_no_other)
{
    for (uint32_t count : {0U, 1U, static_cast<uint32_t>(NAV_CHUNK_POINTS_MAX)})
    {
        cloud->point_count = count;
        EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud)) << count;
        cloud->image_id++;
    }
    for (uint32_t count :
         {static_cast<uint32_t>(NAV_CHUNK_POINTS_MAX) + 1U, 0x80000000U,
          UINT_MAX_D / static_cast<uint32_t>(sizeof(nav_point_t)) + 1U, UINT_MAX_D})
    {
        cloud->point_count = count;
        refused(NAV_COUNT, nav_process_disparity, *cloud);
    }
    std::fill_n(zones->zones, NAV_ZONES_MAX, circle(NAV_ZONE_KEEP_OUT, 8.0, 8.0, 1.0));
    for (uint32_t count : {0U, 1U, static_cast<uint32_t>(NAV_ZONES_MAX)})
    {
        zones->zone_count = count;
        EXPECT_EQ(NAV_OK, answer(nav_set_kioz, *zones)) << count;
        EXPECT_EQ(count, scene.ctx->kioz.zone_count);
    }
    for (uint32_t count : {static_cast<uint32_t>(NAV_ZONES_MAX) + 1U, 0x80000000U, UINT_MAX_D})
    {
        zones->zone_count = count;
        refused(NAV_COUNT, nav_set_kioz, *zones);
    }
}

TEST_F(Faults, chunks_may_be_very_many_but_keep_their_number_and_order)
{
    cloud->chunk_count = UINT_MAX_D;
    EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud));
    cloud->chunk_index = 1;
    cloud->chunk_count = 2;
    refused(NAV_ORDER, nav_process_disparity, *cloud);
    cloud->chunk_count = UINT_MAX_D;
    cloud->chunk_index = 2;
    refused(NAV_ORDER, nav_process_disparity, *cloud);
    cloud->chunk_index = UINT_MAX_D;
    refused(NAV_COUNT, nav_process_disparity, *cloud);
    cloud->chunk_index = 1;
    EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud));
}

TEST_F(Faults, the_first_bad_zone_is_named_though_good_ones_follow)
{
    zones->zone_count = 3;
    zones->zones[1] = circle(NAV_ZONE_KEEP_OUT, 0.0, 0.0, -1.0);
    zones->zones[2] = circle(NAV_ZONE_KEEP_OUT, 0.0, 0.0, 1.0);
    nav_set_kioz_out_t out;
    EXPECT_EQ(NAV_ZONE, nav_set_kioz(scene.ctx.get(), zones.get(), &out));
    EXPECT_EQ(1U, out.refused_index);
}

/* clouds */

TEST_F(Faults, a_cell_takes_65535_points_of_an_image_and_keeps_their_mean)
{
    uint32_t merged_count = 0;
    cloud->chunk_count = 9;
    cloud->point_count = NAV_CHUNK_POINTS_MAX;
    for (nav_point_t &point : cloud->points)
    {
        point = {0.05F, 0.05F, -0.5F};
    }
    for (; cloud->chunk_index < 9U; cloud->chunk_index++)
    {
        nav_process_disparity_out_t out;
        ASSERT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
        merged_count += out.merged_count;
        nav_stub_clear();
    }
    EXPECT_EQ(65535U, merged_count);
    scene.time_s = 5.0;
    scene.analyze();
    const size_t middle = (NAV_HEIGHTMAP_SIZE / 2) * NAV_HEIGHTMAP_SIZE + NAV_HEIGHTMAP_SIZE / 2;
    EXPECT_FLOAT_EQ(-0.5F, scene.ctx->surface.z_site_m[middle]);
}

TEST_F(Faults, one_nan_among_good_points_refuses_the_whole_chunk)
{
    cloud->point_count = NAV_CHUNK_POINTS_MAX;
    for (size_t place : {size_t{0}, size_t{17}, size_t{NAV_CHUNK_POINTS_MAX - 1}})
    {
        cloud->points[place].y_m = std::numeric_limits<float>::quiet_NaN();
        refused(NAV_NOT_FINITE, nav_process_disparity, *cloud);
        cloud->points[place].y_m = 0.0F;
    }
    cloud->point_count = NAV_CHUNK_POINTS_MAX - 1;
    cloud->points[NAV_CHUNK_POINTS_MAX - 1].y_m = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud));
}

TEST_F(Faults, duplicated_and_unsorted_points_make_the_same_surface)
{
    std::vector<nav_point_t> points;
    std::mt19937 random(3);
    for (int k = 0; k < 3000; k++)
    {
        points.push_back({static_cast<float>(random() % 64) * 0.25F - 8.0F,
                          static_cast<float>(random() % 64) * 0.25F - 8.0F,
                          static_cast<float>(random() % 16) * 0.125F});
    }
    Scene sorted;
    sorted.merge(points);
    sorted.analyze();
    points.insert(points.end(), points.begin(), points.end());
    std::shuffle(points.begin(), points.end(), random);
    Scene shuffled;
    shuffled.merge(points);
    shuffled.analyze();
    EXPECT_EQ(0, std::memcmp(sorted.ctx->surface.z_site_m, shuffled.ctx->surface.z_site_m,
                             sizeof(sorted.ctx->surface.z_site_m)));
}

TEST_F(Faults, a_cloud_wholly_outside_the_map_changes_no_height)
{
    const nav_surface_t before = scene.ctx->surface;
    cloud->points[0] = {40.0F, 0.0F, -3.0F};
    cloud->points[1] = {-15.1F, 0.0F, -3.0F};
    cloud->points[2] = {15.0F, 0.0F, -3.0F};
    cloud->point_count = 3;
    nav_process_disparity_out_t out;
    ASSERT_EQ(NAV_OK, nav_process_disparity(scene.ctx.get(), cloud.get(), &out));
    EXPECT_EQ(3U, out.outside_count);
    scene.analyze();
    EXPECT_EQ(0,
              std::memcmp(before.z_site_m, scene.ctx->surface.z_site_m, sizeof(before.z_site_m)));
}

TEST_F(Faults, a_drive_far_from_the_origin_of_site_is_decided_as_one_at_the_origin)
{
    const auto rock = [](double x, double y)
    { return (std::hypot(x - 4.0, y - 0.3) < 0.5) ? 0.6 : 0.02 * std::sin(x) * std::cos(y); };
    Scene near;
    near.show(rock);
    const auto expected = near.select(NAV_MODE_AVOID_ALL);
    for (double far_m : {1.0e4, -1.0e4, 9.9e5, -9.9e5})
    {
        Scene far;
        auto in = std::make_unique<nav_process_disparity_in_t>();
        nav_process_disparity_out_t merged;
        in->pose.x_site_m = far_m;
        in->pose.y_site_m = -far_m;
        in->chunk_count = 1;
        for (int row = -150; row < 150; row++)
        {
            in->image_id++;
            in->point_count = 300;
            for (int col = -150; col < 150; col++)
            {
                const double x = (row + 0.5) * 0.1;
                const double y = (col + 0.5) * 0.1;
                in->points[col + 150] = {static_cast<float>(x), static_cast<float>(y),
                                         static_cast<float>(-rock(x, y))};
            }
            ASSERT_EQ(NAV_OK, nav_process_disparity(far.ctx.get(), in.get(), &merged));
            EXPECT_EQ(300U, merged.merged_count);
            nav_stub_clear();
        }
        nav_analyze_terrain_in_t look = {};
        nav_analyze_terrain_out_t looked;
        look.time_s = 1.0;
        look.pose = in->pose;
        look.goal = {far_m + 12.0, -far_m, 1.0};
        ASSERT_EQ(NAV_OK, nav_analyze_terrain(far.ctx.get(), &look, &looked));
        nav_select_arc_in_t ask = {};
        auto out = std::make_unique<nav_select_arc_out_t>();
        ask.time_s = 1.0;
        ask.pose = look.pose;
        ask.goal = look.goal;
        ask.mode = NAV_MODE_AVOID_ALL;
        ASSERT_EQ(NAV_OK, nav_select_arc(far.ctx.get(), &ask, out.get()));
        nav_stub_clear();
        EXPECT_EQ(expected->path_index, out->path_index) << far_m;
        EXPECT_NEAR(expected->bounds.clearance_min_m, out->bounds.clearance_min_m, 1e-4);
        EXPECT_NEAR(expected->path_cost_s, out->path_cost_s, 1e-3);
    }
}

/* poses */

TEST_F(Faults, a_yaw_of_many_turns_is_the_same_heading)
{
    evaluate.arc = {2.0, 0.4};
    evaluate.pose.yaw_rad = 0.7;
    const auto expected = evaluated();
    for (double turns : {1.0, -3.0, 1000.0})
    {
        evaluate.pose.yaw_rad = 0.7 + (turns * 2.0 * PI);
        const auto out = evaluated();
        EXPECT_EQ(expected->is_safe, out->is_safe);
        EXPECT_NEAR(expected->bounds[7].clearance_min_m, out->bounds[7].clearance_min_m, 1e-9);
    }
}

TEST_F(Faults, a_pose_off_the_map_has_no_safe_arc_in_the_modes_that_look_at_the_terrain)
{
    select.pose.x_site_m = 500.0;
    select.goal.x_site_m = 510.0;
    EXPECT_EQ(0U, selected(NAV_NO_PATH)->rejections[NAV_REASON_NONE]);
    select.mode = NAV_MODE_UNGUARDED;
    EXPECT_DOUBLE_EQ(1.0, selected()->arc.length_m);
    evaluate.pose.x_site_m = 500.0;
    const auto out = evaluated();
    EXPECT_EQ(0U, out->is_safe);
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_UNKNOWN), out->reason);
}

TEST_F(Faults, a_huge_uncertainty_makes_everything_near_a_rock_unsafe_and_nothing_else_breaks)
{
    scene.time_s = 5.0;
    scene.show([](double x, double y) { return (std::hypot(x - 3.0, y - 2.6) < 0.4) ? 0.6 : 0.0; });
    evaluate.arc = {2.0, 0.0};
    EXPECT_EQ(1U, evaluated()->is_safe);
    for (double radius_m : {2.0, 10.0, 100.0})
    {
        evaluate.uncertainty = {radius_m, PI, 100.0};
        const auto out = evaluated();
        EXPECT_EQ(0U, out->is_safe) << radius_m;
    }
}

/* goals */

TEST_F(Faults, a_goal_at_the_rover_is_reached_by_the_shortest_arc)
{
    for (double radius_m : {0.0, 1.0})
    {
        select.goal = {0.0, 0.0, radius_m};
        const auto out = selected();
        EXPECT_TRUE(std::isfinite(out->path_cost_s));
        EXPECT_LE(out->arc.length_m, 1.0);
    }
    select.goal = {0.0, 0.0, 1.0};
    EXPECT_DOUBLE_EQ(0.0, selected()->cost_to_go_s);
}

TEST_F(Faults, a_goal_inside_a_keep_out_zone_is_approached_but_not_entered)
{
    scene.time_s = 5.0;
    scene.zones({circle(NAV_ZONE_KEEP_OUT, 10.0, 0.0, 2.0)});
    scene.analyze();
    for (nav_mode_t mode : {NAV_MODE_AVOID_KOZ, NAV_MODE_AVOID_ALL})
    {
        select.mode = mode;
        const auto out = selected();
        EXPECT_NEAR(0.0, out->arc.heading_change_rad, 0.1);
        for (uint32_t k = 0; k < out->global_point_count; k++)
        {
            EXPECT_GT(std::hypot(out->global_points[k].x_m - 10.0, out->global_points[k].y_m), 2.0);
        }
    }
}

TEST_F(Faults, goals_on_corners_and_beyond_edges_of_the_costmap_are_driven_towards)
{
    for (double x_m : {-25.0, 24.999, 25.0, 1.0e6})
    {
        for (double y_m : {-25.0, 0.0, 24.999, 25.0, -1.0e6})
        {
            select.goal = {x_m, y_m, 0.0};
            const auto out = selected();
            const double ahead_rad = std::atan2(y_m, x_m);
            const nav_point_t &end = out->path_points[out->path_point_count - 1U];
            EXPECT_GT((end.x_m * std::cos(ahead_rad)) + (end.y_m * std::sin(ahead_rad)), 3.0)
                << x_m << " " << y_m;
            EXPECT_LT(out->path_cost_s, NAV_COST_INFINITE);
        }
    }
}

TEST_F(Faults, an_enclosed_goal_cannot_be_reached_and_is_said_so)
{
    scene.time_s = 5.0;
    scene.show(
        [](double x, double y)
        {
            const double r = std::hypot(x - 10.0, y);
            return ((r > 3.0) && (r < 4.2)) ? 3.0 * (r - 3.0) : 0.0;
        });
    const auto out = selected(NAV_NO_PATH);
    EXPECT_EQ(static_cast<uint32_t>(NAV_TREE_NONE), out->path_index);
    EXPECT_EQ(0U, out->rejections[NAV_REASON_NONE]);
}

/* zones */

TEST_F(Faults, a_rover_inside_a_keep_out_zone_gets_no_path)
{
    scene.time_s = 5.0;
    scene.zones({circle(NAV_ZONE_KEEP_OUT, 0.0, 0.0, 20.0)});
    scene.analyze();
    for (uint32_t mode = 0; mode < NAV_MODE_COUNT; mode++)
    {
        select.mode = evaluate.mode = mode;
        EXPECT_GT(selected(NAV_NO_PATH)->rejections[NAV_REASON_KIOZ], 0U);
        EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_KIOZ), evaluated()->reason);
    }
}

TEST_F(Faults, a_keep_in_zone_without_the_rover_lets_nothing_pass)
{
    scene.time_s = 5.0;
    scene.zones({circle(NAV_ZONE_KEEP_IN, 30.0, 0.0, 5.0)});
    scene.analyze();
    EXPECT_GT(selected(NAV_NO_PATH)->rejections[NAV_REASON_KIOZ], 0U);
}

TEST_F(Faults, overlapping_zones_forbid_what_any_of_them_forbids)
{
    scene.time_s = 5.0;
    scene.zones({circle(NAV_ZONE_KEEP_OUT, 4.0, 0.0, 1.0), circle(NAV_ZONE_KEEP_OUT, 4.5, 0.0, 1.0),
                 circle(NAV_ZONE_KEEP_IN, 0.0, 0.0, 20.0),
                 circle(NAV_ZONE_KEEP_IN, 5.0, 0.0, 3.0)});
    scene.analyze();
    const auto out = selected();
    for (uint32_t k = 0; k < out->path_point_count; k++)
    {
        EXPECT_GE(std::hypot(out->path_points[k].x_m - 4.0, out->path_points[k].y_m), 1.0);
        EXPECT_GE(std::hypot(out->path_points[k].x_m - 4.5, out->path_points[k].y_m), 1.0);
    }
}

/* arcs */

TEST_F(Faults, arcs_of_every_length_and_heading_change_are_evaluated_to_their_end)
{
    for (double length_m : {0.0, -0.0, DENORMAL, -DENORMAL, 1e-9, 1e-3, -1e-3, 10.0, -10.0})
    {
        for (double heading_rad : {0.0, -0.0, DENORMAL, 1e-9, PI, -PI, 2.0 * PI, -2.0 * PI})
        {
            evaluate.arc = {length_m, heading_rad};
            const auto out = evaluated();
            EXPECT_GE(out->pose_count, 1U);
            EXPECT_LE(out->pose_count, static_cast<uint32_t>(NAV_ARC_POSES_MAX));
            EXPECT_EQ(1U, out->is_safe) << length_m << " " << heading_rad;
            for (uint32_t k = 0; k < out->pose_count; k++)
            {
                EXPECT_NEAR(0.60, out->bounds[k].clearance_min_m, 0.02);
            }
        }
    }
}

TEST_F(Faults, an_arc_of_all_poses_there_is_room_for_is_recorded_whole)
{
    Scene fine(
        [](nav_params_t &params)
        {
            params.pose_spacing_m = 0.05;
            params.tree_arc_length_m = 3.0;
        });
    fine.show(flat);
    const auto out = fine.evaluate(10.0, 0.0);
    EXPECT_EQ(static_cast<uint32_t>(NAV_ARC_POSES_MAX), out->pose_count);
    EXPECT_EQ(1U, out->bounds[NAV_ARC_POSES_MAX - 1].is_certified);
}

TEST_F(Faults, an_arc_that_leaves_the_map_fails_where_it_does)
{
    evaluate.pose.x_site_m = 9.0;
    evaluate.arc = {10.0, 0.0};
    const auto out = evaluated();
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_UNKNOWN), out->reason);
    EXPECT_GT(out->failing_at, 3.0);
    EXPECT_LT(out->failing_at, 6.0);
}

TEST_F(Faults, guarded_evaluation_looks_at_the_terrain)
{
    scene.time_s = 5.0;
    scene.show([](double x, double y) { return (std::hypot(x - 2.5, y) < 0.3) ? 0.5 : 0.0; });
    evaluate.arc = {4.0, 0.0};
    for (const auto &[mode, is_safe] :
         std::vector<std::pair<nav_mode_t, uint32_t>>{{NAV_MODE_UNGUARDED, 1U},
                                                      {NAV_MODE_GUARDED, 0U},
                                                      {NAV_MODE_AVOID_KOZ, 1U},
                                                      {NAV_MODE_AVOID_ALL, 0U}})
    {
        evaluate.mode = mode;
        EXPECT_EQ(is_safe, evaluated()->is_safe) << mode;
    }
}

/* terrain */

TEST_F(Faults, on_wholly_unknown_ground_only_modes_that_ignore_the_terrain_drive)
{
    Scene blind;
    blind.merge({{200.0F, 0.0F, 0.0F}});
    const nav_analyze_terrain_out_t seen = blind.analyze();
    EXPECT_EQ(0U, seen.known_count);
    EXPECT_EQ(static_cast<uint32_t>(NAV_COSTMAP_CELLS), seen.infinite[NAV_REASON_NONE]);
    blind.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH);
    blind.select(NAV_MODE_GUARDED, NAV_NO_PATH);
    EXPECT_DOUBLE_EQ(1.0, blind.select(NAV_MODE_UNGUARDED)->arc.length_m);
    EXPECT_DOUBLE_EQ(1.0, blind.select(NAV_MODE_AVOID_KOZ)->arc.length_m);
}

TEST_F(Faults, a_single_known_cell_is_not_enough_ground_to_drive_on)
{
    Scene blind;
    blind.merge({{0.05F, 0.05F, 0.0F}});
    EXPECT_EQ(0U, blind.analyze().known_count);
    blind.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH);
}

TEST_F(Faults, with_every_cell_blocked_there_is_no_path_and_tilt_is_why)
{
    Scene steep;
    steep.show([](double x, double) { return 0.8 * x; });
    const auto out = steep.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH);
    EXPECT_GT(out->rejections[NAV_REASON_TILT], 1000U);
}

TEST_F(Faults, a_vertical_cliff_ahead_is_not_driven_over_in_either_direction)
{
    for (double height_m : {-3.0, 3.0})
    {
        Scene cliff;
        cliff.show([=](double x, double) { return (x > 4.0) ? height_m : 0.0; });
        nav_select_arc_in_t in = {};
        auto out = std::make_unique<nav_select_arc_out_t>();
        in.time_s = cliff.time_s;
        in.goal = cliff.goal;
        in.mode = NAV_MODE_AVOID_ALL;
        const nav_status_t status = nav_select_arc(cliff.ctx.get(), &in, out.get());
        if (status == NAV_OK)
        {
            for (uint32_t k = 0; k < out->path_point_count; k++)
            {
                EXPECT_LT(out->path_points[k].x_m, 4.0F - 1.185F);
            }
        }
        else
        {
            EXPECT_EQ(NAV_NO_PATH, status);
        }
    }
}

TEST_F(Faults, a_checkerboard_of_holes_in_the_data_is_closed_and_driven)
{
    Scene gaps;
    gaps.show(flat, [](double x, double y)
              { return ((std::lround(x * 10.0 - 0.5) + std::lround(y * 10.0 - 0.5)) % 2 == 0); });
    EXPECT_DOUBLE_EQ(1.0, gaps.select(NAV_MODE_AVOID_ALL)->arc.length_m);
}

TEST_F(Faults, a_checkerboard_of_blocks_is_never_driven)
{
    Scene rough;
    rough.show(
        [](double x, double y)
        {
            return (((std::lround(std::floor(x)) + std::lround(std::floor(y))) & 1) == 0) ? 0.6
                                                                                          : 0.0;
        });
    EXPECT_EQ(0U, rough.select(NAV_MODE_AVOID_ALL, NAV_NO_PATH)->rejections[NAV_REASON_NONE]);
}

TEST_F(Faults, ties_are_broken_the_same_way_every_time)
{
    Scene one;
    Scene two;
    for (Scene *scene_of : {&one, &two})
    {
        /* symmetric about the line to the goal: every path has a twin of equal cost */
        scene_of->show([](double x, double y)
                       { return (std::hypot(x - 4.0, y) < 0.6) ? 0.6 : 0.0; });
    }
    const auto first = one.select(NAV_MODE_AVOID_ALL);
    const auto second = two.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(0, std::memcmp(first.get(), second.get(), sizeof(*first)));
}

TEST_F(Faults, a_long_way_round_is_shown_up_to_its_capacity)
{
    Scene maze;
    std::vector<nav_zone_t> walls;
    for (int k = 0; k < 11; k++)
    {
        nav_zone_t wall = {};
        wall.kind = NAV_ZONE_KEEP_OUT;
        wall.shape = NAV_ZONE_RECTANGLE;
        wall.center_x_site_m = 2.0 + (2.0 * k);
        wall.center_y_site_m = (k % 2 == 0) ? 3.0 : -3.0;
        wall.length_m = 0.6;
        wall.width_m = 46.0;
        walls.push_back(wall);
    }
    maze.zones(walls);
    maze.goal = {24.0, 0.0, 0.5};
    maze.show(flat);
    const auto out = maze.select(NAV_MODE_AVOID_KOZ);
    EXPECT_EQ(static_cast<uint32_t>(NAV_GLOBAL_POINTS_MAX), out->global_point_count);
}

/* sequence */

TEST_F(Faults, the_same_cloud_twice_is_refused_and_under_another_number_changes_no_height)
{
    cloud->points[0] = {0.05F, 0.05F, -0.1F};
    EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud));
    scene.time_s = 5.0;
    scene.analyze();
    const nav_surface_t before = scene.ctx->surface;
    refused(NAV_ORDER, nav_process_disparity, *cloud);
    cloud->image_id++;
    EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud));
    scene.analyze();
    EXPECT_EQ(0, std::memcmp(&before, &scene.ctx->surface, sizeof(before)));
}

TEST_F(Faults, a_map_that_has_expired_is_unknown)
{
    scene.time_s = 5000.0;
    EXPECT_EQ(0U, scene.analyze().known_count);
    evaluate.time_s = 5000.0;
    EXPECT_EQ(static_cast<uint32_t>(NAV_REASON_UNKNOWN), evaluated()->reason);
}

TEST_F(Faults, an_image_taken_before_the_last_analysis_may_still_be_merged)
{
    scene.time_s = 50.0;
    scene.analyze();
    cloud->time_s = 10.0;
    EXPECT_EQ(NAV_OK, answer(nav_process_disparity, *cloud));
    analyze.time_s = below(50.0);
    refused(NAV_ORDER, nav_analyze_terrain, analyze);
    analyze.time_s = 50.0;
    EXPECT_EQ(NAV_OK, answer(nav_analyze_terrain, analyze));
}

/* memory and sinks */

TEST_F(Faults, a_full_sink_changes_no_answer)
{
    const auto expected = selected();
    const nav_ctx_t before = *scene.ctx;
    auto filler = std::make_unique<nav_process_disparity_in_t>();
    Scene other;
    nav_stub_clear();
    while (nav_dp_send(NAV_DP_PROCESS_DISPARITY_IN, 0.0, filler.get(), sizeof(*filler)) == NAV_OK)
    {
    }
    while (nav_dp_send(NAV_DP_EVR, 0.0, filler.get(), 0U) == NAV_OK)
    {
    }
    const uint32_t lost = nav_stub_lost_count();
    auto out = std::make_unique<nav_select_arc_out_t>();
    *scene.ctx = before;
    EXPECT_EQ(NAV_OK, nav_select_arc(scene.ctx.get(), &select, out.get()));
    EXPECT_GT(nav_stub_lost_count(), lost + 3U);
    EXPECT_DOUBLE_EQ(expected->arc.heading_change_rad, out->arc.heading_change_rad);
    nav_stub_clear();
}

TEST_F(Faults, contexts_with_different_worlds_interleaved_decide_as_they_do_alone)
{
    const auto rocks = [](double x, double y)
    { return (std::hypot(x - 4.0, y - 0.3) < 0.4) ? 0.5 : (0.02 * std::sin(x + y)); };
    const auto waves = [](double x, double y) { return 0.1 * std::sin(0.7 * x) * std::cos(y); };
    Scene alone_1;
    alone_1.show(rocks);
    const auto out_1 = alone_1.select(NAV_MODE_AVOID_ALL);
    Scene alone_2;
    alone_2.show(waves);
    const auto out_2 = alone_2.select(NAV_MODE_AVOID_ALL);
    Scene one;
    Scene two;
    one.show(rocks);
    two.show(waves);
    const auto mixed_1 = one.select(NAV_MODE_AVOID_ALL);
    const auto mixed_2 = two.select(NAV_MODE_AVOID_ALL);
    EXPECT_EQ(0, std::memcmp(out_1.get(), mixed_1.get(), sizeof(*out_1)));
    EXPECT_EQ(0, std::memcmp(out_2.get(), mixed_2.get(), sizeof(*out_2)));
    EXPECT_EQ(0, std::memcmp(alone_1.ctx.get(), one.ctx.get(), sizeof(nav_ctx_t)));
    EXPECT_EQ(0, std::memcmp(alone_2.ctx.get(), two.ctx.get(), sizeof(nav_ctx_t)));
}

} // namespace
