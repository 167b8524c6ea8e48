// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
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
#include "nav_heightmap.h"
#include "nav_math.h"
}

namespace
{

constexpr int kSize = NAV_HEIGHTMAP_SIZE;
const nav_pose_t kOrigin = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};

class NavHeightmap : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        nav_params_default(&params);
        nav_heightmap_init(map.get(), &params);
        ASSERT_TRUE(nav_heightmap_center(map.get(), 0.0, 0.0));
    }

    nav_merge_t merge(const std::vector<nav_point_t> &points,
                      uint32_t image_id = 1U,
                      double time_s = 0.0,
                      const nav_pose_t &pose = kOrigin)
    {
        return nav_heightmap_merge(map.get(), &pose, time_s, image_id, points.data(),
                                   static_cast<uint32_t>(points.size()));
    }

    // by global index
    nav_height_cell_t &cell(int32_t row, int32_t col)
    {
        return map->cells[nav_wrap_index(row, kSize) * kSize + nav_wrap_index(col, kSize)];
    }

    void set(int32_t row, int32_t col, double z_m, double time_s = 0.0)
    {
        cell(row, col) = {z_m, time_s, 1U, 1U};
    }

    // all blocks: cells are set by hand
    void make_surface(double time_s = 0.0)
    {
        std::fill(std::begin(map->is_changed), std::end(map->is_changed), uint8_t{1});
        nav_heightmap_surface(map.get(), &params, time_s, state.get(), surface.get());
    }

    // as a new state would make it, from a copy of the map
    std::vector<float> made_anew(double time_s) const
    {
        auto copy = std::make_unique<nav_heightmap_t>(*map);
        auto fresh_state = std::make_unique<nav_surface_state_t>();
        auto fresh = std::make_unique<nav_surface_t>();
        nav_heightmap_surface(copy.get(), &params, time_s, fresh_state.get(), fresh.get());
        return {std::begin(fresh->z_site_m), std::end(fresh->z_site_m)};
    }

    void expect_surface_of_all(double time_s)
    {
        const std::vector<float> expected = made_anew(time_s);
        nav_heightmap_surface(map.get(), &params, time_s, state.get(), surface.get());
        ASSERT_EQ(0, std::memcmp(expected.data(), surface->z_site_m, sizeof(surface->z_site_m)));
    }

    bool is_stamped(int32_t row, int32_t col) const
    {
        return state->changed_at[block_in_tables(row, col)] == state->surface_count;
    }

    int stamped_count() const
    {
        return static_cast<int>(std::count(std::begin(state->changed_at),
                                           std::end(state->changed_at), state->surface_count));
    }

    // by global index
    float height(int32_t row, int32_t col) const
    {
        return surface->z_site_m[(row - surface->origin_row) * kSize + col - surface->origin_col];
    }

    int known_count() const
    {
        return static_cast<int>(std::count_if(surface->z_site_m,
                                              surface->z_site_m + NAV_HEIGHTMAP_CELLS,
                                              [](float z) { return z < NAV_SURFACE_UNKNOWN_M; }));
    }

    nav_params_t params = {};
    std::unique_ptr<nav_heightmap_t> map = std::make_unique<nav_heightmap_t>();
    std::unique_ptr<nav_surface_state_t> state = std::make_unique<nav_surface_state_t>();
    std::unique_ptr<nav_surface_t> surface = std::make_unique<nav_surface_t>();
};

} // namespace

TEST_F(NavHeightmap, StartsEmptyWithTheCellOfTheParameters)
{
    params.heightmap_cell_m = 0.2;
    nav_heightmap_init(map.get(), &params);
    EXPECT_EQ(map->cell_m, 0.2);
    EXPECT_EQ(map->is_placed, 0U);
    ASSERT_TRUE(nav_heightmap_center(map.get(), 1.0, 1.0));
    make_surface();
    EXPECT_EQ(known_count(), 0);
    EXPECT_EQ(surface->cell_m, 0.2);
}

TEST_F(NavHeightmap, ThePositionLiesInTheMiddleCell)
{
    ASSERT_TRUE(nav_heightmap_center(map.get(), 12.34, -0.05));
    EXPECT_EQ(map->origin_row, 123 - kSize / 2);
    EXPECT_EQ(map->origin_col, -1 - kSize / 2);
    EXPECT_EQ(map->is_placed, 1U);
}

TEST_F(NavHeightmap, APositionWithoutAnIndexChangesNothing)
{
    set(0, 0, 1.0);
    for (double bad : {1e300, -1e300, std::numeric_limits<double>::quiet_NaN(), 1.08e8})
    {
        EXPECT_FALSE(nav_heightmap_center(map.get(), bad, 0.0));
        EXPECT_FALSE(nav_heightmap_center(map.get(), 0.0, bad));
    }
    EXPECT_EQ(map->origin_row, -kSize / 2);
    EXPECT_EQ(map->origin_col, -kSize / 2);
    EXPECT_EQ(cell(0, 0).point_count, 1U);
}

TEST_F(NavHeightmap, PointsOfOneImageAreAveraged)
{
    const nav_merge_t merged =
        merge({{1.01F, 2.01F, 1.0F}, {1.05F, 2.09F, 2.0F}, {1.09F, 2.05F, 6.0F}}, 5U, 7.0);
    EXPECT_EQ(merged.merged_count, 3U);
    EXPECT_EQ(merged.outside_count, 0U);
    EXPECT_EQ(cell(10, 20).point_count, 3U);
    EXPECT_EQ(cell(10, 20).image_id, 5U);
    EXPECT_EQ(cell(10, 20).time_s, 7.0F);
    make_surface(8.0);
    EXPECT_EQ(height(10, 20), 3.0F);
    EXPECT_EQ(known_count(), 1);
    EXPECT_EQ(surface->time_s, 8.0);
}

TEST_F(NavHeightmap, ChunksOfOneImageAccumulate)
{
    merge({{0.05F, 0.05F, 1.0F}}, 5U);
    merge({{0.05F, 0.05F, 2.0F}}, 5U);
    EXPECT_EQ(cell(0, 0).point_count, 2U);
    EXPECT_EQ(cell(0, 0).z_sum_m, 3.0);
}

TEST_F(NavHeightmap, ANewerImageOverwritesItsCellsOnly)
{
    merge({{0.05F, 0.05F, 1.0F}, {0.15F, 0.05F, 1.0F}}, 5U, 1.0);
    merge({{0.05F, 0.05F, 9.0F}}, 6U, 2.0);
    EXPECT_EQ(cell(0, 0).point_count, 1U);
    EXPECT_EQ(cell(0, 0).z_sum_m, 9.0);
    EXPECT_EQ(cell(0, 0).time_s, 2.0F);
    EXPECT_EQ(cell(1, 0).z_sum_m, 1.0);
    EXPECT_EQ(cell(1, 0).image_id, 5U);
}

TEST_F(NavHeightmap, AnImageNumberedZeroIsMergedToo)
{
    merge({{0.05F, 0.05F, 4.0F}}, 0U);
    EXPECT_EQ(cell(0, 0).point_count, 1U);
    EXPECT_EQ(cell(0, 0).z_sum_m, 4.0);
}

TEST_F(NavHeightmap, TheCountOfAFullCellStaysAndLaterPointsAreLeftOut)
{
    const std::vector<nav_point_t> chunk(NAV_CHUNK_POINTS_MAX, {0.05F, 0.05F, 1.0F});
    uint32_t merged_count = 0U;
    for (int i = 0; i < 9; i++)
    {
        merged_count += merge(chunk).merged_count;
    }
    EXPECT_EQ(merged_count, 65535U);
    EXPECT_EQ(cell(0, 0).point_count, 65535U);
    const nav_merge_t late = merge({{0.05F, 0.05F, 99.0F}});
    EXPECT_EQ(late.merged_count, 0U);
    EXPECT_EQ(late.outside_count, 0U);
    make_surface();
    EXPECT_EQ(height(0, 0), 1.0F);
}

TEST_F(NavHeightmap, NoMorePointsAreReadThanAChunkHolds)
{
    const std::vector<nav_point_t> points(NAV_CHUNK_POINTS_MAX + 1, {0.05F, 0.05F, 1.0F});
    EXPECT_EQ(merge(points).merged_count, static_cast<uint32_t>(NAV_CHUNK_POINTS_MAX));
    EXPECT_EQ(merge({}).merged_count, 0U);
}

TEST_F(NavHeightmap, EveryEdgeOfTheMapIsInsideOnlyToTheSouthAndWest)
{
    params.heightmap_cell_m = 0.125; // exact in binary
    nav_heightmap_init(map.get(), &params);
    ASSERT_TRUE(nav_heightmap_center(map.get(), 0.0, 0.0));
    const float half = 0.125F * kSize / 2;
    const float below = std::nextafterf(half, 0.0F);
    EXPECT_EQ(merge({{-half, 0, 0}, {0, -half, 0}, {below, 0, 0}, {0, below, 0}}).merged_count, 4U);
    EXPECT_EQ(merge({{half, 0, 0}, {0, half, 0}}).outside_count, 2U);
    EXPECT_EQ(merge({{-std::nextafterf(half, 100), 0, 0}, {0, -std::nextafterf(half, 100), 0}})
                  .outside_count,
              2U);
    EXPECT_EQ(merge({{3e38F, 0, 0}, {0, -3e38F, 0}, {1e9F, 1e9F, 3e38F}}).outside_count, 3U);
}

TEST_F(NavHeightmap, ABoundaryBelongsToTheCellNorthOrEastOfIt)
{
    params.heightmap_cell_m = 0.125;
    nav_heightmap_init(map.get(), &params);
    ASSERT_TRUE(nav_heightmap_center(map.get(), 0.0, 0.0));
    for (int32_t row = -kSize / 2; row < kSize / 2; row++)
    {
        const float x = 0.125F * static_cast<float>(row);
        merge({{x, 0.0F, 1.0F}}, 7U);
        ASSERT_EQ(cell(row, 0).point_count, 1U) << row;
        if (row > -kSize / 2)
        {
            // the last number south of it; at 0 there is none that a sum with half the map could hold
            const float south = std::min(std::nextafterf(x, -100.0F), x - 1e-12F);
            merge({{south, -0.01F, 1.0F}}, 8U);
            ASSERT_EQ(cell(row - 1, -1).image_id, 8U) << row;
        }
    }
}

TEST_F(NavHeightmap, PointsAreTurnedFromRoverToSite)
{
    const nav_pose_t poses[] = {{3.0, -2.0, 0.5, 0.0, 0.0, NAV_PI / 2},
                                {3.0, -2.0, 0.5, 0.0, NAV_PI / 6, 0.0},
                                {3.0, -2.0, 0.5, NAV_PI / 6, 0.0, 0.0}};
    // ahead is east; nose up lifts what is ahead; right side down lowers what is right
    const double x[] = {3.0 - 0.52, -1.0, 3.0 + 2.02};
    const double y[] = {-2.0 + 2.02, -2.0 + 0.52, 0.0};
    const double z[] = {0.5, 0.5 - 2.02 / 2, 0.5 + 0.52 / 2};
    for (uint32_t i = 0; i < 3U; i++)
    {
        const double east = (i == 2U) ? -2.0 + 0.52 * std::cos(NAV_PI / 6) : y[i];
        const double north = (i == 1U) ? 3.0 + 2.02 * std::cos(NAV_PI / 6) : x[i];
        ASSERT_EQ(merge({{2.02F, 0.52F, 0.0F}}, 10U + i, 0.0, poses[i]).merged_count, 1U);
        const nav_height_cell_t &hit = cell(static_cast<int32_t>(std::floor(north * 10)),
                                            static_cast<int32_t>(std::floor(east * 10)));
        EXPECT_EQ(hit.image_id, 10U + i);
        EXPECT_NEAR(hit.z_sum_m, z[i], 1e-6);
    }
}

TEST_F(NavHeightmap, TheRotationIsRzRyRx)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> angles(-0.5, 0.5);
    std::uniform_real_distribution<float> sides(-5.0F, 5.0F);
    for (uint32_t i = 0; i < 2000U; i++)
    {
        const nav_pose_t pose = {angles(random), angles(random), angles(random),
                                 angles(random), angles(random), 6.0 * angles(random)};
        const nav_point_t p = {sides(random), sides(random), sides(random)};
        double v[3] = {p.x_m, p.y_m, p.z_m};
        const double angle[3] = {pose.roll_rad, pose.pitch_rad, pose.yaw_rad};
        for (int axis = 0; axis < 3; axis++)
        {
            const int a = (axis + 1) % 3;
            const int b = (axis + 2) % 3;
            const double va = v[a] * std::cos(angle[axis]) - v[b] * std::sin(angle[axis]);
            v[b] = v[a] * std::sin(angle[axis]) + v[b] * std::cos(angle[axis]);
            v[a] = va;
        }
        ASSERT_EQ(merge({p}, 1000U + i, 0.0, pose).merged_count, 1U);
        const nav_height_cell_t &hit =
            cell(static_cast<int32_t>(std::floor((pose.x_site_m + v[0]) * 10)),
                 static_cast<int32_t>(std::floor((pose.y_site_m + v[1]) * 10)));
        ASSERT_EQ(hit.image_id, 1000U + i);
        ASSERT_NEAR(hit.z_sum_m, pose.z_site_m + v[2], 1e-12);
    }
}

TEST_F(NavHeightmap, MergingFarFromTheOriginOfSiteStaysExact)
{
    for (double far_m : {1.0e4, -1.0e4, 1.0e6, -1.0e6})
    {
        ASSERT_TRUE(nav_heightmap_center(map.get(), far_m, -far_m));
        const nav_pose_t pose = {far_m + 0.05, -far_m + 0.05, 2000.0, 0.0, 0.0, 0.0};
        ASSERT_EQ(merge({{1.0F, 2.0F, 0.25F}}, 3U, 0.0, pose).merged_count, 1U);
        const auto row = static_cast<int32_t>(std::floor((far_m + 1.05) * 10));
        const auto col = static_cast<int32_t>(std::floor((-far_m + 2.05) * 10));
        EXPECT_EQ(cell(row, col).z_sum_m, 2000.25);
    }
}

TEST_F(NavHeightmap, RollingKeepsWhatStaysAndForgetsWhatLeaves)
{
    std::mt19937_64 random(2);
    std::uniform_int_distribution<int32_t> steps(-40, 40);
    int32_t row = 0;
    int32_t col = 0;
    for (int step = 0; step < 60; step++)
    {
        for (int32_t r = 0; r < kSize; r++)
        {
            for (int32_t c = 0; c < kSize; c++)
            {
                const int32_t gr = map->origin_row + r;
                const int32_t gc = map->origin_col + c;
                set(gr, gc, gr * 1000.0 + gc);
            }
        }
        const int32_t old_row = map->origin_row;
        const int32_t old_col = map->origin_col;
        row += (step % 10 == 9) ? 350 : steps(random);
        col += (step % 10 == 8) ? -299 : steps(random);
        ASSERT_TRUE(nav_heightmap_center(map.get(), (row + 0.5) * 0.1, (col + 0.5) * 0.1));
        for (int32_t r = 0; r < kSize; r++)
        {
            for (int32_t c = 0; c < kSize; c++)
            {
                const int32_t gr = map->origin_row + r;
                const int32_t gc = map->origin_col + c;
                const bool stays =
                    gr >= old_row && gr < old_row + kSize && gc >= old_col && gc < old_col + kSize;
                ASSERT_EQ(cell(gr, gc).point_count, stays ? 1U : 0U);
                ASSERT_EQ(cell(gr, gc).z_sum_m, stays ? gr * 1000.0 + gc : 0.0);
            }
        }
    }
}

TEST_F(NavHeightmap, RollingBackAndForthDoesNotDrift)
{
    set(0, 0, 5.0);
    for (int i = 0; i < 1000; i++)
    {
        ASSERT_TRUE(nav_heightmap_center(map.get(), 0.05, 0.05));
        ASSERT_TRUE(nav_heightmap_center(map.get(), -7.05, 7.05));
    }
    ASSERT_TRUE(nav_heightmap_center(map.get(), 0.0, 0.0));
    EXPECT_EQ(map->origin_row, -kSize / 2);
    EXPECT_EQ(cell(0, 0).z_sum_m, 5.0);
}

TEST_F(NavHeightmap, RollingAcrossTheWholeWorldForgetsEverything)
{
    set(0, 0, 5.0);
    ASSERT_TRUE(nav_heightmap_center(map.get(), 1.07e8, 1.07e8));
    ASSERT_TRUE(nav_heightmap_center(map.get(), -1.07e8, -1.07e8));
    ASSERT_TRUE(nav_heightmap_center(map.get(), 0.0, 0.0));
    make_surface();
    EXPECT_EQ(known_count(), 0);
}

TEST_F(NavHeightmap, TheSurfaceIsUnwrappedAfterRolling)
{
    ASSERT_TRUE(nav_heightmap_center(map.get(), 123.45, -67.89));
    set(map->origin_row, map->origin_col, 1.0);
    set(map->origin_row + kSize - 1, map->origin_col, 2.0);
    set(map->origin_row, map->origin_col + kSize - 1, 3.0);
    set(map->origin_row + 100, map->origin_col + 200, 4.0);
    make_surface();
    EXPECT_EQ(surface->z_site_m[0], 1.0F);
    EXPECT_EQ(surface->z_site_m[(kSize - 1) * kSize], 2.0F);
    EXPECT_EQ(surface->z_site_m[kSize - 1], 3.0F);
    EXPECT_EQ(surface->z_site_m[100 * kSize + 200], 4.0F);
    EXPECT_EQ(known_count(), 4);
    EXPECT_EQ(surface->origin_row, map->origin_row);
    EXPECT_EQ(surface->origin_col, map->origin_col);
}

TEST_F(NavHeightmap, ACellOlderThanTheExpiryIsUnknown)
{
    set(0, 0, 1.0, 100.0);
    make_surface(100.0 + params.heightmap_expiry_s);
    EXPECT_EQ(height(0, 0), 1.0F);
    make_surface(100.5 + params.heightmap_expiry_s);
    EXPECT_EQ(height(0, 0), NAV_SURFACE_UNKNOWN_M);
    EXPECT_EQ(cell(0, 0).point_count, 1U);
    make_surface(50.0); // imaged after this time
    EXPECT_EQ(height(0, 0), 1.0F);
}

TEST_F(NavHeightmap, AHeightBeyondAnyGroundIsUnknown)
{
    set(0, 0, 1.0e9);
    set(2, 0, -1.0e9);
    set(4, 0, 1.0e300);
    set(6, 0, std::numeric_limits<double>::quiet_NaN());
    set(8, 0, 9.9e8);
    make_surface();
    EXPECT_EQ(known_count(), 1);
    EXPECT_EQ(height(8, 0), 9.9e8F);
}

TEST_F(NavHeightmap, AGapWithEnoughKnownNeighboursTakesTheirMean)
{
    set(0, 0, 1.0);
    set(0, 2, 2.0);
    make_surface();
    EXPECT_EQ(height(0, 1), NAV_SURFACE_UNKNOWN_M);
    set(1, 1, 6.0);
    make_surface();
    EXPECT_EQ(height(0, 1), 3.0F);
    EXPECT_EQ(height(0, 0), 1.0F);
    params.surface_fill_neighbors = 4.0;
    make_surface();
    EXPECT_EQ(height(0, 1), NAV_SURFACE_UNKNOWN_M);
    params.surface_fill_neighbors = 9.0;
    for (int32_t row = -1; row <= 1; row++)
    {
        for (int32_t col = 0; col <= 2; col++)
        {
            set(row, col, 1.0);
        }
    }
    cell(0, 1) = {};
    make_surface();
    EXPECT_EQ(known_count(), 8);
}

TEST_F(NavHeightmap, FillingAgreesWithTheDefinitionEverywhere)
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> heights(-1.0, 1.0);
    for (double neighbors : {1.0, 3.0, 4.5, 5.0, 8.0})
    {
        params.surface_fill_neighbors = neighbors;
        const double known_share = neighbors / 9.0;
        ASSERT_TRUE(nav_heightmap_center(map.get(), 10.0 * neighbors, 3.0));
        std::vector<float> original(NAV_HEIGHTMAP_CELLS, NAV_SURFACE_UNKNOWN_M);
        for (int32_t r = 0; r < kSize; r++)
        {
            for (int32_t c = 0; c < kSize; c++)
            {
                cell(map->origin_row + r, map->origin_col + c) = {};
                if (heights(random) < 2.0 * known_share - 1.0)
                {
                    const double z = heights(random);
                    set(map->origin_row + r, map->origin_col + c, z);
                    original[static_cast<size_t>(r * kSize + c)] = static_cast<float>(z);
                }
            }
        }
        make_surface();
        for (int32_t r = 0; r < kSize; r++)
        {
            for (int32_t c = 0; c < kSize; c++)
            {
                double sum = 0.0;
                int count = 0;
                for (int32_t i = std::max(r - 1, 0); i <= std::min(r + 1, kSize - 1); i++)
                {
                    for (int32_t j = std::max(c - 1, 0); j <= std::min(c + 1, kSize - 1); j++)
                    {
                        const float z = original[static_cast<size_t>(i * kSize + j)];
                        if ((i != r || j != c) && z < NAV_SURFACE_UNKNOWN_M)
                        {
                            sum += static_cast<double>(z);
                            count++;
                        }
                    }
                }
                const float z = original[static_cast<size_t>(r * kSize + c)];
                const float made = surface->z_site_m[r * kSize + c];
                if (z < NAV_SURFACE_UNKNOWN_M)
                {
                    ASSERT_EQ(made, z);
                }
                else if (count >= neighbors)
                {
                    ASSERT_NEAR(made, sum / count, 1e-6);
                }
                else
                {
                    ASSERT_EQ(made, NAV_SURFACE_UNKNOWN_M);
                }
            }
        }
    }
}

TEST_F(NavHeightmap, WithNothingNewNothingIsMadeAgain)
{
    merge({{1.0F, 1.0F, 0.5F}});
    expect_surface_of_all(1.0);
    EXPECT_EQ(stamped_count(), NAV_BLOCKS);
    expect_surface_of_all(2.0);
    EXPECT_EQ(stamped_count(), 0);
    EXPECT_EQ(height(10, 10), 0.5F);
}

TEST_F(NavHeightmap, APointChangesItsBlockAndThoseBesideIt)
{
    expect_surface_of_all(1.0);
    merge({{1.02F, 1.02F, 0.5F}});
    expect_surface_of_all(2.0);
    EXPECT_EQ(stamped_count(), 9);
    EXPECT_TRUE(is_stamped(10, 10));
    EXPECT_TRUE(is_stamped(9, 15));
    EXPECT_FALSE(is_stamped(4, 10));
}

TEST_F(NavHeightmap, ABlockWhoseOldestHeightExpiresIsMadeAgain)
{
    params.heightmap_expiry_s = 10.0;
    merge({{1.02F, 1.02F, 0.5F}}, 1U, 0.0);
    merge({{1.12F, 1.02F, 0.7F}, {5.02F, 5.02F, 0.7F}}, 2U, 5.0);
    expect_surface_of_all(6.0);
    expect_surface_of_all(10.0);
    EXPECT_EQ(stamped_count(), 0);
    expect_surface_of_all(10.5);
    EXPECT_EQ(stamped_count(), 9);
    EXPECT_EQ(height(10, 10), NAV_SURFACE_UNKNOWN_M);
    EXPECT_EQ(height(11, 10), 0.7F);
    expect_surface_of_all(15.5);
    EXPECT_EQ(known_count(), 0);
    expect_surface_of_all(6.0); // backwards: it is known again
    EXPECT_EQ(known_count(), 3);
}

TEST_F(NavHeightmap, MakingWhatChangedIsTheSameToTheLastBitAsMakingAll)
{
    std::mt19937_64 random(11);
    std::uniform_int_distribution<int> steps(-14, 14);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    params.heightmap_expiry_s = 40.0;
    double x = 0.0;
    double y = 0.0;
    for (uint32_t step = 0; step < 150U; step++)
    {
        for (uint32_t move = 0; move < random() % 3U; move++) // none, one, or one upon another
        {
            x += 0.1 * ((step % 40U == 39U) ? 350 : steps(random));
            y += 0.1 * ((step % 50U == 49U) ? -299 : steps(random));
            ASSERT_TRUE(nav_heightmap_center(map.get(), x, y));
        }
        const std::vector<float> before(std::begin(surface->z_site_m), std::end(surface->z_site_m));
        const int32_t old_row = surface->origin_row;
        const int32_t old_col = surface->origin_col;
        std::vector<nav_point_t> points(static_cast<size_t>(random() % 3000U));
        for (nav_point_t &p : points)
        {
            p = {4.0F * unit(random) + 9.0F, 7.0F * unit(random), unit(random)};
        }
        merge(points, step + 1U, step,
              {x, y, 0.0, 0.0, 0.0, 6.0 * static_cast<double>(unit(random))});
        ASSERT_NO_FATAL_FAILURE(expect_surface_of_all(step));
        for (int32_t r = 0; r < kSize; r++)
        {
            for (int32_t c = 0; c < kSize; c++)
            {
                const int32_t row = surface->origin_row + r;
                const int32_t col = surface->origin_col + c;
                const bool is_old = row >= old_row && row < old_row + kSize && col >= old_col &&
                                    col < old_col + kSize;
                const float now = surface->z_site_m[r * kSize + c];
                if (!is_old || (step == 0U) ||
                    now != before[static_cast<size_t>((row - old_row) * kSize + col - old_col)])
                {
                    ASSERT_TRUE(is_stamped(row, col)) << step << " " << row << " " << col;
                }
            }
        }
    }
}

TEST_F(NavHeightmap, HeightsFollowTheCornerAsLongAsSomeStay)
{
    std::vector<float> z(NAV_HEIGHTMAP_CELLS);
    z[(100 * kSize) + 200] = 5.0F;
    EXPECT_TRUE(nav_heightmap_follow(z.data(), kSize, 0, 0));
    EXPECT_EQ(z[(100 * kSize) + 200], 5.0F);
    EXPECT_TRUE(nav_heightmap_follow(z.data(), kSize, 3, -20));
    EXPECT_EQ(z[(97 * kSize) + 220], 5.0F);
    EXPECT_TRUE(nav_heightmap_follow(z.data(), kSize, -30, 7));
    EXPECT_EQ(z[(127 * kSize) + 213], 5.0F);
    for (int64_t far : {int64_t{-kSize}, int64_t{kSize}})
    {
        EXPECT_FALSE(nav_heightmap_follow(z.data(), kSize, far, 0));
        EXPECT_FALSE(nav_heightmap_follow(z.data(), kSize, 0, far));
    }
    EXPECT_EQ(z[(127 * kSize) + 213], 5.0F);
}
