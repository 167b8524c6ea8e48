// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

extern "C"
{
#include "navlib.h"
}

namespace
{

nav_params_t defaults()
{
    nav_params_t params;
    nav_params_default(&params);
    return params;
}

nav_params_t with(uint32_t index, double value)
{
    nav_params_t params = defaults();
    std::memcpy(reinterpret_cast<char *>(&params) + index * sizeof(double), &value, sizeof(value));
    return params;
}

uint32_t index_of(const std::string &name)
{
    uint32_t index = 0U;
    while ((index < NAV_PARAM_COUNT) && (name != nav_param_defs[index].name))
    {
        index++;
    }
    EXPECT_LT(index, static_cast<uint32_t>(NAV_PARAM_COUNT)) << name;
    return index;
}

void expect_ok(const nav_params_t &params)
{
    uint32_t index = 0U;
    EXPECT_EQ(nav_params_check(&params, &index), NAV_OK);
    EXPECT_EQ(index, static_cast<uint32_t>(NAV_PARAM_COUNT));
}

void expect_conflict(const nav_params_t &params, const std::string &name)
{
    uint32_t index = 0U;
    EXPECT_EQ(nav_params_check(&params, &index), NAV_PARAMETER_CONFLICT) << name;
    EXPECT_EQ(index, index_of(name)) << name;
}

} // namespace

TEST(NavParams, DefaultsAreAccepted)
{
    expect_ok(defaults());
}

TEST(NavParams, DefaultsAreThoseOfTheTableAndInRange)
{
    const nav_params_t params = defaults();
    std::set<std::string> names;
    for (uint32_t index = 0U; index < NAV_PARAM_COUNT; index++)
    {
        const nav_param_def_t &def = nav_param_defs[index];
        double value = 0.0;
        std::memcpy(&value, reinterpret_cast<const char *>(&params) + index * sizeof(double),
                    sizeof(value));
        EXPECT_EQ(value, def.default_value) << def.name;
        EXPECT_LE(def.min_value, def.default_value) << def.name;
        EXPECT_GE(def.max_value, def.default_value) << def.name;
        names.insert(def.name);
    }
    EXPECT_EQ(names.size(), static_cast<size_t>(NAV_PARAM_COUNT));
}

TEST(NavParams, NullPointersAreRefused)
{
    const nav_params_t params = defaults();
    uint32_t index = 7U;
    nav_params_default(nullptr);
    EXPECT_EQ(nav_params_check(nullptr, &index), NAV_NULL_POINTER);
    EXPECT_EQ(nav_params_check(&params, nullptr), NAV_NULL_POINTER);
}

TEST(NavParams, EveryParameterIsRefusedOutsideItsRange)
{
    for (uint32_t index = 0U; index < NAV_PARAM_COUNT; index++)
    {
        const nav_param_def_t &def = nav_param_defs[index];
        const double infinity = std::numeric_limits<double>::infinity();
        for (double value :
             {std::nextafter(def.min_value, -infinity), std::nextafter(def.max_value, infinity),
              infinity, -infinity, std::numeric_limits<double>::quiet_NaN()})
        {
            const nav_params_t params = with(index, value);
            uint32_t refused = 0U;
            EXPECT_EQ(nav_params_check(&params, &refused), NAV_PARAMETER_RANGE) << def.name;
            EXPECT_EQ(refused, index) << def.name << " " << value;
        }
    }
}

TEST(NavParams, TheLimitsThemselvesAreNeverOutOfRange)
{
    for (uint32_t index = 0U; index < NAV_PARAM_COUNT; index++)
    {
        for (double value : {nav_param_defs[index].min_value, nav_param_defs[index].max_value})
        {
            const nav_params_t params = with(index, value);
            uint32_t refused = 0U;
            EXPECT_NE(nav_params_check(&params, &refused), NAV_PARAMETER_RANGE);
        }
    }
}

TEST(NavParams, TheFirstParameterRefusedIsNamed)
{
    nav_params_t params = defaults();
    params.product_level = 9.0;
    params.tilt_max_rad = -1.0;
    params.belly_height_m = std::numeric_limits<double>::quiet_NaN();
    uint32_t index = 0U;
    EXPECT_EQ(nav_params_check(&params, &index), NAV_PARAMETER_RANGE);
    EXPECT_EQ(index, index_of("tilt_max_rad"));
    params = defaults();
    params.middle_x_m = 0.5;
    params.front_x_m = 0.5;
    params.ace_budget_poses = 1.5;
    params.execute_length_m = 4.0;
    expect_conflict(params, "execute_length_m");
}

TEST(NavParams, CountsMustBeWhole)
{
    for (const char *name : {"surface_fill_neighbors", "ace_feedback_cycles", "ace_budget_poses"})
    {
        expect_conflict(with(index_of(name), 2.5), name);
        expect_ok(with(index_of(name), 4.0));
    }
    expect_conflict(with(index_of("product_level"), 0.5), "product_level");
    expect_ok(with(index_of("product_level"), 2.0));
}

TEST(NavParams, ThePatchIsAnOddNumberOfCells)
{
    for (double cells : {4.0, 6.0, 4.5, 3.5, 5.000001})
    {
        expect_conflict(with(index_of("costmap_patch_cells"), cells), "costmap_patch_cells");
    }
    for (double cells : {3.0, 5.0, 7.0})
    {
        expect_ok(with(index_of("costmap_patch_cells"), cells));
    }
}

TEST(NavParams, WheelsAndPivotsStandInOrder)
{
    nav_params_t params = defaults();
    params.middle_x_m = params.front_x_m = 0.9;
    expect_conflict(params, "middle_x_m");
    params = defaults();
    params.middle_x_m = params.rear_x_m = -0.9;
    expect_conflict(params, "rear_x_m");
    expect_conflict(with(index_of("bogie_pivot_x_m"), defaults().rear_x_m), "bogie_pivot_x_m");
    expect_conflict(with(index_of("bogie_pivot_x_m"), 0.0), "bogie_pivot_x_m");
    expect_conflict(with(index_of("rocker_pivot_x_m"), -0.5), "rocker_pivot_x_m");
    expect_conflict(with(index_of("rocker_pivot_x_m"), 1.5), "rocker_pivot_x_m");
}

TEST(NavParams, TheBellyIsABoxAboveTheHubsAndAboveItsLimit)
{
    expect_conflict(with(index_of("belly_rear_x_m"), 0.9), "belly_rear_x_m");
    nav_params_t params = defaults();
    params.clearance_min_m = 0.0;
    params.belly_height_m = params.wheel_radius_m;
    expect_conflict(params, "belly_height_m");
    expect_conflict(with(index_of("clearance_min_m"), 0.6), "clearance_min_m");
    expect_ok(with(index_of("clearance_min_m"), 0.599));
}

TEST(NavParams, TheRecentringMarginLeavesRoomForTheHeightmap)
{
    const uint32_t index = index_of("costmap_recenter_margin_m");
    expect_ok(with(index, 15.5));
    expect_conflict(with(index, 15.49), "costmap_recenter_margin_m");
    expect_ok(with(index, 24.0));
    nav_params_t params = with(index, 12.0);
    params.heightmap_cell_m = 0.05;
    params.costmap_recenter_margin_m = 12.0;
    expect_ok(params);
    params.costmap_recenter_margin_m = 12.25;
    expect_conflict(params, "costmap_recenter_margin_m");
}

TEST(NavParams, ThePosesOfAnArcFitItsCapacity)
{
    expect_ok(with(index_of("pose_spacing_m"), 0.05));
    nav_params_t params = defaults();
    params.pose_spacing_m = 0.0999;
    params.tree_arc_length_m = 6.0;
    expect_ok(params);
    params.pose_spacing_m = 0.09;
    expect_conflict(params, "pose_spacing_m");
    expect_ok(with(index_of("pose_spacing_rad"), 0.05));
    expect_conflict(with(index_of("pose_spacing_rad"), 0.049), "pose_spacing_rad");
}

TEST(NavParams, NoMoreThanAnArcIsDrivenAtOnce)
{
    expect_ok(with(index_of("execute_length_m"), 3.0));
    expect_conflict(with(index_of("execute_length_m"), 3.001), "execute_length_m");
    expect_conflict(with(index_of("tree_arc_length_m"), 0.999), "execute_length_m");
}

TEST(NavParams, TheOuterArcsTurnLessThanAQuarter)
{
    expect_ok(with(index_of("tree_heading_step_rad"), 0.314));
    expect_conflict(with(index_of("tree_heading_step_rad"), 0.3142), "tree_heading_step_rad");
}
