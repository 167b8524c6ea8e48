// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "nav_scene.hpp"

namespace
{

/// Index of the costmap cell at a place.
uint32_t cell_at(const Scene &scene, double x_m, double y_m)
{
    uint32_t index = 0;
    EXPECT_TRUE(nav_costmap_find(&scene.ctx->costmap, x_m, y_m, &index));
    return index;
}

TEST(Relief, a_plane_has_none)
{
    Scene scene;
    scene.show([](double x, double y) { return (0.3 * x) - (0.1 * y) + 2.0; });
    const nav_relief_cell_t &cell = scene.ctx->relief.cells[cell_at(scene, 3.2, -4.1)];
    EXPECT_EQ(1U, cell.is_whole);
    EXPECT_NEAR(0.0, cell.above_m, 1e-5);
    EXPECT_NEAR(0.0, cell.below_m, 1e-5);
}

TEST(Relief, a_stone_and_a_hole_are_its_highest_and_lowest)
{
    Scene scene;
    scene.show(
        [](double x, double y)
        {
            const double stone = (std::hypot(x - 3.05, y - 4.05) < 0.04) ? 0.3 : 0.0;
            const double hole = (std::hypot(x - 3.35, y - 4.25) < 0.04) ? -0.2 : 0.0;
            return stone + hole;
        });
    const uint32_t index = cell_at(scene, 3.2, 4.2);
    const nav_cost_cell_t &plane = scene.ctx->costmap.cells[index];
    const nav_relief_cell_t &cell = scene.ctx->relief.cells[index];
    /* the stone stands at 0.2 m south and west of the middle, the hole 0.1 m north of it */
    const double plane_stone_m =
        plane.plane_z_site_m - (0.2 * plane.plane_dz_dx) - (0.2 * plane.plane_dz_dy);
    const double plane_hole_m = plane.plane_z_site_m + (0.1 * plane.plane_dz_dx);
    EXPECT_NEAR(plane_stone_m + 0.3, cell.above_m, 1e-5);
    EXPECT_NEAR(plane_hole_m - 0.2, cell.below_m, 1e-5);
}

TEST(Relief, a_cell_that_is_not_wholly_known_has_none)
{
    Scene scene([](nav_params_t &params) { params.surface_fill_neighbors = 9.0; });
    scene.show(flat, [](double x, double y)
               { return (std::hypot(x - 1.05, y - 1.05) < 0.01) ? 1.0 : 0.0; });
    EXPECT_EQ(0U, scene.ctx->relief.cells[cell_at(scene, 1.2, 1.2)].is_whole);
    EXPECT_EQ(1U, scene.ctx->relief.cells[cell_at(scene, 1.2, 1.7)].is_whole);
}

TEST(Relief, a_cell_off_the_surface_has_none)
{
    Scene scene;
    scene.show(flat);
    EXPECT_EQ(0U, scene.ctx->relief.cells[cell_at(scene, 20.0, 0.0)].is_whole);
    EXPECT_EQ(0U, scene.ctx->relief.cells[cell_at(scene, -20.0, 0.0)].is_whole);
    EXPECT_EQ(0U, scene.ctx->relief.cells[cell_at(scene, 0.0, 20.0)].is_whole);
    EXPECT_EQ(0U, scene.ctx->relief.cells[cell_at(scene, 0.0, -20.0)].is_whole);
}

TEST(Relief, a_cell_without_a_plane_has_none)
{
    Scene scene;
    scene.show(flat);
    const uint32_t index = cell_at(scene, 1.0, 1.0);
    scene.ctx->costmap.cells[index].is_known = 0U;
    nav_relief_update(&scene.ctx->relief, &scene.ctx->costmap, &scene.ctx->costmap_state,
                      &scene.ctx->surface);
    EXPECT_EQ(0U, scene.ctx->relief.cells[index].is_whole);
}

TEST(Relief, is_the_same_whether_made_step_by_step_or_at_once)
{
    const auto world = [](double x, double y)
    { return 0.1 * std::sin(5.0 * x) * std::cos(4.0 * y); };
    Scene grown;
    grown.show(world);
    const auto changed = [&](double x, double y)
    { return world(x, y) + ((std::hypot(x - 4.0, y + 3.0) < 0.5) ? 0.3 : 0.0); };
    grown.show(changed);
    Scene fresh;
    fresh.show(changed);
    for (int cell = 0; cell < NAV_COSTMAP_CELLS; cell++)
    {
        ASSERT_EQ(fresh.ctx->relief.cells[cell].is_whole, grown.ctx->relief.cells[cell].is_whole);
        ASSERT_EQ(fresh.ctx->relief.cells[cell].above_m, grown.ctx->relief.cells[cell].above_m);
        ASSERT_EQ(fresh.ctx->relief.cells[cell].below_m, grown.ctx->relief.cells[cell].below_m);
    }
}

constexpr double RADIUS_M = 0.26288;

/// Height of the lowest point of a ball that rests over a cell, up.
double rest_m(const Scene &scene, int row, int col)
{
    return -scene.ctx->relief.rest_z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col];
}

/// The bilinear surface at a place in cells, up.
double ground_m(const Scene &scene, double row, double col)
{
    const int r = static_cast<int>(row);
    const int c = static_cast<int>(col);
    const float *z = &scene.ctx->surface.z_site_m[(r * NAV_HEIGHTMAP_SIZE) + c];
    const double south = z[0] + ((col - c) * (z[1] - z[0]));
    const double north =
        z[NAV_HEIGHTMAP_SIZE] + ((col - c) * (z[NAV_HEIGHTMAP_SIZE + 1] - z[NAV_HEIGHTMAP_SIZE]));
    return -(south + ((row - r) * (north - south)));
}

TEST(Rest, on_a_plane_is_less_than_two_centimetres_above_it)
{
    Scene scene;
    scene.show(flat);
    EXPECT_NEAR(0.01 / (2.0 * RADIUS_M), rest_m(scene, 150, 170), 1e-6);
    EXPECT_LT(rest_m(scene, 150, 170), 0.02);
}

TEST(Rest, no_ball_between_four_cells_rests_higher_than_the_highest_of_them)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Scene scene;
    scene.show([&](double, double)
               { return (0.15 * unit(random)) + ((random() % 30U == 0U) ? 0.3 : 0.0); });
    for (int trial = 0; trial < 300; trial++)
    {
        const int row = 100 + static_cast<int>(random() % 100U);
        const int col = 100 + static_cast<int>(random() % 100U);
        const double hub_row = row + unit(random);
        const double hub_col = col + unit(random);
        double ball_m = -1e9;
        for (double along = -RADIUS_M; along <= RADIUS_M; along += 0.01)
        {
            for (double across = -RADIUS_M; across <= RADIUS_M; across += 0.01)
            {
                const double over = (RADIUS_M * RADIUS_M) - (along * along) - (across * across);
                if (over >= 0.0)
                {
                    ball_m = std::max(
                        ball_m, ground_m(scene, hub_row + 10.0 * along, hub_col + 10.0 * across) +
                                    std::sqrt(over) - RADIUS_M);
                }
            }
        }
        const double highest_m =
            std::max({rest_m(scene, row, col), rest_m(scene, row, col + 1),
                      rest_m(scene, row + 1, col), rest_m(scene, row + 1, col + 1)});
        EXPECT_LE(ball_m, highest_m + 1e-6);
    }
}

TEST(Rest, a_ball_near_unknown_ground_or_the_edge_could_be_anywhere)
{
    Scene scene([](nav_params_t &params) { params.surface_fill_neighbors = 9.0; });
    scene.show(flat, [](double x, double y)
               { return (std::hypot(x - 1.05, y - 1.05) < 0.01) ? 1.0 : 0.0; });
    /* the hidden cell is 160, 160 */
    EXPECT_GT(rest_m(scene, 160, 164), 1e8);
    EXPECT_GT(rest_m(scene, 156, 156), 1e8);
    EXPECT_LT(rest_m(scene, 160, 165), 0.02);
    EXPECT_GT(rest_m(scene, 3, 160), 1e8);
    EXPECT_GT(rest_m(scene, 160, 296), 1e8);
    EXPECT_LT(rest_m(scene, 4, 160), 0.02);
    EXPECT_LT(rest_m(scene, 160, 295), 0.02);
}

} // namespace
