// SPDX-License-Identifier: Apache-2.0
// A context with known terrain, for tests: every cell of the heightmap gets one exact point.
#ifndef NAV_SCENE_HPP
#define NAV_SCENE_HPP

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_ace.h"
#include "nav_dp_stub.h"
#include "navlib.h"
}

class Scene
{
  public:
    /// Terrain elevation, up, at north x and east y.
    using Elevation = std::function<double(double x_m, double y_m)>;

    explicit Scene(const std::function<void(nav_params_t &)> &change = {})
        : ctx(std::make_unique<nav_ctx_t>())
    {
        nav_params_t params;
        nav_params_default(&params);
        if (change)
        {
            change(params);
        }
        auto in = std::make_unique<nav_init_in_t>();
        nav_init_out_t out;
        in->time_s = 0.0;
        std::copy_n(reinterpret_cast<const double *>(&params), NAV_PARAM_COUNT, in->params);
        EXPECT_EQ(NAV_OK, nav_init(ctx.get(), in.get(), &out));
        nav_stub_clear();
    }

    /// Merges one point per cell of the 30 m around the origin and analyzes the terrain.
    void show(const Elevation &elevation, const Elevation &is_hidden = {})
    {
        std::vector<nav_point_t> points;
        for (int row = -NAV_HEIGHTMAP_SIZE / 2; row < NAV_HEIGHTMAP_SIZE / 2; row++)
        {
            for (int col = -NAV_HEIGHTMAP_SIZE / 2; col < NAV_HEIGHTMAP_SIZE / 2; col++)
            {
                const double x = (row + 0.5) * ctx->params.heightmap_cell_m;
                const double y = (col + 0.5) * ctx->params.heightmap_cell_m;
                if (!is_hidden || (is_hidden(x, y) < 0.5))
                {
                    points.push_back({static_cast<float>(x), static_cast<float>(y),
                                      static_cast<float>(-elevation(x, y))});
                }
            }
        }
        merge(points);
        analyze();
    }

    void merge(const std::vector<nav_point_t> &points)
    {
        auto in = std::make_unique<nav_process_disparity_in_t>();
        nav_process_disparity_out_t out;
        in->image_id = ++image_id;
        in->chunk_count = static_cast<uint32_t>((points.size() + NAV_CHUNK_POINTS_MAX - 1) /
                                                NAV_CHUNK_POINTS_MAX);
        for (uint32_t chunk = 0; chunk < in->chunk_count; chunk++)
        {
            const size_t first = static_cast<size_t>(chunk) * NAV_CHUNK_POINTS_MAX;
            const size_t count = std::min<size_t>(NAV_CHUNK_POINTS_MAX, points.size() - first);
            in->chunk_index = chunk;
            in->point_count = static_cast<uint32_t>(count);
            std::copy_n(&points[first], count, in->points);
            ASSERT_EQ(NAV_OK, nav_process_disparity(ctx.get(), in.get(), &out));
            nav_stub_clear();
        }
    }

    nav_analyze_terrain_out_t analyze()
    {
        nav_analyze_terrain_in_t in = {};
        nav_analyze_terrain_out_t out;
        in.time_s = time_s;
        in.goal = goal;
        EXPECT_EQ(NAV_OK, nav_analyze_terrain(ctx.get(), &in, &out));
        nav_stub_clear();
        return out;
    }

    nav_ace_scene_t ace_scene()
    {
        return {&ctx->params,  &ctx->vehicle, &ctx->surface,
                &ctx->costmap, &ctx->relief,  &ctx->ace_work};
    }

    nav_ace_bounds_t ace(double x_m, double y_m, double yaw_rad, const nav_uncertainty_t &u = {})
    {
        const nav_ace_scene_t scene = ace_scene();
        const nav_pose2_t pose = {x_m, y_m, yaw_rad};
        nav_ace_bounds_t bounds;
        nav_ace_evaluate(&scene, &pose, &u, false, &bounds);
        return bounds;
    }

    /// What the tree works with.
    nav_tree_scene_t tree_scene()
    {
        return {ace_scene(), &ctx->kioz, &ctx->global, &ctx->tree_shapes, &ctx->costmap};
    }

    std::unique_ptr<nav_select_arc_out_t> select(nav_mode_t mode, nav_status_t expected = NAV_OK)
    {
        nav_select_arc_in_t in = {};
        auto out = std::make_unique<nav_select_arc_out_t>();
        in.time_s = time_s;
        in.goal = goal;
        in.mode = mode;
        EXPECT_EQ(expected, nav_select_arc(ctx.get(), &in, out.get()));
        nav_stub_clear();
        return out;
    }

    std::unique_ptr<nav_evaluate_arc_out_t> evaluate(double length_m,
                                                     double heading_change_rad,
                                                     nav_mode_t mode = NAV_MODE_AVOID_ALL)
    {
        nav_evaluate_arc_in_t in = {};
        auto out = std::make_unique<nav_evaluate_arc_out_t>();
        in.time_s = time_s;
        in.arc = {length_m, heading_change_rad};
        in.mode = mode;
        EXPECT_EQ(NAV_OK, nav_evaluate_arc(ctx.get(), &in, out.get()));
        nav_stub_clear();
        return out;
    }

    void zones(const std::vector<nav_zone_t> &zones)
    {
        auto in = std::make_unique<nav_set_kioz_in_t>();
        nav_set_kioz_out_t out;
        in->time_s = time_s;
        in->zone_count = static_cast<uint32_t>(zones.size());
        std::copy(zones.begin(), zones.end(), in->zones);
        ASSERT_EQ(NAV_OK, nav_set_kioz(ctx.get(), in.get(), &out));
        nav_stub_clear();
    }

    std::unique_ptr<nav_ctx_t> ctx;
    nav_waydisc_t goal = {12.0, 0.0, 1.0};
    double time_s = 1.0;
    uint32_t image_id = 0;
};

/// A wall round the rover, with its inner side at a distance.
inline Scene::Elevation ring(double inner_m)
{
    return [=](double x, double y)
    {
        const double r = std::hypot(x, y);
        return ((r > inner_m) && (r < inner_m + 1.0)) ? 1.0 : 0.0;
    };
}

inline double flat(double, double)
{
    return 0.0;
}

/// A round zone.
inline nav_zone_t circle(nav_zone_kind_t kind, double x_m, double y_m, double radius_m)
{
    nav_zone_t zone = {};
    zone.kind = kind;
    zone.shape = NAV_ZONE_CIRCLE;
    zone.center_x_site_m = x_m;
    zone.center_y_site_m = y_m;
    zone.radius_m = radius_m;
    return zone;
}

constexpr double DEG = 3.14159265358979323846 / 180.0;

/// Height at which a predicate turns from true to false, between low and high.
inline double threshold(double low, double high, const std::function<bool(double)> &is_fine)
{
    for (int k = 0; k < 20; k++)
    {
        const double middle = 0.5 * (low + high);
        (is_fine(middle) ? low : high) = middle;
    }
    return low;
}

#endif
