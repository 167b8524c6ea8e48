// SPDX-License-Identifier: Apache-2.0
#include <cstring>
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

} // namespace
