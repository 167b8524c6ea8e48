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

/// Surfaces of a drive, and balls on each.
class RestOnDrive : public testing::Test
{
  protected:
    void begin(double cell_m, double radius_m)
    {
        params.heightmap_cell_m = cell_m;
        params.wheel_radius_m = radius_m;
        nav_heightmap_init(&ctx->heightmap, &params);
        ctx->surface_state = {};
        ctx->relief = {};
    }

    /// Known ground of a size in cells with a few gaps, some cells ahead of a place in cells.
    void show(int row, int col, int size, int ahead)
    {
        const double cell_m = params.heightmap_cell_m;
        const nav_pose_t pose = {row * cell_m, col * cell_m, 0.0, 0.0, 0.0, 0.0};
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        std::vector<nav_point_t> points;
        for (int k = 0; k < size * size; k++)
        {
            const bool is_hole = (random() % 400U) == 0U;
            points.push_back(
                {static_cast<float>((ahead + (k / size) + 0.5) * cell_m),
                 static_cast<float>(((k % size) - (size / 2) + 0.5) * cell_m),
                 static_cast<float>(0.2 * unit(random) - (random() % 30U ? 0.0 : 0.3))});
            if (is_hole)
            {
                points.resize(points.size() - std::min<size_t>(points.size(), 3U));
            }
        }
        step += 1U;
        ASSERT_TRUE(nav_heightmap_center(&ctx->heightmap, pose.x_site_m, pose.y_site_m));
        for (size_t k = 0; k < points.size(); k += NAV_CHUNK_POINTS_MAX)
        {
            nav_heightmap_merge(
                &ctx->heightmap, &pose, step, step, &points[k],
                static_cast<uint32_t>(std::min<size_t>(points.size() - k, NAV_CHUNK_POINTS_MAX)));
        }
        surface_again();
    }

    void surface_again()
    {
        nav_heightmap_surface(&ctx->heightmap, &params, step, &ctx->surface_state, &ctx->surface);
    }

    void rest(nav_relief_t &relief) const
    {
        nav_relief_rest(&relief, &ctx->surface, &ctx->surface_state, params.wheel_radius_m);
    }

    /// What the header says of a cell, without any short cut.
    float plainly(int row, int col) const
    {
        const double cell_m = params.heightmap_cell_m;
        const int reach = static_cast<int>((params.wheel_radius_m / cell_m) + 2.0);
        const auto fall_m = [&](int away)
        {
            const double away_m = away * cell_m;
            return static_cast<float>(((away_m * away_m) - (0.5 * cell_m * cell_m)) /
                                      (2.0 * params.wheel_radius_m));
        };
        float highest_m = NAV_SURFACE_UNKNOWN_M;
        for (int r = row - reach; r <= row + reach; r++)
        {
            for (int c = col - reach; c <= col + reach; c++)
            {
                const bool is_on =
                    (r >= 0) && (r < NAV_HEIGHTMAP_SIZE) && (c >= 0) && (c < NAV_HEIGHTMAP_SIZE);
                const float z_m = is_on ? ctx->surface.z_site_m[(r * NAV_HEIGHTMAP_SIZE) + c]
                                        : NAV_SURFACE_UNKNOWN_M;
                if (z_m >= NAV_SURFACE_UNKNOWN_M)
                {
                    return -NAV_SURFACE_UNKNOWN_M;
                }
                highest_m = std::min(highest_m, (z_m + fall_m(r - row)) + fall_m(c - col));
            }
        }
        return highest_m;
    }

    /// Balls rest on what changed: as on all of it, and as the header says.
    void expect_rest_of_all()
    {
        auto fresh = std::make_unique<nav_relief_t>();
        rest(*fresh);
        rest(ctx->relief);
        ASSERT_EQ(0, std::memcmp(fresh->rest_z_site_m, ctx->relief.rest_z_site_m,
                                 sizeof(fresh->rest_z_site_m)));
        for (int k = 0; k < 3000; k++)
        {
            const int row = static_cast<int>(random() % NAV_HEIGHTMAP_SIZE);
            const int col = static_cast<int>(random() % NAV_HEIGHTMAP_SIZE);
            const float rest_z_m = fresh->rest_z_site_m[(row * NAV_HEIGHTMAP_SIZE) + col];
            ASSERT_EQ(plainly(row, col), rest_z_m) << row << ", " << col;
            known_count += (rest_z_m > -NAV_SURFACE_UNKNOWN_M) ? 1 : 0;
        }
    }

    nav_params_t params = []
    {
        nav_params_t defaults;
        nav_params_default(&defaults);
        return defaults;
    }();
    std::unique_ptr<nav_ctx_t> ctx = std::make_unique<nav_ctx_t>();
    std::mt19937 random{7};
    uint32_t step = 0;
    int known_count = 0;
};

TEST_F(RestOnDrive, is_the_same_to_the_last_bit_on_what_changed_as_on_all)
{
    /* balls that reach 4 cells, as far as any, and as little */
    for (const auto &[cell_m, radius_m] : {std::pair{0.1, RADIUS_M}, {0.05, 0.5}, {0.2, 0.05}})
    {
        begin(cell_m, radius_m);
        params.heightmap_expiry_s = 10.0;
        known_count = 0;
        int row = -7;
        int col = 3;
        show(row, col, 290, -145);
        ASSERT_NO_FATAL_FAILURE(expect_rest_of_all());
        for (int k = 0; k < 24; k++)
        {
            row += static_cast<int>(random() % 23U) - ((k < 12) ? 3 : 19);
            col += static_cast<int>(random() % 23U) - 11;
            col += (k == 18) ? 400 : 0; // nothing stays
            show(row, col, ((k % 6) == 5) ? 290 : 120, ((k % 6) == 5) ? -145 : 10);
            ASSERT_NO_FATAL_FAILURE(expect_rest_of_all()) << k;
        }
        EXPECT_GT(known_count, 5000);
    }
}

TEST_F(RestOnDrive, is_not_done_again_far_from_what_changed)
{
    begin(0.1, RADIUS_M);
    show(0, 0, 300, -150);
    rest(ctx->relief);
    const int place = (60 * NAV_HEIGHTMAP_SIZE) + 60;
    ctx->relief.rest_z_site_m[place] = 7.0F; // what only another rest could replace
    surface_again();
    rest(ctx->relief);
    EXPECT_EQ(7.0F, ctx->relief.rest_z_site_m[place]);
    show(0, 0, 60, 0);
    rest(ctx->relief);
    EXPECT_EQ(7.0F, ctx->relief.rest_z_site_m[place]);
    show(0, 0, 60, -120);
    rest(ctx->relief);
    EXPECT_EQ(7.0F, ctx->relief.rest_z_site_m[place]);
    show(0, -60, 60, 0); // the map rolls: what was made before moves along
    rest(ctx->relief);
    EXPECT_EQ(7.0F, ctx->relief.rest_z_site_m[place + 60]);
}

} // namespace
