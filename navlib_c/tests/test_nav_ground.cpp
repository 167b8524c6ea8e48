// SPDX-License-Identifier: Apache-2.0
#include "nav_scene.hpp"

extern "C"
{
#include "nav_ground.h"
}

namespace
{

nav_ground_t placed(const Scene &scene, double x_m, double y_m, double yaw_rad)
{
    const nav_pose2_t pose = {x_m, y_m, yaw_rad};
    nav_ground_t ground;
    EXPECT_TRUE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap, &pose));
    return ground;
}

double slope_20_deg_north(double x_m, double)
{
    return std::tan(20.0 * DEG) * x_m;
}

TEST(Ground, a_plane_has_no_heights_above_itself)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.3 * x) - (0.1 * y) + 7.0; });
    const nav_ground_t ground = placed(scene, 1.0, -2.0, 0.7);
    for (double u = -2.0; u <= 2.0; u += 0.37)
    {
        for (double v = -2.0; v <= 2.0; v += 0.41)
        {
            EXPECT_NEAR(0.0, nav_ground_eta_m(&ground, u, v), 1e-5);
        }
    }
}

TEST(Ground, the_frame_is_orthonormal_on_any_slope)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.35 * x) + (0.2 * y); });
    for (double yaw = -3.0; yaw < 3.0; yaw += 0.5)
    {
        const nav_ground_t ground = placed(scene, 0.0, 0.0, yaw);
        const double *f = ground.forward_xy;
        const double *r = ground.right_xy;
        EXPECT_NEAR(1.0, f[0] * f[0] + f[1] * f[1] + ground.forward_up * ground.forward_up, 1e-12);
        EXPECT_NEAR(1.0, r[0] * r[0] + r[1] * r[1] + ground.right_up * ground.right_up, 1e-12);
        EXPECT_NEAR(0.0, f[0] * r[0] + f[1] * r[1] + ground.forward_up * ground.right_up, 1e-12);
        EXPECT_NEAR(1.0, ground.u_of_xy[0] * f[0] + ground.u_of_xy[1] * f[1], 1e-12);
        EXPECT_NEAR(0.0, ground.u_of_xy[0] * r[0] + ground.u_of_xy[1] * r[1], 1e-12);
        EXPECT_NEAR(1.0, ground.v_of_xy[0] * r[0] + ground.v_of_xy[1] * r[1], 1e-12);
        EXPECT_NEAR(yaw, std::atan2(f[1], f[0]), 1e-9);
    }
}

TEST(Ground, a_cell_above_a_slope_stands_uphill_of_its_foot)
{
    Scene scene;
    scene.show(
        [](double x, double y)
        {
            const bool is_pillar = (std::fabs(x - 0.55) < 0.04) && (std::fabs(y - 0.05) < 0.04);
            return slope_20_deg_north(x, y) + (is_pillar ? 0.5 : 0.0);
        });
    const nav_ground_t ground = placed(scene, 0.05, 0.05, 0.0);
    nav_ground_point_t point;
    const int32_t row = 155;
    const int32_t col = 150;
    ASSERT_TRUE(nav_ground_cell(&ground, row, col, &point));
    EXPECT_NEAR(0.5 * std::cos(20.0 * DEG), point.eta_m, 0.01);
    EXPECT_NEAR((0.5 / std::cos(20.0 * DEG)) + (0.5 * std::sin(20.0 * DEG)), point.u_m, 0.01);
    EXPECT_NEAR(0.0, point.v_m, 1e-3);
}

TEST(Ground, rows_and_columns_hold_exactly_the_cells_whose_foot_is_in_the_box)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.2 * x) - (0.3 * y); });
    for (double yaw : {0.0, 0.4, 1.5707963267948966, 2.2, -2.9})
    {
        const nav_ground_t ground = placed(scene, 0.33, -0.71, yaw);
        const nav_box_t box = {0.4, -0.2, 1.1, 0.6};
        uint32_t counted = 0;
        uint32_t outside = 0;
        const nav_columns_t rows = nav_ground_rows(&ground, &box);
        for (int32_t row = rows.first; row <= rows.last; row++)
        {
            const nav_columns_t cols = nav_ground_columns(&ground, &box, row, &outside);
            counted += (cols.last >= cols.first) ? (cols.last - cols.first + 1) : 0;
        }
        uint32_t expected = 0;
        for (int32_t row = 0; row < NAV_HEIGHTMAP_SIZE; row++)
        {
            for (int32_t col = 0; col < NAV_HEIGHTMAP_SIZE; col++)
            {
                const double dx = (row - ground.row) * 0.1;
                const double dy = (col - ground.col) * 0.1;
                const double u = ground.u_of_xy[0] * dx + ground.u_of_xy[1] * dy;
                const double v = ground.v_of_xy[0] * dx + ground.v_of_xy[1] * dy;
                const bool is_inside = (std::fabs(u - box.u_m) <= box.half_u_m + 1e-9) &&
                                       (std::fabs(v - box.v_m) <= box.half_v_m + 1e-9);
                expected += is_inside ? 1 : 0;
            }
        }
        EXPECT_EQ(expected, counted);
        EXPECT_EQ(0U, outside);
    }
}

TEST(Ground, cells_off_the_map_are_counted_and_not_given)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 14.0, 14.0, 0.0);
    const nav_box_t box = {1.0, 1.0, 1.0, 1.0};
    uint32_t outside = 0;
    uint32_t inside = 0;
    const nav_columns_t rows = nav_ground_rows(&ground, &box);
    for (int32_t row = rows.first; row <= rows.last; row++)
    {
        const nav_columns_t cols = nav_ground_columns(&ground, &box, row, &outside);
        EXPECT_LT(cols.last, NAV_HEIGHTMAP_SIZE);
        inside += (cols.last >= cols.first) ? (cols.last - cols.first + 1) : 0;
    }
    EXPECT_EQ(100U, inside);
    EXPECT_EQ(300U, outside);
}

TEST(Ground, unknown_corners_make_the_height_unknown)
{
    Scene scene;
    scene.show(flat, [](double x, double) { return (x > 1.0) ? 1.0 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
    EXPECT_NEAR(0.0, nav_ground_eta_m(&ground, 0.5, 0.0), 1e-6);
    EXPECT_LT(nav_ground_eta_m(&ground, 3.0, 0.0), -0.5 * NAV_ETA_NONE);
    EXPECT_LT(nav_ground_eta_m(&ground, -30.0, 0.0), -0.5 * NAV_ETA_NONE);
    EXPECT_LT(nav_ground_eta_m(&ground, 0.0, 30.0), -0.5 * NAV_ETA_NONE);
    nav_ground_point_t point;
    EXPECT_FALSE(nav_ground_cell(&ground, 200, 150, &point));
}

TEST(Ground, there_is_no_place_off_the_costmap_or_where_no_plane_was_fitted)
{
    Scene scene;
    scene.show(flat, [](double x, double) { return (x > 1.0) ? 1.0 : 0.0; });
    nav_ground_t ground;
    const nav_pose2_t off = {100.0, 0.0, 0.0};
    const nav_pose2_t unknown = {8.0, 0.0, 0.0};
    EXPECT_FALSE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap, &off));
    EXPECT_FALSE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap, &unknown));
}

TEST(Ground, any_unknown_corner_makes_the_height_between_four_cells_unknown)
{
    for (int corner = 0; corner < 4; corner++)
    {
        const double x_hidden = 0.15 + 0.1 * (corner / 2);
        const double y_hidden = 0.15 + 0.1 * (corner % 2);
        Scene scene([](nav_params_t &params) { params.surface_fill_neighbors = 9.0; });
        scene.show(flat, [=](double x, double y)
                   { return (std::hypot(x - x_hidden, y - y_hidden) < 0.01) ? 1.0 : 0.0; });
        const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
        EXPECT_LT(nav_ground_eta_m(&ground, 0.2, 0.2), -0.5 * NAV_ETA_NONE) << corner;
        EXPECT_NEAR(0.0, nav_ground_eta_m(&ground, 0.4, 0.2), 1e-6) << corner;
    }
}

TEST(Ground, beyond_every_edge_of_the_map_the_height_is_unknown)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
    for (double far_m : {15.0, 30.0})
    {
        EXPECT_LT(nav_ground_eta_m(&ground, far_m, 0.0), -0.5 * NAV_ETA_NONE);
        EXPECT_LT(nav_ground_eta_m(&ground, -far_m, 0.0), -0.5 * NAV_ETA_NONE);
        EXPECT_LT(nav_ground_eta_m(&ground, 0.0, far_m), -0.5 * NAV_ETA_NONE);
        EXPECT_LT(nav_ground_eta_m(&ground, 0.0, -far_m), -0.5 * NAV_ETA_NONE);
    }
    EXPECT_NEAR(0.0, nav_ground_eta_m(&ground, 14.8, -14.8), 1e-6);
}

TEST(Ground, a_row_beside_the_box_holds_no_columns_on_any_heading)
{
    Scene scene;
    scene.show(flat);
    const nav_box_t box = {0.0, 0.0, 0.5, 0.3};
    for (double yaw : {0.0, 0.4, 1.5707963267948966})
    {
        const nav_ground_t ground = placed(scene, 0.05, 0.05, yaw);
        for (int32_t row : {120, 180})
        {
            uint32_t outside = 0;
            const nav_columns_t cols = nav_ground_columns(&ground, &box, row, &outside);
            EXPECT_LT(cols.last, cols.first) << yaw;
            EXPECT_EQ(0U, outside) << yaw;
        }
    }
}

TEST(Ground, a_line_gives_no_more_crossings_than_there_is_room_for)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
    nav_crossings_t crossings;
    nav_ground_crossings(&ground, NAV_GROUND_ROWS, 0.0, 0.0, 10.0, &crossings);
    EXPECT_EQ(static_cast<uint32_t>(NAV_CROSSINGS_MAX), crossings.count);
    nav_ground_crossings(&ground, NAV_GROUND_ROWS, 0.0, 0.0, 1.0, &crossings);
    EXPECT_EQ(20U, crossings.count);
    nav_ground_crossings(&ground, NAV_GROUND_COLUMNS, 0.0, 0.0, 1.0, &crossings);
    EXPECT_EQ(0U, crossings.count);
}

} // namespace
