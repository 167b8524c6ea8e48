// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "nav_blocks.hpp"

extern "C"
{
#include "nav_costmap.h"
#include "nav_math.h"
}

namespace
{

constexpr int kSize = NAV_COSTMAP_SIZE;
constexpr int kSurface = NAV_HEIGHTMAP_SIZE;
constexpr int kBlock = NAV_CELLS_PER_COST_CELL;
constexpr double kCell = 0.5;

class NavCostmap : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        nav_params_default(&params);
        nav_costmap_init(map.get(), &params);
        ASSERT_TRUE(nav_costmap_recenter(map.get(), &params, 0.0, 0.0));
        std::fill(std::begin(surface->z_site_m), std::end(surface->z_site_m),
                  NAV_SURFACE_UNKNOWN_M);
        surface->cell_m = params.heightmap_cell_m;
        surface->origin_row = -kSurface / 2;
        surface->origin_col = -kSurface / 2;
    }

    // height as a function of SITE north and east
    template <typename Height> void shape(Height height_of)
    {
        for (int row = 0; row < kSurface; row++)
        {
            for (int col = 0; col < kSurface; col++)
            {
                const double x = (surface->origin_row + row + 0.5) * surface->cell_m;
                const double y = (surface->origin_col + col + 0.5) * surface->cell_m;
                surface->z_site_m[row * kSurface + col] = static_cast<float>(height_of(x, y));
            }
        }
    }

    void update(double margin_m = 0.0)
    {
        mark_all();
        update_changed(margin_m);
    }

    // all blocks changed
    void mark_all()
    {
        changes->surface_count += 1U;
        std::fill(std::begin(changes->changed_at), std::end(changes->changed_at),
                  changes->surface_count);
    }

    void update_changed(double margin_m = 0.0)
    {
        nav_costmap_update(map.get(), state.get(), &params, surface.get(), changes.get());
        nav_costmap_mark(map.get(), &params, &kioz, margin_m);
    }

    // an update of what changed leaves the same cells as one of all
    void expect_cells_of_all()
    {
        auto copy = std::make_unique<nav_costmap_t>(*map);
        auto fresh = std::make_unique<nav_costmap_state_t>();
        nav_costmap_update(copy.get(), fresh.get(), &params, surface.get(), changes.get());
        nav_costmap_mark(copy.get(), &params, &kioz, 0.0);
        update_changed();
        ASSERT_EQ(0, std::memcmp(copy->cells, map->cells, sizeof(map->cells)));
    }

    nav_cost_cell_t &at(double x, double y)
    {
        uint32_t index = 0U;
        EXPECT_TRUE(nav_costmap_find(map.get(), x, y, &index));
        return map->cells[index];
    }

    // ACE's verdict along a heading at (3, 3)
    void feed_back(int heading, nav_reason_t reason)
    {
        const nav_pose2_t pose = {3.0, 3.0, heading * (NAV_PI / NAV_HEADINGS)};
        nav_costmap_feedback(map.get(), &pose, reason);
    }

    nav_cost_cell_t &by_global(int row, int col)
    {
        return map->cells[(row - map->origin_row) * kSize + col - map->origin_col];
    }

    int known_count() const
    {
        return static_cast<int>(std::count_if(std::begin(map->cells), std::end(map->cells),
                                              [](const nav_cost_cell_t &cell)
                                              { return cell.is_known == 1U; }));
    }

    // least squares over one patch, point by point about the cell's centre
    void expect_fit(int row, int col)
    {
        const int half = static_cast<int>(params.costmap_patch_cells) / 2;
        double normal[3][4] = {};
        std::vector<std::array<double, 3>> points;
        for (int r = (row - half) * kBlock; r < (row + half + 1) * kBlock; r++)
        {
            for (int c = (col - half) * kBlock; c < (col + half + 1) * kBlock; c++)
            {
                const int sr = r - surface->origin_row;
                const int sc = c - surface->origin_col;
                if (sr >= 0 && sr < kSurface && sc >= 0 && sc < kSurface &&
                    surface->z_site_m[sr * kSurface + sc] < NAV_SURFACE_UNKNOWN_M)
                {
                    const double u = (r + 0.5) * surface->cell_m - (row + 0.5) * map->cell_m;
                    const double v = (c + 0.5) * surface->cell_m - (col + 0.5) * map->cell_m;
                    points.push_back(
                        {u, v, static_cast<double>(surface->z_site_m[sr * kSurface + sc])});
                }
            }
        }
        const nav_cost_cell_t &cell = by_global(row, col);
        const double side = (2 * half + 1) * kBlock;
        if (static_cast<double>(points.size()) < params.costmap_patch_known_min * side * side)
        {
            ASSERT_EQ(cell.is_known, 0U) << row << " " << col;
            ASSERT_EQ(cell.terrain_reason, NAV_REASON_NONE);
            return;
        }
        for (const auto &p : points)
        {
            const double base[3] = {1.0, p[0], p[1]};
            for (int i = 0; i < 3; i++)
            {
                for (int j = 0; j < 3; j++)
                {
                    normal[i][j] += base[i] * base[j];
                }
                normal[i][3] += base[i] * p[2];
            }
        }
        for (int i = 0; i < 3; i++) // Gauss-Jordan
        {
            for (int k = 0; k < 3; k++)
            {
                const double factor = normal[k][i] / normal[i][i];
                for (int j = 0; (k != i) && j < 4; j++)
                {
                    normal[k][j] -= factor * normal[i][j];
                }
            }
        }
        const double z = normal[0][3] / normal[0][0];
        const double a = normal[1][3] / normal[1][1];
        const double b = normal[2][3] / normal[2][2];
        double squares = 0.0;
        for (const auto &p : points)
        {
            const double residual = p[2] - z - a * p[0] - b * p[1];
            squares += residual * residual;
        }
        squares /= static_cast<double>(points.size());
        ASSERT_EQ(cell.is_known, 1U) << row << " " << col;
        ASSERT_NEAR(cell.plane_z_site_m, z, 1e-4);
        ASSERT_NEAR(cell.plane_dz_dx, a, 1e-5);
        ASSERT_NEAR(cell.plane_dz_dy, b, 1e-5);
        ASSERT_NEAR(cell.roughness_m2, squares, 1e-7 + 1e-6 * squares);
        ASSERT_NEAR(cell.tilt_rad, std::atan(std::hypot(a, b)), 1e-5);
        const double cost = 1.0 / params.speed_max_m_per_s +
                            params.cost_tilt_s_per_m_rad * std::atan(std::hypot(a, b)) +
                            params.cost_roughness_s_per_m3 * squares;
        ASSERT_NEAR(cell.cost_s_per_m, cost, 1e-3 + 1e-6 * cost);
    }

    nav_params_t params = {};
    nav_kioz_t kioz = {};
    std::unique_ptr<nav_costmap_t> map = std::make_unique<nav_costmap_t>();
    std::unique_ptr<nav_surface_t> surface = std::make_unique<nav_surface_t>();
    std::unique_ptr<nav_surface_state_t> changes = std::make_unique<nav_surface_state_t>();
    std::unique_ptr<nav_costmap_state_t> state = std::make_unique<nav_costmap_state_t>();
};

} // namespace

TEST_F(NavCostmap, StartsUnknownAtTheFiniteCostOfUnknownGround)
{
    EXPECT_DOUBLE_EQ(map->cell_m, kCell);
    EXPECT_EQ(map->cycle, 0U);
    EXPECT_EQ(known_count(), 0);
    for (const nav_cost_cell_t &cell : map->cells)
    {
        ASSERT_FLOAT_EQ(cell.cost_s_per_m, static_cast<float>(1.5 / 0.042));
        ASSERT_EQ(nav_costmap_reason(&cell, true, true), NAV_REASON_NONE);
    }
}

TEST_F(NavCostmap, FindsTheCellOfAPositionAndNoneOutside)
{
    uint32_t index = 99U;
    EXPECT_TRUE(nav_costmap_find(map.get(), 0.0, 0.0, &index));
    EXPECT_EQ(index, static_cast<uint32_t>(kSize / 2 * kSize + kSize / 2));
    EXPECT_TRUE(nav_costmap_find(map.get(), -25.0, -25.0, &index));
    EXPECT_EQ(index, 0U);
    EXPECT_TRUE(nav_costmap_find(map.get(), 24.999, -24.6, &index));
    EXPECT_EQ(index, static_cast<uint32_t>((kSize - 1) * kSize));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double outside[][2] = {{25, 0},     {-25.001, 0}, {0, 25},  {0, -25.001}, {1e300, 0},
                                 {0, -1e300}, {nan, 0},     {0, nan}, {5e8, -5e8}};
    for (const auto &p : outside)
    {
        index = 99U;
        EXPECT_FALSE(nav_costmap_find(map.get(), p[0], p[1], &index));
        EXPECT_EQ(index, 0U);
    }
}

TEST_F(NavCostmap, IsRecentredOnlyNearItsEdge)
{
    const double reach = 25.0 - params.costmap_recenter_margin_m;
    for (double away : {0.0, reach, -reach})
    {
        EXPECT_FALSE(nav_costmap_recenter(map.get(), &params, away, 0.0));
        EXPECT_FALSE(nav_costmap_recenter(map.get(), &params, 0.0, away));
    }
    for (double away : {reach + 0.001, -reach - 0.001, 30.0, -1000.0})
    {
        for (bool is_north : {true, false})
        {
            nav_costmap_init(map.get(), &params);
            ASSERT_TRUE(nav_costmap_recenter(map.get(), &params, 0.0, 0.0));
            EXPECT_TRUE(nav_costmap_recenter(map.get(), &params, is_north ? away : 0.0,
                                             is_north ? 0.0 : away));
            EXPECT_FALSE(nav_costmap_recenter(map.get(), &params, is_north ? away : 0.0,
                                              is_north ? 0.0 : away));
        }
    }
}

TEST_F(NavCostmap, APositionWithoutAnIndexDoesNotRecentre)
{
    EXPECT_FALSE(nav_costmap_recenter(map.get(), &params, 1e300, 0.0));
    EXPECT_FALSE(
        nav_costmap_recenter(map.get(), &params, 0.0, std::numeric_limits<double>::quiet_NaN()));
    EXPECT_EQ(map->origin_row, -kSize / 2);
}

TEST_F(NavCostmap, RecentringKeepsTheContentOfCellsThatStay)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> steps(-80.0, 80.0);
    double x = 0.0;
    double y = 0.0;
    for (int step = 0; step < 60; step++)
    {
        const int old_row = map->origin_row;
        const int old_col = map->origin_col;
        for (int i = 0; i < NAV_COSTMAP_CELLS; i++)
        {
            map->cells[i].plane_dz_dx = static_cast<float>(old_row + i / kSize);
            map->cells[i].plane_dz_dy = static_cast<float>(old_col + i % kSize);
            map->cells[i].is_known = 1U;
        }
        x += (step % 3 == 0) ? 0.0 : steps(random) * 0.5;
        y += (step % 4 == 0) ? 0.0 : steps(random);
        nav_costmap_recenter(map.get(), &params, x, y);
        for (int row = map->origin_row; row < map->origin_row + kSize; row++)
        {
            for (int col = map->origin_col; col < map->origin_col + kSize; col++)
            {
                const bool stays = row >= old_row && row < old_row + kSize && col >= old_col &&
                                   col < old_col + kSize;
                const nav_cost_cell_t &cell = by_global(row, col);
                ASSERT_EQ(cell.is_known, stays ? 1U : 0U);
                ASSERT_EQ(cell.plane_dz_dx, stays ? static_cast<float>(row) : 0.0F);
                ASSERT_EQ(cell.plane_dz_dy, stays ? static_cast<float>(col) : 0.0F);
                ASSERT_GT(cell.cost_s_per_m, -1.0F);
            }
        }
    }
}

TEST_F(NavCostmap, RecentringAcrossTheWorldIsSafe)
{
    EXPECT_TRUE(nav_costmap_recenter(map.get(), &params, 5.3e8, 5.3e8));
    EXPECT_TRUE(nav_costmap_recenter(map.get(), &params, -5.3e8, -5.3e8));
    EXPECT_EQ(known_count(), 0);
}

TEST_F(NavCostmap, FlatGroundCostsTheTimeToCrossIt)
{
    shape([](double, double) { return -7.25; });
    update();
    const nav_cost_cell_t &cell = at(1.0, 1.0);
    EXPECT_EQ(cell.is_known, 1U);
    EXPECT_EQ(cell.plane_z_site_m, -7.25F);
    EXPECT_EQ(cell.tilt_rad, 0.0F);
    EXPECT_EQ(cell.roughness_m2, 0.0F);
    EXPECT_FLOAT_EQ(cell.cost_s_per_m, static_cast<float>(1.0 / 0.042));
    EXPECT_EQ(map->cycle, 1U);
}

TEST_F(NavCostmap, ExactlyTheCellsWhollyOnTheSurfaceAreJudged)
{
    const int covered = kSurface / kBlock;
    shape([](double, double) { return 0.0; });
    update();
    EXPECT_EQ(known_count(), covered * covered);
    for (int shift = 1; shift < kBlock; shift++)
    {
        nav_costmap_init(map.get(), &params);
        ASSERT_TRUE(nav_costmap_recenter(map.get(), &params, 0.0, 0.0));
        surface->origin_row = -kSurface / 2 + shift;
        surface->origin_col = -kSurface / 2 - 2 * shift;
        update();
        EXPECT_EQ(known_count(), (covered - 1) * (covered - 1));
    }
}

TEST_F(NavCostmap, SurfaceBeyondTheMapIsLeftOut)
{
    for (int north : {-1, 0, 1})
    {
        for (int east : {-1, 0, 1})
        {
            nav_costmap_init(map.get(), &params);
            ASSERT_TRUE(nav_costmap_recenter(map.get(), &params, 0.0, 0.0));
            surface->origin_row = -kSurface / 2 + 200 * north; // 10 of its 30 m lie off the map
            surface->origin_col = -kSurface / 2 + 200 * east;
            shape([](double, double) { return 1.0; });
            update();
            EXPECT_EQ(known_count(), (north == 0 ? 60 : 40) * (east == 0 ? 60 : 40));
        }
    }
}

TEST_F(NavCostmap, CellsOffTheSurfaceKeepWhatWasKnown)
{
    shape([](double x, double) { return 0.1 * x; });
    update();
    const std::vector<nav_cost_cell_t> before(std::begin(map->cells), std::end(map->cells));
    const int known = known_count();
    surface->origin_row += 100; // 10 m north
    shape([](double, double) { return 3.0; });
    update();
    EXPECT_EQ(known_count(), known + 20 * kSurface / kBlock);
    const nav_cost_cell_t &kept = at(-10.0, 0.0);
    EXPECT_EQ(std::memcmp(&kept, &before[static_cast<size_t>(&kept - map->cells)], sizeof(kept)),
              0);
    EXPECT_EQ(at(5.0, 0.0).plane_z_site_m, 3.0F);
}

TEST_F(NavCostmap, GroundThatBecameUnknownIsForgotten)
{
    shape([](double x, double) { return x; });
    update();
    EXPECT_EQ(at(1.0, 1.0).terrain_reason, NAV_REASON_TILT);
    shape([](double, double) { return 1.0e9; });
    update();
    const nav_cost_cell_t &cell = at(1.0, 1.0);
    EXPECT_EQ(cell.is_known, 0U);
    EXPECT_EQ(cell.terrain_reason, NAV_REASON_NONE);
    EXPECT_EQ(cell.plane_dz_dx, 0.0F);
    EXPECT_EQ(cell.tilt_rad, 0.0F);
    EXPECT_FLOAT_EQ(cell.cost_s_per_m, static_cast<float>(1.5 / 0.042));
}

TEST_F(NavCostmap, PlanesAgreeWithLeastSquaresOnRoughGroundWithGaps)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (double patch : {3.0, 5.0, 7.0})
    {
        params.costmap_patch_cells = patch;
        for (double offset_m : {0.0, -2000.0})
        {
            surface->origin_row = -kSurface / 2 + static_cast<int>(10 * unit(random));
            surface->origin_col = -kSurface / 2 + static_cast<int>(10 * unit(random));
            shape(
                [&](double x, double y)
                {
                    const bool is_gap =
                        std::sin(0.7 * x) + std::sin(0.9 * y) + 0.5 * unit(random) > 0.6;
                    return is_gap ? 1.0e9
                                  : offset_m + 0.2 * x - 0.1 * y + 0.3 * std::sin(x) +
                                        0.05 * unit(random);
                });
            update();
            for (int row = -29; row < 28; row++)
            {
                for (int col = -29; col < 28; col++)
                {
                    if (row * kBlock >= surface->origin_row &&
                        col * kBlock >= surface->origin_col &&
                        (row + 1) * kBlock <= surface->origin_row + kSurface &&
                        (col + 1) * kBlock <= surface->origin_col + kSurface)
                    {
                        ASSERT_NO_FATAL_FAILURE(expect_fit(row, col));
                    }
                }
            }
        }
    }
}

TEST_F(NavCostmap, TiltAboveTheLimitIsInfinite)
{
    const double limit = std::tan(params.tilt_max_rad);
    shape([&](double x, double y) { return x * limit * 0.9999 + 0.0 * y; });
    update();
    EXPECT_EQ(at(0, 0).terrain_reason, NAV_REASON_NONE);
    shape([&](double x, double y) { return -y * limit * 1.0001 + 0.0 * x; });
    update();
    EXPECT_EQ(at(0, 0).terrain_reason, NAV_REASON_TILT);
    EXPECT_EQ(at(0, 0).is_known, 1U);
    EXPECT_NEAR(at(0, 0).plane_dz_dy, -limit * 1.0001, 1e-6);
    EXPECT_EQ(nav_costmap_reason(&at(0, 0), true, false), NAV_REASON_TILT);
    EXPECT_EQ(nav_costmap_reason(&at(0, 0), false, true), NAV_REASON_NONE);
}

TEST_F(NavCostmap, APatchIsKnownFromItsLeastShareOn)
{
    params.costmap_patch_known_min = 0.3; // of 625 cells: 187.5
    for (int known : {187, 188})
    {
        shape([](double, double) { return 1.0e9; });
        int left = known;
        for (int row = -10; row < 15; row++)
        {
            for (int col = -10; (col < 15) && (left > 0); col++)
            {
                surface->z_site_m[(row + kSurface / 2) * kSurface + col + kSurface / 2] = 2.0F;
                left--;
            }
        }
        update();
        EXPECT_EQ(at(0.25, 0.25).is_known, (known == 188) ? 1U : 0U);
    }
}

TEST_F(NavCostmap, GroundKnownAlongOneLineOnlyIsUnexpected)
{
    params.costmap_patch_known_min = 0.05;
    params.costmap_patch_cells = 3.0; // 15 x 15 cells
    for (int kind = 0; kind < 3; kind++)
    {
        shape([](double, double) { return 1.0e9; });
        for (int i = 0; i < 15; i++)
        {
            const int row = (kind == 1) ? 0 : i - 5;
            const int col = (kind == 0) ? 0 : i - 5;
            surface->z_site_m[(row + kSurface / 2) * kSurface + col + kSurface / 2] =
                0.1F * static_cast<float>(i % 3);
        }
        update();
        const nav_cost_cell_t &cell = at(0.25, 0.25);
        EXPECT_EQ(cell.is_known, 0U);
        EXPECT_EQ(cell.terrain_reason, NAV_REASON_UNEXPECTED) << kind;
        EXPECT_EQ(nav_costmap_reason(&cell, true, true), NAV_REASON_UNEXPECTED);
    }
}

TEST_F(NavCostmap, HeightsThatAreNoGroundDoNotCount)
{
    for (float bad : {1.0e9F, -1.0e9F, 3.0e38F, -3.0e38F, std::numeric_limits<float>::infinity(),
                      std::numeric_limits<float>::quiet_NaN()})
    {
        shape([](double, double) { return 2.0; });
        for (int cell = 0; cell < NAV_HEIGHTMAP_CELLS; cell += 3)
        {
            surface->z_site_m[cell] = bad;
        }
        update();
        EXPECT_EQ(at(0, 0).is_known, 1U);
        EXPECT_EQ(at(0, 0).plane_z_site_m, 2.0F);
    }
}

TEST_F(NavCostmap, AnAbsurdCliffStaysFinite)
{
    shape([](double x, double) { return (x > 0.0) ? 9.9e8 : -9.9e8; });
    update();
    EXPECT_EQ(at(0, 0).terrain_reason, NAV_REASON_TILT);
    EXPECT_TRUE(std::isfinite(at(0, 0).cost_s_per_m));
    EXPECT_TRUE(std::isfinite(at(0, 0).roughness_m2));
}

TEST_F(NavCostmap, ZonesForbidCellsByTheirCentre)
{
    nav_zone_t zone = {};
    zone.shape = NAV_ZONE_CIRCLE;
    zone.center_x_site_m = 20.0; // off the surface too
    zone.radius_m = 2.0;
    nav_kioz_set(&kioz, &zone, 1U);
    update(0.5);
    for (int row = -kSize / 2; row < kSize / 2; row++)
    {
        for (int col = -kSize / 2; col < kSize / 2; col++)
        {
            const double distance = std::hypot((row + 0.5) * kCell - 20.0, (col + 0.5) * kCell);
            ASSERT_EQ(by_global(row, col).is_forbidden, (distance <= 2.5) ? 1U : 0U);
        }
    }
    EXPECT_EQ(nav_costmap_reason(&at(20, 0), true, true), NAV_REASON_KIOZ);
    EXPECT_EQ(nav_costmap_reason(&at(20, 0), true, false), NAV_REASON_NONE);
    nav_kioz_set(&kioz, &zone, 0U);
    update(0.5);
    EXPECT_EQ(at(20, 0).is_forbidden, 0U);
}

TEST_F(NavCostmap, ZonesComeBeforeTerrainAndTerrainBeforeAce)
{
    nav_cost_cell_t cell = {};
    cell.is_forbidden = 1U;
    cell.terrain_reason = NAV_REASON_TILT;
    cell.ace_reason = NAV_REASON_CLEARANCE;
    cell.ace_failed_headings = 0xFU;
    EXPECT_EQ(nav_costmap_reason(&cell, true, true), NAV_REASON_KIOZ);
    EXPECT_EQ(nav_costmap_reason(&cell, true, false), NAV_REASON_TILT);
    EXPECT_EQ(nav_costmap_reason(&cell, false, false), NAV_REASON_NONE);
    cell.terrain_reason = NAV_REASON_NONE;
    EXPECT_EQ(nav_costmap_reason(&cell, true, false), NAV_REASON_CLEARANCE);
    EXPECT_EQ(nav_costmap_reason(&cell, false, false), NAV_REASON_NONE);
}

TEST_F(NavCostmap, AYawIsTheNearestOfFourHeadingsForwardsOrBackwards)
{
    const double eighth = NAV_PI / 8.0;
    for (int turn = -9; turn <= 9; turn++)
    {
        const uint32_t heading = static_cast<uint32_t>(((turn % 4) + 4) % 4);
        const double yaw_rad = 2.0 * eighth * turn;
        EXPECT_EQ(heading, nav_costmap_heading(yaw_rad)) << turn;
        EXPECT_EQ(heading, nav_costmap_heading(yaw_rad + 0.99 * eighth)) << turn;
        EXPECT_EQ(heading, nav_costmap_heading(yaw_rad - 0.99 * eighth)) << turn;
    }
}

TEST_F(NavCostmap, ACellIsClosedWhenAceFailedAlongEveryHeadingAndOnePassOpensIt)
{
    for (int heading = 0; heading < NAV_HEADINGS; heading++)
    {
        EXPECT_EQ(nav_costmap_reason(&at(3, 3), true, true), NAV_REASON_NONE) << heading;
        feed_back(heading, NAV_REASON_CLEARANCE);
        feed_back(heading, NAV_REASON_WHEEL_DROP);
    }
    EXPECT_EQ(nav_costmap_reason(&at(3, 3), true, true), NAV_REASON_WHEEL_DROP);
    EXPECT_EQ(nav_costmap_reason(&at(3, 3), false, true), NAV_REASON_NONE);
    feed_back(2, NAV_REASON_NONE);
    EXPECT_EQ(at(3, 3).ace_failed_headings, 0b1011U);
    EXPECT_EQ(nav_costmap_reason(&at(3, 3), true, true), NAV_REASON_NONE);
}

TEST_F(NavCostmap, AFailureBackwardsIsOneAlongTheSameHeading)
{
    const nav_pose2_t back = {3.0, 3.0, -NAV_PI + 0.25 * NAV_PI};
    nav_costmap_feedback(map.get(), &back, NAV_REASON_CLEARANCE);
    EXPECT_EQ(at(3, 3).ace_failed_headings, 0b0010U);
    feed_back(1, NAV_REASON_NONE);
    EXPECT_EQ(at(3, 3).ace_failed_headings, 0U);
}

TEST_F(NavCostmap, AHeadingIsBarredByObstaclesOrByAFailureOfAce)
{
    nav_cost_cell_t cell = {};
    EXPECT_EQ(nav_costmap_barred(&cell), 0U);
    cell.barred_headings = 0b0011U;
    cell.ace_failed_headings = 0b1010U;
    EXPECT_EQ(nav_costmap_barred(&cell), 0b1011U);
}

TEST_F(NavCostmap, BarredHeadingsAloneCloseNoCell)
{
    nav_cost_cell_t cell = {};
    cell.barred_headings = 0xFU;
    cell.ace_failed_headings = 0b0111U;
    EXPECT_EQ(nav_costmap_reason(&cell, true, true), NAV_REASON_NONE);
}

TEST_F(NavCostmap, FeedbackOutsideTheMapIsDropped)
{
    const nav_pose2_t outside = {100.0, 3.0, 0.0};
    nav_costmap_feedback(map.get(), &outside, NAV_REASON_CLEARANCE);
    for (const nav_cost_cell_t &cell : map->cells)
    {
        ASSERT_EQ(cell.ace_failed_headings, 0U);
    }
}

TEST_F(NavCostmap, AceIsForgottenAfterItsCyclesWithoutAFailure)
{
    params.ace_feedback_cycles = 2.0;
    update();
    for (int heading = 0; heading < NAV_HEADINGS; heading++)
    {
        feed_back(heading, NAV_REASON_BOGIE);
    }
    update();
    update();
    EXPECT_EQ(nav_costmap_reason(&at(3, 3), true, true), NAV_REASON_BOGIE);
    update();
    EXPECT_EQ(at(3, 3).ace_failed_headings, 0U);
    EXPECT_EQ(at(3, 3).ace_reason, NAV_REASON_NONE);
    params.ace_feedback_cycles = 0.0;
    feed_back(0, NAV_REASON_BOGIE);
    update();
    EXPECT_EQ(at(3, 3).ace_failed_headings, 0U);
}

TEST_F(NavCostmap, TheCycleMayWrapAround)
{
    map->cycle = UINT32_MAX;
    feed_back(0, NAV_REASON_BOGIE);
    update();
    EXPECT_EQ(map->cycle, 0U);
    EXPECT_EQ(at(3, 3).ace_failed_headings, 1U);
}

TEST_F(NavCostmap, ClearingFeedbackOpensEveryCellAndLeavesObstacles)
{
    const nav_pose2_t corner = {-24.0, 24.0, 0.0};
    feed_back(0, NAV_REASON_BOGIE);
    nav_costmap_feedback(map.get(), &corner, NAV_REASON_ROCKER);
    at(3, 3).barred_headings = 0b0100U;
    nav_costmap_clear_feedback(map.get());
    EXPECT_EQ(nav_costmap_barred(&at(3, 3)), 0b0100U);
    EXPECT_EQ(at(-24, 24).ace_failed_headings, 0U);
    EXPECT_EQ(at(-24, 24).ace_reason, NAV_REASON_NONE);
}

TEST_F(NavCostmap, UpdatingWhatChangedIsTheSameToTheLastBitAsUpdatingAll)
{
    auto heightmap = std::make_unique<nav_heightmap_t>();
    nav_heightmap_init(heightmap.get(), &params);
    std::mt19937_64 random(12);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    for (double patch : {3.0, 5.0, 7.0})
    {
        params.costmap_patch_cells = patch;
        *state = {};
        double x = 0.0;
        double y = 0.0;
        for (uint32_t step = 0; step < 40U; step++)
        {
            x += 0.8 * static_cast<double>(unit(random)) + ((step % 10U == 9U) ? 13.0 : 0.3);
            y += 0.8 * static_cast<double>(unit(random));
            const float z = (step < 20U) ? 0.0F : 200.0F; // with another reference
            std::vector<nav_point_t> points(5000U);
            for (nav_point_t &p : points)
            {
                p = {4.0F * unit(random) + 4.0F, 5.0F * unit(random), z + unit(random)};
            }
            const nav_pose_t pose = {x, y, 0.0, 0.0, 0.0, 3.0 * static_cast<double>(unit(random))};
            ASSERT_TRUE(nav_heightmap_center(heightmap.get(), x, y));
            nav_heightmap_merge(heightmap.get(), &pose, step, step + 1U, points.data(), 5000U);
            nav_heightmap_surface(heightmap.get(), &params, step, changes.get(), surface.get());
            nav_costmap_recenter(map.get(), &params, x, y);
            ASSERT_NO_FATAL_FAILURE(expect_cells_of_all()) << step;
        }
        EXPECT_GT(known_count(), 300);
        heightmap->is_placed = 0U;
        *changes = {};
    }
}

TEST_F(NavCostmap, WithNothingNewNoCellIsComputedAgain)
{
    shape([](double, double) { return 1.0; });
    update();
    at(2.0, 3.0).tilt_rad = 7.0F; // what only computing could replace
    update_changed();
    EXPECT_EQ(at(2.0, 3.0).tilt_rad, 7.0F);
    update();
    EXPECT_EQ(at(2.0, 3.0).tilt_rad, 0.0F);
}

TEST_F(NavCostmap, AChangeReachesAsFarAsItsPatches)
{
    shape([](double, double) { return 1.0; });
    update();
    for (nav_cost_cell_t &cell : map->cells)
    {
        cell.tilt_rad = 7.0F;
    }
    changes->surface_count += 1U;
    changes->changed_at[block_in_tables(3, 3)] = changes->surface_count; // cell 0, 0
    update_changed();
    const int half = static_cast<int>(params.costmap_patch_cells) / 2;
    for (int row = -10; row <= 10; row++)
    {
        for (int col = -10; col <= 10; col++)
        {
            const bool is_reached = std::max(std::abs(row), std::abs(col)) <= half;
            ASSERT_EQ(by_global(row, col).tilt_rad, is_reached ? 0.0F : 7.0F) << row << " " << col;
        }
    }
}
