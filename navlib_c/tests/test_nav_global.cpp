// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_global.h"
#include "nav_math.h"
}

namespace
{

constexpr int kSize = NAV_COSTMAP_SIZE;
constexpr double kCell = 0.5;

class NavGlobal : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        nav_params_default(&params);
        nav_costmap_init(map.get(), &params);
        ASSERT_TRUE(nav_costmap_recenter(map.get(), &params, 0.0, 0.0));
        flat_s_per_m = 1.0 / params.speed_max_m_per_s;
        unknown_s_per_m = params.cost_unknown_factor / params.speed_max_m_per_s;
        for (nav_cost_cell_t &cell : map->cells)
        {
            cell.is_known = 1U;
            cell.cost_s_per_m = 1.0F;
        }
    }

    nav_cost_cell_t &at(int row, int col)
    {
        return map->cells[row * kSize + col];
    }

    double center(int index) const
    {
        return (index - kSize / 2 + 0.5) * kCell;
    }

    nav_waydisc_t goal_at(int row, int col, double radius = 0.0) const
    {
        return {center(row), center(col), radius};
    }

    void plan(const nav_waydisc_t &goal, bool use_terrain = true, bool use_zones = true)
    {
        nav_global_plan(global.get(), map.get(), &params, &goal, use_terrain, use_zones);
    }

    double to_go(int row, int col) const
    {
        return global->cost_to_go_s[(row + 1) * NAV_GLOBAL_SIZE + col + 1];
    }

    void block(int row, int col)
    {
        at(row, col).terrain_reason = NAV_REASON_TILT;
    }

    // how much dearer a step is for what bars its heading at its ends, or at both its sides
    double factor(int row, int col, int r, int c) const
    {
        const auto barred = [this](int i, int j)
        { return nav_costmap_barred(&map->cells[i * kSize + j]); };
        const int heading = (r == row) ? 2 : ((c == col) ? 0 : (((r > row) == (c > col)) ? 1 : 3));
        const uint32_t bits = barred(row, col) | barred(r, c) | (barred(row, c) & barred(r, col));
        return ((bits >> heading) & 1U) != 0U ? params.cost_barred_factor : 1.0;
    }

    void make_random(uint64_t seed, double blocked_share)
    {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<float> costs(0.0F, 1.0F);
        for (nav_cost_cell_t &cell : map->cells)
        {
            cell.cost_s_per_m = 1.0F + 20.0F * costs(random) * costs(random);
            cell.terrain_reason = (static_cast<double>(costs(random)) < blocked_share)
                                      ? NAV_REASON_TILT
                                      : NAV_REASON_NONE;
            cell.barred_headings = static_cast<uint8_t>(random() & random() & random() & 0xFU);
            cell.ace_failed_headings = static_cast<uint8_t>(random() & random() & random() & 0xFU);
        }
    }

    // Bellman-Ford with a queue, from the seeds given
    std::vector<double> oracle(std::vector<double> cost_s) const
    {
        std::deque<int> queue;
        for (int cell = 0; cell < NAV_COSTMAP_CELLS; cell++)
        {
            if (cost_s[static_cast<size_t>(cell)] < NAV_COST_INFINITE)
            {
                queue.push_back(cell);
            }
        }
        const auto is_blocked = [this](int row, int col)
        { return map->cells[row * kSize + col].terrain_reason != NAV_REASON_NONE; };
        while (!queue.empty())
        {
            const int cell = queue.front();
            queue.pop_front();
            const int row = cell / kSize;
            const int col = cell % kSize;
            for (int r = std::max(row - 1, 0); r <= std::min(row + 1, kSize - 1); r++)
            {
                for (int c = std::max(col - 1, 0); c <= std::min(col + 1, kSize - 1); c++)
                {
                    if (is_blocked(r, c) || (is_blocked(row, c) && is_blocked(r, col)))
                    {
                        continue;
                    }
                    const double mean =
                        (static_cast<double>(map->cells[cell].cost_s_per_m) +
                         static_cast<double>(map->cells[r * kSize + c].cost_s_per_m)) /
                        2;
                    const double next =
                        cost_s[static_cast<size_t>(cell)] +
                        kCell * std::hypot(r - row, c - col) * mean * factor(row, col, r, c);
                    double &known = cost_s[static_cast<size_t>(r * kSize + c)];
                    if (next < known - 1e-12)
                    {
                        known = next;
                        queue.push_back(r * kSize + c);
                    }
                }
            }
        }
        return cost_s;
    }

    void expect_costs(const std::vector<double> &expected)
    {
        for (int cell = 0; cell < NAV_COSTMAP_CELLS; cell++)
        {
            const double cost_s = expected[static_cast<size_t>(cell)];
            ASSERT_NEAR(to_go(cell / kSize, cell % kSize), cost_s, 1e-9 * cost_s + 1e-9) << cell;
        }
    }

    std::vector<nav_point_t> descend(double x, double y, uint32_t capacity = 10000U) const
    {
        std::vector<nav_point_t> points(capacity + 1U, nav_point_t{7.0F, 7.0F, 7.0F});
        const uint32_t count =
            nav_global_descend(global.get(), map.get(), x, y, points.data(), capacity);
        EXPECT_LE(count, capacity);
        EXPECT_EQ(points[count].z_m, 7.0F);
        points.resize(count);
        return points;
    }

    nav_params_t params = {};
    double flat_s_per_m = 0.0;
    double unknown_s_per_m = 0.0;
    std::unique_ptr<nav_costmap_t> map = std::make_unique<nav_costmap_t>();
    std::unique_ptr<nav_global_t> global = std::make_unique<nav_global_t>();
};

} // namespace

TEST_F(NavGlobal, OnUniformGroundTheCostIsTheOctileDistance)
{
    plan(goal_at(40, 60));
    EXPECT_EQ(global->is_goal_inside, 1U);
    for (int row = 0; row < kSize; row++)
    {
        for (int col = 0; col < kSize; col++)
        {
            const int longer = std::max(std::abs(row - 40), std::abs(col - 60));
            const int shorter = std::min(std::abs(row - 40), std::abs(col - 60));
            ASSERT_NEAR(to_go(row, col), kCell * (longer - shorter + std::sqrt(2.0) * shorter),
                        1e-9);
        }
    }
}

TEST_F(NavGlobal, CostsAgreeWithBellmanFordOnRandomGround)
{
    for (uint64_t seed = 0; seed < 12; seed++)
    {
        make_random(seed, 0.05 * static_cast<double>(seed));
        at(50, 30).terrain_reason = NAV_REASON_NONE;
        plan(goal_at(50, 30));
        std::vector<double> seeds(NAV_COSTMAP_CELLS, NAV_COST_INFINITE);
        seeds[50 * kSize + 30] = 0.0;
        expect_costs(oracle(seeds));
    }
}

TEST_F(NavGlobal, CostsAgreeWithBellmanFordForGoalsOffTheMap)
{
    const struct
    {
        double x;
        double y;
    } goals[] = {{60, 3},   {-60, 3},   {3, 60}, {3, -60},    {60, 60},
                 {-60, 60}, {-26, -60}, {25, 0}, {0, -25.001}};
    uint64_t seed = 100;
    for (const auto &g : goals)
    {
        make_random(seed++, 0.2);
        plan({g.x, g.y, 2.0});
        EXPECT_EQ(global->is_goal_inside, 0U);
        std::vector<double> seeds(NAV_COSTMAP_CELLS, NAV_COST_INFINITE);
        for (int row = 0; row < kSize; row++)
        {
            for (int col = 0; col < kSize; col++)
            {
                const bool faces = (g.x >= 25 && row == kSize - 1) || (g.x < -25 && row == 0) ||
                                   (g.y >= 25 && col == kSize - 1) || (g.y < -25 && col == 0);
                if (faces && at(row, col).terrain_reason == NAV_REASON_NONE)
                {
                    seeds[static_cast<size_t>(row * kSize + col)] =
                        std::hypot(center(row) - g.x, center(col) - g.y) * unknown_s_per_m;
                }
            }
        }
        expect_costs(oracle(seeds));
    }
}

TEST_F(NavGlobal, GroundAMillionTimesDearerThanTheRestAgreesWithBellmanFord)
{
    for (uint64_t seed = 0; seed < 3; seed++)
    {
        make_random(seed, 0.1);
        std::mt19937_64 random(seed);
        for (nav_cost_cell_t &cell : map->cells)
        {
            cell.cost_s_per_m *= (random() % 2U == 0U) ? 1.0F : 1.0e6F;
        }
        at(50, 30).terrain_reason = NAV_REASON_NONE;
        plan(goal_at(50, 30));
        std::vector<double> seeds(NAV_COSTMAP_CELLS, NAV_COST_INFINITE);
        seeds[50 * kSize + 30] = 0.0;
        expect_costs(oracle(seeds));
    }
}

TEST_F(NavGlobal, EveryCostIsTheLeastThroughANeighbourToTheLastBit)
{
    for (uint64_t seed = 0; seed < 6; seed++)
    {
        make_random(seed, 0.2);
        at(20, 70).terrain_reason = NAV_REASON_NONE;
        plan(goal_at(20, 70));
        const auto is_blocked = [this](int row, int col)
        { return at(row, col).terrain_reason != NAV_REASON_NONE; };
        for (int cell = 0; cell < NAV_COSTMAP_CELLS; cell++)
        {
            const int row = cell / kSize;
            const int col = cell % kSize;
            double least = (row == 20 && col == 70) ? 0.0 : NAV_COST_INFINITE;
            for (int r = std::max(row - 1, 0); r <= std::min(row + 1, kSize - 1); r++)
            {
                for (int c = std::max(col - 1, 0); c <= std::min(col + 1, kSize - 1); c++)
                {
                    if (!is_blocked(row, col) && !is_blocked(r, c) &&
                        !(is_blocked(row, c) && is_blocked(r, col)) && (r != row || c != col))
                    {
                        const double mean = (static_cast<double>(at(row, col).cost_s_per_m) +
                                             static_cast<double>(at(r, c).cost_s_per_m)) *
                                            0.5;
                        const double length =
                            (r != row && c != col) ? kCell * 1.41421356237309504880169 : kCell;
                        least =
                            std::min(least, to_go(r, c) + length * mean * factor(row, col, r, c));
                    }
                }
            }
            ASSERT_EQ(to_go(row, col), least) << cell;
        }
    }
}

TEST_F(NavGlobal, GroundThatCostsNothingIsCrossedForNothing)
{
    for (nav_cost_cell_t &cell : map->cells)
    {
        cell.cost_s_per_m = 0.0F;
    }
    plan(goal_at(10, 10));
    EXPECT_EQ(to_go(90, 90), 0.0);
}

TEST_F(NavGlobal, PlanningTwiceGivesTheSameBits)
{
    make_random(5, 0.3);
    plan({80.0, 20.0, 3.0});
    const nav_global_t first = *global;
    plan(goal_at(3, 3));
    plan({80.0, 20.0, 3.0});
    EXPECT_EQ(std::memcmp(first.cost_to_go_s, global->cost_to_go_s, sizeof(first.cost_to_go_s)), 0);
}

TEST_F(NavGlobal, FreeCellsInsideTheWaydiscCostNothing)
{
    block(50, 51);
    plan(goal_at(50, 50, 1.01));
    EXPECT_EQ(to_go(50, 50), 0.0);
    EXPECT_EQ(to_go(52, 50), 0.0);
    EXPECT_EQ(to_go(51, 51), 0.0);
    EXPECT_EQ(to_go(50, 51), NAV_COST_INFINITE);
    EXPECT_NEAR(to_go(53, 50), kCell, 1e-12);
    EXPECT_GT(to_go(52, 51), 0.0);
}

TEST_F(NavGlobal, TheCellOfTheGoalIsASeedEvenIfItsCentreLiesOutsideTheWaydisc)
{
    plan({center(20) + 0.24, center(30) - 0.24, 0.01});
    EXPECT_EQ(to_go(20, 30), 0.0);
    EXPECT_GT(to_go(21, 30), 0.0);
}

TEST_F(NavGlobal, ABlockedGoalIsReplacedByTheNearestFreeCell)
{
    for (int row = 48; row <= 52; row++)
    {
        for (int col = 48; col <= 52; col++)
        {
            block(row, col);
        }
    }
    plan({center(50) + 0.01, center(50), 0.6});
    EXPECT_EQ(to_go(53, 50), 0.0);
    EXPECT_GT(to_go(47, 50), 0.0);
    plan(goal_at(50, 50)); // four cells equally near: the first by index
    EXPECT_EQ(to_go(47, 50), 0.0);
    EXPECT_GT(to_go(50, 47), 0.0);
    EXPECT_GT(to_go(53, 50), 0.0);
}

TEST_F(NavGlobal, WithEverythingBlockedNothingIsReached)
{
    for (nav_cost_cell_t &cell : map->cells)
    {
        cell.terrain_reason = NAV_REASON_UNEXPECTED;
    }
    plan(goal_at(50, 50, 3.0));
    EXPECT_EQ(*std::min_element(global->cost_to_go_s, global->cost_to_go_s + NAV_GLOBAL_NODES),
              NAV_COST_INFINITE);
    plan({100.0, 100.0, 3.0});
    EXPECT_EQ(*std::min_element(global->cost_to_go_s, global->cost_to_go_s + NAV_GLOBAL_NODES),
              NAV_COST_INFINITE);
}

TEST_F(NavGlobal, AnEnclosedGoalIsReachedFromInsideOnly)
{
    for (int i = 40; i <= 60; i++)
    {
        block(40, i);
        block(60, i);
        block(i, 40);
        block(i, 60);
    }
    plan(goal_at(50, 50));
    EXPECT_LT(to_go(41, 41), NAV_COST_INFINITE);
    EXPECT_EQ(to_go(39, 39), NAV_COST_INFINITE);
    EXPECT_EQ(to_go(0, 0), NAV_COST_INFINITE);
}

TEST_F(NavGlobal, NoPathSqueezesBetweenTwoBlockedCornersButOneMayBePassed)
{
    for (int i = 0; i < kSize; i++)
    {
        block(i, kSize - 1 - i); // diagonal wall from corner to corner
    }
    plan(goal_at(10, 10));
    EXPECT_EQ(to_go(90, 90), NAV_COST_INFINITE);
    at(50, 49).terrain_reason = NAV_REASON_NONE;
    plan(goal_at(10, 10));
    EXPECT_LT(to_go(90, 90), NAV_COST_INFINITE);
}

TEST_F(NavGlobal, AWayAlongABarredHeadingIsDearerIntoTheCellAndOutOfIt)
{
    for (int row = 0; row < kSize; row++)
    {
        block(row, 49);
        block(row, 51); // a corridor north, one cell wide
    }
    const auto cost_s = [this]
    {
        plan(goal_at(60, 50));
        return to_go(40, 50);
    };
    EXPECT_NEAR(cost_s(), 20 * kCell, 1e-9);
    at(50, 50).barred_headings = 0b1110U; // across the corridor
    EXPECT_NEAR(cost_s(), 20 * kCell, 1e-9);
    at(50, 50).barred_headings = 0b0001U;
    EXPECT_NEAR(cost_s(), (18 + 2 * params.cost_barred_factor) * kCell, 1e-9);
    at(50, 50).barred_headings = 0U;
    at(50, 50).ace_failed_headings = 0b0001U;
    EXPECT_NEAR(cost_s(), (18 + 2 * params.cost_barred_factor) * kCell, 1e-9);
    EXPECT_EQ(descend(center(40), center(50)).size(), 21U);
}

TEST_F(NavGlobal, ADetourIsTakenWhileItIsCheaperThanTheBarredWay)
{
    for (int col = 45; col <= 55; col++)
    {
        at(50, col).barred_headings = 0xFU;
    }
    plan(goal_at(60, 50));
    for (const nav_point_t &p : descend(center(40), center(50)))
    {
        EXPECT_FALSE(static_cast<double>(p.x_m) == center(50) &&
                     std::fabs(static_cast<double>(p.y_m) - center(50)) < 5.5 * kCell);
    }
    params.cost_barred_factor = 1.01;
    plan(goal_at(60, 50));
    EXPECT_EQ(descend(center(40), center(50)).size(), 21U);
}

TEST_F(NavGlobal, SqueezingBetweenTwoBarredCornersIsDearerButOneMayBePassed)
{
    const auto cost_s = [this]
    {
        plan(goal_at(50, 50));
        return to_go(51, 51);
    };
    at(50, 51).barred_headings = 0b0010U;
    EXPECT_NEAR(cost_s(), std::sqrt(2.0) * kCell, 1e-9);
    at(51, 50).barred_headings = 0b1101U;
    EXPECT_NEAR(cost_s(), std::sqrt(2.0) * kCell, 1e-9);
    at(51, 50).barred_headings = 0b0010U;
    EXPECT_NEAR(cost_s(), 2 * kCell, 1e-9); // round the corner
}

TEST_F(NavGlobal, WithoutTerrainNothingIsBarred)
{
    for (nav_cost_cell_t &cell : map->cells)
    {
        cell.barred_headings = 0xFU;
        cell.ace_failed_headings = 0xFU;
        cell.ace_reason = NAV_REASON_CLEARANCE;
    }
    plan(goal_at(60, 50), false, true);
    EXPECT_NEAR(to_go(40, 50), 20 * kCell * flat_s_per_m, 1e-9);
}

TEST_F(NavGlobal, ModesDecideWhatBlocks)
{
    at(50, 50).terrain_reason = NAV_REASON_TILT;
    at(51, 51).is_forbidden = 1U;
    at(52, 52).cost_s_per_m = 500.0F;
    const auto cost = [this](int i)
    { return global->cost_s_per_m[(i + 1) * NAV_GLOBAL_SIZE + i + 1]; };
    plan(goal_at(10, 10), true, true);
    EXPECT_EQ(cost(50), NAV_COST_BLOCKED_S_PER_M);
    EXPECT_EQ(cost(51), NAV_COST_BLOCKED_S_PER_M);
    EXPECT_EQ(cost(52), 500.0);
    plan(goal_at(10, 10), false, true);
    EXPECT_EQ(cost(50), flat_s_per_m);
    EXPECT_EQ(cost(51), NAV_COST_BLOCKED_S_PER_M);
    EXPECT_EQ(cost(52), flat_s_per_m);
    plan(goal_at(10, 10), true, false);
    EXPECT_EQ(cost(50), NAV_COST_BLOCKED_S_PER_M);
    EXPECT_EQ(cost(51), 1.0);
    plan(goal_at(10, 10), false, false);
    EXPECT_EQ(cost(50), flat_s_per_m);
    EXPECT_EQ(cost(51), flat_s_per_m);
}

TEST_F(NavGlobal, ASpiralMazeIsFollowedToItsEnd)
{
    // walls in every second row, open at alternating ends
    for (int row = 1; row < kSize; row += 2)
    {
        for (int col = 0; col < kSize; col++)
        {
            if (col != ((row / 2) % 2 == 0 ? kSize - 1 : 0))
            {
                block(row, col);
            }
        }
    }
    plan(goal_at(0, 0));
    EXPECT_GT(to_go(98, 0), 49 * 97 * kCell);
    EXPECT_LT(to_go(98, 0), NAV_COST_INFINITE);
    const auto points = descend(center(98), center(0));
    EXPECT_GT(points.size(), 49U * 97U);
    EXPECT_FLOAT_EQ(points.back().x_m, static_cast<float>(center(0)));
    EXPECT_FLOAT_EQ(points.back().y_m, static_cast<float>(center(0)));
}

TEST_F(NavGlobal, CostToGoFromAPositionIsTheLeastOverItsNeighbourhood)
{
    make_random(9, 0.25);
    const nav_waydisc_t goal = goal_at(80, 80, 1.0);
    plan(goal);
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> coordinates(-24.9, 24.9);
    for (int i = 0; i < 5000; i++)
    {
        const double x = coordinates(random);
        const double y = coordinates(random);
        const int row = static_cast<int>(std::floor(x / kCell)) + kSize / 2;
        const int col = static_cast<int>(std::floor(y / kCell)) + kSize / 2;
        double least = NAV_COST_INFINITE;
        const auto is_blocked = [this](int r, int c)
        { return at(r, c).terrain_reason != NAV_REASON_NONE; };
        for (int r = std::max(row - 1, 0); r <= std::min(row + 1, kSize - 1); r++)
        {
            for (int c = std::max(col - 1, 0); c <= std::min(col + 1, kSize - 1); c++)
            {
                if (!is_blocked(row, col) && !is_blocked(r, c) &&
                    !(is_blocked(row, c) && is_blocked(r, col)))
                {
                    const double mean = (static_cast<double>(at(row, col).cost_s_per_m) +
                                         static_cast<double>(at(r, c).cost_s_per_m)) /
                                        2;
                    const double own = (r == row && c == col) ? 1.0 : factor(row, col, r, c);
                    least = std::min(
                        least, to_go(r, c) + mean * std::hypot(center(r) - x, center(c) - y) * own);
                }
            }
        }
        ASSERT_NEAR(nav_global_cost_to_go_s(global.get(), map.get(), &params, &goal, x, y), least,
                    1e-9 * least);
    }
}

TEST_F(NavGlobal, OffTheMapTheCostIsTheStraightLineOverUnknownGround)
{
    const nav_waydisc_t goal = {33.0, 44.0, 3.0};
    plan(goal);
    EXPECT_NEAR(nav_global_cost_to_go_s(global.get(), map.get(), &params, &goal, 30.0, 40.0),
                5.0 * unknown_s_per_m, 1e-9);
    EXPECT_EQ(nav_global_cost_to_go_s(global.get(), map.get(), &params, &goal, 1e30, 40.0),
              NAV_COST_INFINITE);
}

TEST_F(NavGlobal, DescentFollowsTheCheapestCellsToASeed)
{
    make_random(11, 0.25);
    const nav_waydisc_t goal = goal_at(10, 90, 2.0);
    plan(goal);
    for (int start = 5; start < kSize; start += 9)
    {
        const auto points = descend(center(start) + 0.1, center(20) - 0.1);
        if (to_go(start, 20) >= NAV_COST_INFINITE)
        {
            EXPECT_TRUE(points.empty());
            continue;
        }
        double cost_s = 0.0;
        for (size_t i = 1; i < points.size(); i++)
        {
            const double dx =
                static_cast<double>(points[i].x_m) - static_cast<double>(points[i - 1].x_m);
            const double dy =
                static_cast<double>(points[i].y_m) - static_cast<double>(points[i - 1].y_m);
            uint32_t a = 0;
            uint32_t b = 0;
            ASSERT_TRUE(nav_costmap_find(map.get(), static_cast<double>(points[i - 1].x_m),
                                         static_cast<double>(points[i - 1].y_m), &a));
            ASSERT_TRUE(nav_costmap_find(map.get(), static_cast<double>(points[i].x_m),
                                         static_cast<double>(points[i].y_m), &b));
            ASSERT_LE(std::max(std::fabs(dx), std::fabs(dy)), kCell + 1e-6);
            cost_s += std::hypot(dx, dy) *
                      (static_cast<double>(map->cells[a].cost_s_per_m) +
                       static_cast<double>(map->cells[b].cost_s_per_m)) /
                      2 *
                      factor(static_cast<int>(a) / kSize, static_cast<int>(a) % kSize,
                             static_cast<int>(b) / kSize, static_cast<int>(b) % kSize);
        }
        EXPECT_NEAR(cost_s, to_go(start, 20), 1e-4 * cost_s);
        EXPECT_LE(std::hypot(static_cast<double>(points.back().x_m) - goal.x_site_m,
                             static_cast<double>(points.back().y_m) - goal.y_site_m),
                  2.001);
    }
}

TEST_F(NavGlobal, DescentTakesTheFirstOfEquallyCheapCells)
{
    for (nav_cost_cell_t &cell : map->cells)
    {
        cell.cost_s_per_m = 2.0F;
    }
    block(50, 50); // the way round it on either side costs the same
    plan(goal_at(10, 50));
    const auto points = descend(center(90), center(50));
    EXPECT_EQ(points.size(), 81U);
    EXPECT_TRUE(std::any_of(points.begin(), points.end(), [this](const nav_point_t &p)
                            { return static_cast<double>(p.y_m) < center(50); }));
    EXPECT_TRUE(std::none_of(points.begin(), points.end(), [this](const nav_point_t &p)
                             { return static_cast<double>(p.y_m) > center(50); }));
}

TEST_F(NavGlobal, DescentEndsAtTheCapacityOrAtOnce)
{
    plan(goal_at(10, 10));
    EXPECT_EQ(descend(center(90), center(90), 5U).size(), 5U);
    EXPECT_EQ(descend(center(90), center(90), 0U).size(), 0U);
    EXPECT_EQ(descend(center(10), center(10)).size(), 1U);
    EXPECT_EQ(descend(100.0, 0.0).size(), 0U);
    block(20, 20);
    plan(goal_at(10, 10));
    EXPECT_EQ(descend(center(20), center(20)).size(), 0U);
}

TEST_F(NavGlobal, CostsOverManyOrdersOfMagnitudeStayOrdered)
{
    for (int cell = 0; cell < NAV_COSTMAP_CELLS; cell++)
    {
        map->cells[cell].cost_s_per_m = (cell % 7 == 0) ? 1e-30F : ((cell % 5 == 0) ? 1e30F : 1.0F);
    }
    plan(goal_at(50, 50));
    for (int cell = 0; cell < NAV_COSTMAP_CELLS; cell++)
    {
        ASSERT_GE(to_go(cell / kSize, cell % kSize), 0.0);
        ASSERT_LE(to_go(cell / kSize, cell % kSize), NAV_COST_INFINITE);
    }
}
