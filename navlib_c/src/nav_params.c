/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_params.c
 * @brief Defaults and checks of the parameters.
 */
#include "nav_params.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "nav_guard.h"
#include "nav_math.h"

#define NAV_PARAM_DEF(name, value, low, high, unit, doc)                                           \
    {#name, (value), (low), (high), (unit), (doc)},

const nav_param_def_t nav_param_defs[NAV_PARAM_COUNT] = {NAV_PARAM_TABLE(NAV_PARAM_DEF)};

_Static_assert((sizeof(nav_params_t) / sizeof(double)) ==
                   (sizeof(nav_param_defs) / sizeof(nav_param_defs[0])),
               "parameters are nothing but doubles");

#define NAV_PARAMS ((uint32_t) (sizeof(nav_params_t) / sizeof(double)))

#define NAV_PARAM_INDEX(name) ((uint32_t) (offsetof(nav_params_t, name) / sizeof(double)))
#define NAV_RULE_COUNT(rules) ((uint32_t) (sizeof(rules) / sizeof((rules)[0])))
#define NAV_RULES_MAX 16U

/* A rule between parameters, and the parameter to blame when it is broken. */
typedef struct
{
    bool is_broken;
    uint32_t index;
} nav_rule_t;

static uint32_t first_broken(const nav_rule_t *rules, uint32_t rule_count)
{
    uint32_t index = NAV_PARAMS;

    for (uint32_t rule = 0U; NAV_ALWAYS(rule < NAV_RULES_MAX) && (rule < rule_count); rule++)
    {
        if (rules[rule].is_broken && (rules[rule].index < index))
        {
            index = rules[rule].index;
        }
    }
    return index;
}

static bool is_fraction(double value)
{
    return (value - floor(value)) > 0.0;
}

static uint32_t check_whole_numbers(const nav_params_t *params)
{
    const nav_rule_t rules[] = {
        {is_fraction(params->surface_fill_neighbors), NAV_PARAM_INDEX(surface_fill_neighbors)},
        {is_fraction((params->costmap_patch_cells - 1.0) / 2.0),
         NAV_PARAM_INDEX(costmap_patch_cells)},
        {is_fraction(params->ace_feedback_cycles), NAV_PARAM_INDEX(ace_feedback_cycles)},
        {is_fraction(params->ace_budget_poses), NAV_PARAM_INDEX(ace_budget_poses)},
        {is_fraction(params->product_level), NAV_PARAM_INDEX(product_level)}};

    return first_broken(rules, NAV_RULE_COUNT(rules));
}

static uint32_t check_geometry(const nav_params_t *params)
{
    const nav_rule_t rules[] = {
        {params->middle_x_m >= params->front_x_m, NAV_PARAM_INDEX(middle_x_m)},
        {params->rear_x_m >= params->middle_x_m, NAV_PARAM_INDEX(rear_x_m)},
        {params->bogie_pivot_x_m <= params->rear_x_m, NAV_PARAM_INDEX(bogie_pivot_x_m)},
        {params->bogie_pivot_x_m >= params->middle_x_m, NAV_PARAM_INDEX(bogie_pivot_x_m)},
        {params->rocker_pivot_x_m <= params->bogie_pivot_x_m, NAV_PARAM_INDEX(rocker_pivot_x_m)},
        {params->rocker_pivot_x_m >= params->front_x_m, NAV_PARAM_INDEX(rocker_pivot_x_m)},
        {params->belly_rear_x_m >= params->belly_front_x_m, NAV_PARAM_INDEX(belly_rear_x_m)},
        {params->belly_height_m <= params->wheel_radius_m, NAV_PARAM_INDEX(belly_height_m)},
        {params->clearance_min_m >= params->belly_height_m, NAV_PARAM_INDEX(clearance_min_m)}};

    return first_broken(rules, NAV_RULE_COUNT(rules));
}

static uint32_t check_planning(const nav_params_t *params)
{
    const double cost_cell_m = params->heightmap_cell_m * (double) NAV_CELLS_PER_COST_CELL;
    const double half_heightmap_m = params->heightmap_cell_m * (double) NAV_HEIGHTMAP_SIZE / 2.0;
    const double half_costmap_m = cost_cell_m * (double) NAV_COSTMAP_SIZE / 2.0;
    const double margin_m = params->costmap_recenter_margin_m;
    const double arc_poses = params->tree_arc_length_m / params->pose_spacing_m;
    const double turn_poses = NAV_PI / params->pose_spacing_rad;
    const double outer_step = ((double) NAV_TREE_ARCS - 1.0) / 2.0;
    const nav_rule_t rules[] = {
        {margin_m < (half_heightmap_m + cost_cell_m), NAV_PARAM_INDEX(costmap_recenter_margin_m)},
        /* a map just recentred must not ask for it again */
        {margin_m >= (half_costmap_m - cost_cell_m), NAV_PARAM_INDEX(costmap_recenter_margin_m)},
        {(outer_step * params->tree_heading_step_rad) >= (NAV_PI / 2.0),
         NAV_PARAM_INDEX(tree_heading_step_rad)},
        {arc_poses > (double) NAV_ARC_POSES_MAX, NAV_PARAM_INDEX(pose_spacing_m)},
        {turn_poses > (double) NAV_ARC_POSES_MAX, NAV_PARAM_INDEX(pose_spacing_rad)},
        {params->execute_length_m > params->tree_arc_length_m, NAV_PARAM_INDEX(execute_length_m)}};

    return first_broken(rules, NAV_RULE_COUNT(rules));
}

static uint32_t check_ranges(const nav_params_t *params)
{
    const void *source = params;
    double values[NAV_PARAM_COUNT];
    void *target = values;
    uint32_t refused = NAV_PARAMS;

    (void) memcpy(target, source, sizeof(values));
    for (uint32_t index = 0U; index < NAV_PARAMS; index++)
    {
        const nav_param_def_t *def = &nav_param_defs[index];
        /* a NaN is in no range */
        const bool is_valid =
            (values[index] >= def->min_value) && (values[index] <= def->max_value);

        if ((!is_valid) && (refused == NAV_PARAMS))
        {
            refused = index;
        }
    }
    return refused;
}

static uint32_t check_conflicts(const nav_params_t *params)
{
    const uint32_t refused[3] = {check_whole_numbers(params), check_geometry(params),
                                 check_planning(params)};
    uint32_t index = NAV_PARAMS;

    for (uint32_t group = 0U; group < 3U; group++)
    {
        if (refused[group] < index)
        {
            index = refused[group];
        }
    }
    return index;
}

#define NAV_PARAM_DEFAULT(name, value, low, high, unit, doc) params->name = (value);

void nav_params_default(nav_params_t *params)
{
    if (params != NULL)
    {
        NAV_PARAM_TABLE(NAV_PARAM_DEFAULT)
    }
}

nav_status_t nav_params_check(const nav_params_t *params, uint32_t *index)
{
    nav_status_t status = NAV_OK;

    if ((params == NULL) || (index == NULL))
    {
        status = NAV_NULL_POINTER;
    }
    else
    {
        *index = check_ranges(params);
        if (*index < NAV_PARAMS)
        {
            status = NAV_PARAMETER_RANGE;
        }
        else
        {
            *index = check_conflicts(params);
            if (*index < NAV_PARAMS)
            {
                status = NAV_PARAMETER_CONFLICT;
            }
        }
    }
    return status;
}
