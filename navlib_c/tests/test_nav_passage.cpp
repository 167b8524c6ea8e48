// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "nav_scene.hpp"

namespace
{

constexpr int kSize = NAV_COSTMAP_SIZE;
constexpr int kSurface = NAV_HEIGHTMAP_SIZE;
constexpr int kBlock = NAV_CELLS_PER_COST_CELL;
constexpr std::array<int, 2> PLACES[] = {{0, 0}, {3, -21}, {-37, 14}, {-4, 49}};
constexpr std::array<int, 2> EDGES[] = {{-50, 0}, {49, 0}, {0, -50}, {0, 49}, {-50, 49}};

/// Flat known ground over the middle of the costmap, on which single cells are raised or lowered.
class Passage : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        nav_params_default(&params);
        nav_costmap_init(map.get(), &params);
        ASSERT_TRUE(nav_costmap_recenter(map.get(), &params, 0.0, 0.0));
        surface->cell_m = params.heightmap_cell_m;
        surface->origin_row = -kSurface / 2;
        surface->origin_col = -kSurface / 2;
        std::fill(std::begin(surface->z_site_m), std::end(surface->z_site_m), 0.0F);
        state->surface_count = 1U;
        for (int row = -kSurface / 2 / kBlock; row < kSurface / 2 / kBlock; row++)
        {
            for (int col = -kSurface / 2 / kBlock; col < kSurface / 2 / kBlock; col++)
            {
                at(row, col).is_known = 1U;
                state->fitted_at[index_of(row, col)] = 1U;
            }
        }
    }

    static size_t index_of(int row, int col)
    {
        return static_cast<size_t>((row + kSize / 2) * kSize + col + kSize / 2);
    }

    /// By global index.
    nav_cost_cell_t &at(int row, int col)
    {
        return map->cells[index_of(row, col)];
    }

    /// A heightmap cell by global index.
    void raise(int row, int col, double up_m)
    {
        surface->z_site_m[(row + kSurface / 2) * kSurface + col + kSurface / 2] =
            static_cast<float>(-up_m);
    }

    void update()
    {
        nav_passage_init(&params, footprint.get());
        nav_passage_update(map.get(), state.get(), &params, footprint.get(), relief.get(),
                           surface.get());
    }

    /// Is the middle of a heightmap cell under a rover that stands on the middle of a costmap cell?
    bool is_under(int row, int col, int heading, int z_row, int z_col, bool is_belly) const
    {
        const double north_m = (z_row + 0.5) * 0.1 - (row + 0.5) * 0.5;
        const double east_m = (z_col + 0.5) * 0.1 - (col + 0.5) * 0.5;
        const double yaw_rad = heading * 45.0 * DEG;
        const double x_m = std::cos(yaw_rad) * north_m + std::sin(yaw_rad) * east_m;
        const double y_m = std::cos(yaw_rad) * east_m - std::sin(yaw_rad) * north_m;
        const double grown_m = params.barred_growth_m;
        if (is_belly)
        {
            return x_m < params.belly_front_x_m + grown_m &&
                   x_m > params.belly_rear_x_m - grown_m &&
                   std::fabs(y_m) < params.belly_half_width_m + grown_m;
        }
        const double hubs_m[3][2] = {{params.front_x_m, params.front_y_m},
                                     {params.middle_x_m, params.middle_y_m},
                                     {params.rear_x_m, params.rear_y_m}};
        return std::any_of(std::begin(hubs_m), std::end(hubs_m),
                           [&](const double *hub)
                           {
                               return std::fabs(x_m - hub[0]) < params.wheel_radius_m + grown_m &&
                                      std::fabs(std::fabs(y_m) - hub[1]) <
                                          0.5 * params.wheel_width_m + grown_m;
                           });
    }

    /// Every cell is barred as an obstacle at one heightmap cell demands, and no other.
    void expect_barred_by(int z_row, int z_col, bool is_belly, bool is_wheel)
    {
        for (int row = -kSize / 2; row < kSize / 2; row++)
        {
            for (int col = -kSize / 2; col < kSize / 2; col++)
            {
                uint32_t expected = 0U;
                for (int heading = 0; heading < NAV_HEADINGS; heading++)
                {
                    const bool is_barred =
                        (is_belly && is_under(row, col, heading, z_row, z_col, true)) ||
                        (is_wheel && is_under(row, col, heading, z_row, z_col, false));
                    expected |= is_barred ? 1U << heading : 0U;
                }
                ASSERT_EQ(expected, at(row, col).barred_headings) << row << " " << col;
            }
        }
    }

    double belly_limit_m() const
    {
        return params.belly_height_m - params.clearance_min_m - params.barred_margin_m;
    }

    double wheel_limit_m() const
    {
        return params.wheel_drop_max_m - params.barred_margin_m;
    }

    nav_params_t params = {};
    std::unique_ptr<nav_costmap_t> map = std::make_unique<nav_costmap_t>();
    std::unique_ptr<nav_costmap_state_t> state = std::make_unique<nav_costmap_state_t>();
    std::unique_ptr<nav_surface_t> surface = std::make_unique<nav_surface_t>();
    /* nothing is whole: every cell is looked at */
    std::unique_ptr<nav_relief_t> relief = std::make_unique<nav_relief_t>();
    std::unique_ptr<nav_rover_footprint_t> footprint = std::make_unique<nav_rover_footprint_t>();
};

} // namespace

TEST_F(Passage, flat_ground_bars_nothing)
{
    update();
    expect_barred_by(0, 0, false, false);
}

TEST_F(Passage, a_stone_too_high_for_the_belly_bars_the_poses_over_it_wheels_may_climb_it)
{
    params.barred_growth_m = 0.103; /* no edge on the middle of a cell */
    for (const std::array<int, 2> &place : PLACES)
    {
        raise(place[0], place[1], belly_limit_m() + 0.001);
        update();
        expect_barred_by(place[0], place[1], true, false);
        raise(place[0], place[1], belly_limit_m() - 0.001);
        update();
        expect_barred_by(place[0], place[1], false, false);
    }
}

TEST_F(Passage, a_rock_bars_the_poses_with_a_wheel_on_it_too)
{
    params.barred_growth_m = 0.103;
    raise(12, 7, wheel_limit_m() + 0.001);
    update();
    expect_barred_by(12, 7, true, true);
}

TEST_F(Passage, a_hole_bars_the_poses_with_a_wheel_in_it_only)
{
    params.barred_growth_m = 0.103;
    raise(12, 7, -wheel_limit_m() - 0.001);
    update();
    expect_barred_by(12, 7, false, true);
    raise(12, 7, -wheel_limit_m() + 0.001);
    update();
    expect_barred_by(12, 7, false, false);
}

TEST_F(Passage, heights_are_measured_from_the_plane_of_the_cell)
{
    nav_cost_cell_t &cell = at(2, 3);
    cell.plane_z_site_m = -1.0F;
    cell.plane_dz_dx = 0.3F;
    cell.plane_dz_dy = -0.2F;
    for (int row = 10; row < 15; row++)
    {
        for (int col = 15; col < 20; col++)
        {
            raise(row, col, 1.0 - 0.03 * (row - 12) + 0.02 * (col - 17));
        }
    }
    update();
    EXPECT_EQ(0U, cell.belly_obstacles | cell.wheel_obstacles);
    raise(11, 18, 1.0 + 0.03 + 0.02 + belly_limit_m() + 0.001);
    update();
    EXPECT_EQ(1U << (1 * kBlock + 3), cell.belly_obstacles);
    EXPECT_EQ(0U, cell.wheel_obstacles);
}

TEST_F(Passage, unknown_ground_is_no_obstacle)
{
    raise(12, 7, -static_cast<double>(NAV_SURFACE_UNKNOWN_M));
    update();
    expect_barred_by(12, 7, false, false);
}

TEST_F(Passage, a_cell_without_a_plane_has_no_obstacles)
{
    raise(12, 7, 1.0);
    update();
    EXPECT_NE(0U, at(2, 1).belly_obstacles);
    at(2, 1).is_known = 0U;
    update();
    expect_barred_by(12, 7, false, false);
    EXPECT_EQ(0U, at(2, 1).belly_obstacles | at(2, 1).wheel_obstacles);
}

TEST_F(Passage, ground_that_the_relief_calls_plain_is_not_looked_at)
{
    const auto is_looked_at = [this](double above_m, double below_m, uint8_t is_whole)
    {
        raise(12, 7, 1.0); /* what only looking could find */
        relief->cells[index_of(2, 1)] = {static_cast<float>(above_m), static_cast<float>(below_m),
                                         is_whole};
        update();
        return at(2, 1).belly_obstacles != 0U;
    };
    EXPECT_FALSE(is_looked_at(0.0, 0.0, 1U));
    EXPECT_TRUE(is_looked_at(0.0, 0.0, 0U));
    EXPECT_FALSE(is_looked_at(belly_limit_m() - 0.001, 0.001 - wheel_limit_m(), 1U));
    EXPECT_TRUE(is_looked_at(belly_limit_m() + 0.001, 0.0, 1U));
    EXPECT_TRUE(is_looked_at(0.0, -wheel_limit_m() - 0.001, 1U));
    params.clearance_min_m = 0.0; /* the wheels' limit is the lower one */
    EXPECT_TRUE(is_looked_at(wheel_limit_m() + 0.001, 0.0, 1U));
    EXPECT_FALSE(is_looked_at(wheel_limit_m() - 0.001, 0.0, 1U));
}

TEST_F(Passage, cells_that_were_not_recomputed_keep_their_obstacles)
{
    raise(12, 7, 1.0);
    update();
    const uint32_t obstacles = at(2, 1).belly_obstacles;
    raise(12, 7, 0.0);
    state->surface_count = 2U;
    update();
    EXPECT_EQ(obstacles, at(2, 1).belly_obstacles);
    EXPECT_NE(0U, at(2, 1).barred_headings);
    state->fitted_at[index_of(2, 1)] = 2U;
    update();
    EXPECT_EQ(0U, at(2, 1).belly_obstacles);
    EXPECT_EQ(0U, at(2, 1).barred_headings);
}

TEST_F(Passage, obstacles_at_an_edge_of_the_map_bar_the_cells_on_it)
{
    params.barred_growth_m = 0.103;
    for (const std::array<int, 2> &place : EDGES)
    {
        at(place[0], place[1]).belly_obstacles = 1U << 12; /* the cell in the middle */
        update();
        expect_barred_by(place[0] * kBlock + 2, place[1] * kBlock + 2, true, false);
        at(place[0], place[1]).belly_obstacles = 0U;
    }
}

TEST_F(Passage, a_footprint_beyond_the_reach_is_cut_off)
{
    params.belly_front_x_m = 5.0;
    update();
    EXPECT_LE(footprint->count, static_cast<uint32_t>(NAV_PASSAGE_SIDE * NAV_PASSAGE_SIDE));
    for (uint32_t k = 0; k < footprint->count; k++)
    {
        EXPECT_LE(std::abs(footprint->cells[k].row), NAV_PASSAGE_REACH);
        EXPECT_LE(std::abs(footprint->cells[k].col), NAV_PASSAGE_REACH);
    }
}

TEST(PassageOfScene, agrees_with_ace_about_a_rock_beside_and_under_the_rover)
{
    Scene scene;
    scene.show([](double x, double y) { return std::hypot(x - 0.25, y - 0.25) < 0.3 ? 0.4 : 0.0; });
    uint32_t index = 0U;
    for (double east_m : {0.25, 2.25})
    {
        ASSERT_TRUE(nav_costmap_find(&scene.ctx->costmap, 0.25, east_m, &index));
        const nav_ace_bounds_t bounds = scene.ace(0.25, east_m, 0.0);
        const bool is_barred = (scene.ctx->costmap.cells[index].barred_headings & 1U) != 0U;
        EXPECT_EQ(nav_ace_refuse(&scene.ctx->params, &bounds, false) != NAV_REASON_NONE, is_barred);
    }
}

TEST(PassageOfScene, is_the_same_whether_made_step_by_step_or_at_once)
{
    const auto world = [](double x, double y)
    {
        const double stone_m =
            std::hypot(x - 5.0 * std::round(x / 5.0), y - 5.0 * std::round(y / 5.0));
        return (stone_m < 0.2) ? 0.4 : 0.0;
    };
    Scene grown;
    grown.show(world);
    const auto changed = [&](double x, double y)
    { return world(x, y) + ((std::hypot(x - 4.0, y + 3.0) < 0.5) ? 0.5 : 0.0); };
    grown.show(changed);
    Scene fresh;
    fresh.show(changed);
    uint32_t barred = 0U;
    for (int cell = 0; cell < NAV_COSTMAP_CELLS; cell++)
    {
        const nav_cost_cell_t &expected = fresh.ctx->costmap.cells[cell];
        ASSERT_EQ(expected.barred_headings, grown.ctx->costmap.cells[cell].barred_headings);
        barred += (expected.barred_headings != 0U) ? 1U : 0U;
    }
    EXPECT_GT(barred, 100U);
    EXPECT_LT(barred, 3000U);
}
