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
    EXPECT_TRUE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap,
                                 &scene.ctx->relief, &pose));
    return ground;
}

/// Height above the plane, along z, of a heightmap cell.
double above_of_cell(const nav_ground_t &ground, int row, int col)
{
    const double north_m = (row - ground.row) * 0.1;
    const double east_m = (col - ground.col) * 0.1;
    return (ground.z_site_m + (ground.dz_dx * north_m) + (ground.dz_dy * east_m)) -
           ground.surface->z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col];
}

double hills(double x_m, double y_m)
{
    return (0.2 * x_m) - (0.1 * y_m) + (0.15 * std::sin(3.0 * x_m) * std::cos(2.0 * y_m));
}

TEST(Ground, a_plane_has_no_heights_above_itself)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.3 * x) - (0.1 * y) + 7.0; });
    const nav_ground_t ground = placed(scene, 1.05, -2.05, 0.0);
    for (double u = -2.0; u <= 2.0; u += 0.37)
    {
        for (double v = -2.0; v <= 2.0; v += 0.41)
        {
            /* the nearest cell is up to half a cell away, on the plane too */
            EXPECT_NEAR(0.0, nav_ground_eta_m(&ground, u, v), 0.05 * 0.4);
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

TEST(Ground, lanes_lead_to_the_same_cells_as_the_axes)
{
    Scene scene;
    scene.show(hills);
    for (double yaw = -3.1; yaw < 3.1; yaw += 0.37)
    {
        const nav_ground_t ground = placed(scene, 0.33, -0.71, yaw);
        const nav_lanes_t &lanes = ground.lanes;
        /* a step along the heading never passes a line by more than one cell */
        EXPECT_LE(std::fabs(lanes.minor_per_major), 1.0 + 1e-6) << yaw;
        for (double u : {-1.0, 0.0, 0.7})
        {
            for (double v : {-0.8, 0.4})
            {
                const double north = ground.forward_xy[0] * u + ground.right_xy[0] * v;
                const double east = ground.forward_xy[1] * u + ground.right_xy[1] * v;
                const double major = lanes.major + lanes.major_per_u * u + lanes.major_per_v * v;
                const double minor = lanes.minor + lanes.minor_per_u * u + lanes.minor_per_v * v;
                const bool is_row = lanes.step_major == NAV_HEIGHTMAP_SIZE;
                EXPECT_NEAR(ground.row + 10.0 * north, is_row ? major : minor, 1e-9);
                EXPECT_NEAR(ground.col + 10.0 * east, is_row ? minor : major, 1e-9);
                EXPECT_NEAR(ground.z_site_m + ground.dz_dx * north + ground.dz_dy * east,
                            lanes.plane_first_m + lanes.plane_major_m * major +
                                lanes.plane_minor_m * minor,
                            1e-9);
                /* along one line */
                const double aside = 0.3;
                const double du = aside * lanes.minor_across * lanes.u_per_minor;
                EXPECT_NEAR(major, major + lanes.major_per_u * du + lanes.major_per_v * aside,
                            1e-9);
                EXPECT_NEAR(aside * lanes.minor_across,
                            lanes.minor_per_u * du + lanes.minor_per_v * aside, 1e-9);
            }
        }
    }
}

TEST(Ground, there_is_no_place_off_the_costmap_or_where_no_plane_was_fitted)
{
    Scene scene;
    scene.show(flat, [](double x, double) { return (x > 1.0) ? 1.0 : 0.0; });
    const nav_ctx_t *ctx = scene.ctx.get();
    nav_ground_t ground;
    const nav_pose2_t off = {100.0, 0.0, 0.0};
    const nav_pose2_t unknown = {8.0, 0.0, 0.0};
    EXPECT_FALSE(nav_ground_place(&ground, &ctx->surface, &ctx->costmap, &ctx->relief, &off));
    EXPECT_FALSE(nav_ground_place(&ground, &ctx->surface, &ctx->costmap, &ctx->relief, &unknown));
}

TEST(Ground, beyond_every_edge_of_the_map_the_height_is_unknown)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
    for (double far_m : {15.1, 30.0})
    {
        EXPECT_LT(nav_ground_eta_m(&ground, far_m, 0.0), -0.5 * NAV_ETA_NONE);
        EXPECT_LT(nav_ground_eta_m(&ground, -far_m, 0.0), -0.5 * NAV_ETA_NONE);
        EXPECT_LT(nav_ground_eta_m(&ground, 0.0, far_m), -0.5 * NAV_ETA_NONE);
        EXPECT_LT(nav_ground_eta_m(&ground, 0.0, -far_m), -0.5 * NAV_ETA_NONE);
    }
    EXPECT_NEAR(0.0, nav_ground_eta_m(&ground, 14.8, -14.8), 1e-6);
}

TEST(Ground, whole_numbers_between_two_numbers)
{
    EXPECT_EQ(3, nav_ground_between(2.2, 5.9).first);
    EXPECT_EQ(5, nav_ground_between(2.2, 5.9).last);
    EXPECT_EQ(2, nav_ground_between(2.0, 5.0).first);
    EXPECT_EQ(5, nav_ground_between(2.0, 5.0).last);
    EXPECT_EQ(-1, nav_ground_between(-1.0, -0.5).first);
    const nav_indices_t none = nav_ground_between(5.0, 2.0);
    EXPECT_LT(none.last, none.first);
}

TEST(Ground, the_range_around_a_box_holds_every_cell_whose_foot_is_in_it)
{
    Scene scene;
    scene.show(hills);
    for (double yaw = -3.0; yaw < 3.0; yaw += 0.41)
    {
        const nav_ground_t ground = placed(scene, 0.33, -0.71, yaw);
        const nav_box_t box = {0.6, -0.4, 0.5, 0.3};
        nav_interval_t above;
        ASSERT_TRUE(nav_ground_range(&ground, &box, &above));
        int cell_count = 0;
        for (int row = 0; row < NAV_HEIGHTMAP_SIZE; row++)
        {
            for (int col = 0; col < NAV_HEIGHTMAP_SIZE; col++)
            {
                const double north = (row - ground.row) * 0.1;
                const double east = (col - ground.col) * 0.1;
                const double u = ground.u_of_xy[0] * north + ground.u_of_xy[1] * east;
                const double v = ground.v_of_xy[0] * north + ground.v_of_xy[1] * east;
                if ((std::fabs(u - box.u_m) <= box.half_u_m) &&
                    (std::fabs(v - box.v_m) <= box.half_v_m))
                {
                    cell_count++;
                    EXPECT_GE(above_of_cell(ground, row, col), above.low_m - 1e-6) << yaw;
                    EXPECT_LE(above_of_cell(ground, row, col), above.high_m + 1e-6) << yaw;
                }
            }
        }
        EXPECT_GT(cell_count, 40);
    }
}

TEST(Ground, the_range_is_unknown_where_a_cell_is_or_at_the_edge_of_the_map)
{
    Scene scene([](nav_params_t &params) { params.surface_fill_neighbors = 9.0; });
    scene.show(flat, [](double x, double y)
               { return (std::hypot(x - 1.05, y - 1.05) < 0.01) ? 1.0 : 0.0; });
    const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
    nav_interval_t above;
    const nav_box_t known = {-1.0, -1.0, 0.3, 0.3};
    const nav_box_t hidden = {1.05, 1.05, 0.3, 0.3};
    EXPECT_TRUE(nav_ground_range(&ground, &known, &above));
    EXPECT_FALSE(nav_ground_range(&ground, &hidden, &above));
    for (double sign : {-1.0, 1.0})
    {
        const nav_box_t north = {sign * 15.0, 0.0, 0.3, 0.3};
        const nav_box_t east = {0.0, sign * 15.0, 0.3, 0.3};
        EXPECT_FALSE(nav_ground_range(&ground, &north, &above));
        EXPECT_FALSE(nav_ground_range(&ground, &east, &above));
    }
}

TEST(Ground, a_box_between_the_cells_of_two_costmap_cells_holds_nothing)
{
    Scene scene;
    scene.show(flat);
    const nav_ground_t ground = placed(scene, 0.25, 0.25, 0.0);
    nav_interval_t above;
    const nav_box_t between = {0.25, 0.0, 0.01, 0.01};
    EXPECT_FALSE(nav_ground_range(&ground, &between, &above));
}

TEST(Ground, costmap_cells_that_stick_out_of_the_surface_are_not_given)
{
    Scene scene;
    scene.goal = {100.0, 0.0, 1.0};
    scene.show(flat);
    /* moving on by two heightmap cells leaves the surface's edges inside costmap cells */
    nav_ctx_t &ctx = *scene.ctx;
    ASSERT_TRUE(nav_heightmap_center(&ctx.heightmap, 0.25, 0.25));
    nav_heightmap_surface(&ctx.heightmap, &ctx.params, 1.0, &ctx.surface_state, &ctx.surface);
    nav_relief_update(&ctx.relief, &ctx.costmap, &ctx.costmap_state, &ctx.surface);
    const nav_ground_t ground = placed(scene, 0.0, 0.0, 0.0);
    nav_cost_box_t cells;
    const nav_box_t south = {-14.6, 0.0, 0.05, 0.05};
    const nav_box_t north = {15.1, 0.0, 0.05, 0.05};
    const nav_box_t middle = {0.0, 0.0, 1.0, 1.0};
    EXPECT_FALSE(nav_ground_cost_box(&ground, &south, &cells));
    EXPECT_FALSE(nav_ground_cost_box(&ground, &north, &cells));
    ASSERT_TRUE(nav_ground_cost_box(&ground, &middle, &cells));
    for (int32_t row = cells.rows.first; row <= cells.rows.last; row++)
    {
        EXPECT_TRUE(nav_ground_tile(&ground, row, cells.cols.first,
                                    nav_ground_tile_north_m(&ground, row),
                                    nav_ground_tile_east_m(&ground, cells.cols.first))
                        .is_whole);
    }
}

} // namespace
