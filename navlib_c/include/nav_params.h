/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_params.h
 * @brief Every parameter of Navlib: one table makes the struct, the defaults, the checks, the listing.
 *
 * Sources: [U] geometry of NASA's M2020 URDF; [S] SIM, IEEE Aerospace 2020; [E] published ENav
 * numbers; [C] chosen here, with the reason in the row. None of [C] is flight data.
 */
#ifndef NAV_PARAMS_H
#define NAV_PARAMS_H

#include "nav_types.h"

/** X(name, default, minimum, maximum, "unit", "meaning and source") */
#define NAV_PARAM_TABLE(X)                                                                         \
    X(heightmap_cell_m, 0.1, 0.05, 0.2, "m", "side of a heightmap cell [S]")                       \
    X(heightmap_expiry_s, 3600.0, 1.0, 1.0e9, "s",                                                 \
      "age at which a cell becomes unknown [C]: longer than a 30 m map lasts at 100 m/h")          \
    X(surface_fill_neighbors, 3.0, 1.0, 9.0, "1",                                                  \
      "known cells among the 8 around an unimaged cell that make it known to ACE and costmap "     \
      "[C]: closes the gaps between image rows 6 to 9 m away")                                     \
    X(costmap_patch_cells, 5.0, 3.0, 7.0, "1",                                                     \
      "side of the plane-fit patch in costmap cells, odd [C]: 2.5 m, the size of the rover")       \
    X(costmap_patch_known_min, 0.3, 0.05, 1.0, "1",                                                \
      "share of a patch that must be known for a plane fit, else the cell is unknown [C]")         \
    X(costmap_recenter_margin_m, 16.0, 1.0, 24.0, "m",                                             \
      "recentre when the rover is nearer than this to the edge [C]: the heightmap still fits")     \
    X(cost_tilt_s_per_m_rad, 60.0, 0.0, 1.0e4, "s/(m rad)",                                        \
      "weight of tilt [C]: 10 deg cost as much as 0.4 m more to drive")                            \
    X(cost_roughness_s_per_m3, 4000.0, 0.0, 1.0e6, "s/m^3",                                        \
      "weight of the mean squared residual [C]: 5 cm rms cost as much as 0.4 m more to drive")     \
    X(cost_unknown_factor, 1.5, 1.0, 100.0, "1",                                                   \
      "unknown ground against known flat ground [C]: finite, so that goals out of sight attract")  \
    X(cost_barred_factor, 30.0, 1.0, 1000.0, "1",                                                  \
      "a way over an obstacle that does not fit under the rover, against plain ground [C]: a "     \
      "detour of 29 m for a metre of it; finite, for ACE may find a way")                          \
    X(barred_growth_m, 0.1, 0.0, 1.0, "m",                                                         \
      "growth of the footprint that bars ways [C]: with these two it agrees best with ACE")        \
    X(barred_margin_m, 0.04, 0.0, 0.2, "m",                                                        \
      "height by which an obstacle bars a way before it breaks a limit of ACE [C]: wheels on "     \
      "uneven ground lower the belly")                                                             \
    X(ace_feedback_cycles, 50.0, 0.0, 1000.0, "1",                                                 \
      "analyses after which ACE's failures in a cell are forgotten [C]: enough to look for a way " \
      "elsewhere within the costmap")                                                              \
    X(speed_max_m_per_s, 0.042, 0.001, 1.0, "m/s", "speed of the fastest wheel [E]")               \
    X(steering_rate_rad_per_s, 0.0872664626, 0.001, 10.0, "rad/s",                                 \
      "rate of the steering actuators [C]: 5 deg/s")                                               \
    X(tree_arc_length_m, 3.0, 0.5, 6.0, "m", "length of an arc of the tree [E]")                   \
    X(tree_heading_step_rad, 0.2094395102, 0.01, 0.4, "rad",                                       \
      "heading change between neighbouring arcs [C]: 12 deg, so +/-60 deg over 3 m")               \
    X(pose_spacing_m, 0.25, 0.05, 1.0, "m", "distance of ACE poses along an arc [E]")              \
    X(pose_spacing_rad, 0.1570796327, 0.02, 1.0, "rad",                                            \
      "distance of ACE poses in a turn in place [C]: 9 deg move the front wheels 0.25 m")          \
    X(execute_length_m, 1.0, 0.1, 6.0, "m", "part of a path that is driven before replanning [E]") \
    X(execute_turn_rad, 0.5235987756, 0.05, 3.2, "rad",                                            \
      "part of a turn that is driven, in whole steps between the turns of the tree [E]: 30 deg "   \
      "hold one of 25.7 deg")                                                                      \
    X(keep_path_min_m, 3.5, 0.0, 12.0, "m",                                                        \
      "length from which the rest of the selected path competes with new paths [C]: two more "     \
      "metres of it, then new ones reach further")                                                 \
    X(ace_budget_poses, 4000.0, 1.0, 1.0e6, "1",                                                   \
      "ACE poses one call may evaluate [C]: 40 to 80 s of a RAD750")                               \
    X(negative_progress_max_m, 8.0, 0.0, 100.0, "m",                                               \
      "a path may end this much further from the goal than it starts [C]")                         \
    X(uncertainty_growth, 0.03, 0.0, 1.0, "m/m",                                                   \
      "growth of position uncertainty along a path [C]")                                           \
    X(uncertainty_position_max_m, 0.05, 0.0, 2.0, "m",                                             \
      "bound of that growth [C]: drift of two metres; every metre is planned again with a fresh "  \
      "estimate")                                                                                  \
    X(uncertainty_yaw_growth_rad_per_m, 0.0043633231, 0.0, 1.0, "rad/m",                           \
      "growth of yaw uncertainty along a path [C]: 0.25 deg/m")                                    \
    X(uncertainty_yaw_max_rad, 0.0087266463, 0.0, 1.0, "rad", "bound of that growth [C]: 0.5 deg") \
    X(clearance_min_m, 0.35, 0.0, 1.0, "m",                                                        \
      "least belly clearance [S]: nominal 0.60 less the 25 cm rock that SIM calls a hazard")       \
    X(tilt_max_rad, 0.5235987756, 0.05, 1.2, "rad",                                                \
      "largest tilt [C]: 30 deg, so that 20 deg slopes with rocks can be driven")                  \
    X(rocker_max_rad, 0.1431169987, 0.02, 1.0, "rad",                                              \
      "largest rocker angle: 8.2 deg, that of 46 cm under one front wheel [S]")                    \
    X(bogie_max_rad, 0.5235987756, 0.05, 1.2, "rad",                                               \
      "largest bogie angle [C]: 30 deg; 35 cm under a middle wheel makes 25.5")                    \
    X(wheel_drop_max_m, 0.35, 0.02, 1.0, "m", "largest wheel drop [S]")                            \
    X(leave_length_m, 1.0, 0.0, 6.0, "m",                                                          \
      "a rover for which no path passes may drive this far within the leave limits [C]: it must "  \
      "be able to get away from where it slipped to")                                              \
    X(leave_clearance_min_m, 0.30, 0.0, 1.0, "m",                                                  \
      "leave limit [C]: 5 cm above what operators call a fault")                                   \
    X(leave_tilt_max_rad, 0.5759586532, 0.05, 1.3, "rad", "leave limit [C]: 33 deg; fault at 35")  \
    X(leave_rocker_max_rad, 0.1919862177, 0.02, 1.0, "rad",                                        \
      "leave limit [C]: 11 deg; fault at 12")                                                      \
    X(leave_bogie_max_rad, 0.6108652382, 0.05, 1.3, "rad", "leave limit [C]: 35 deg; fault at 38") \
    X(leave_wheel_drop_max_m, 0.42, 0.02, 1.0, "m", "leave limit [C]: 3 cm below a fault")         \
    X(wheel_unknown_max, 0.5, 0.0, 1.0, "1",                                                       \
      "share of a wheel box that may be unknown [C]: shadows of stones behind which it stands")    \
    X(belly_unknown_max, 0.5, 0.0, 1.0, "1", "share of the belly box that may be unknown [C]")     \
    X(wheel_radius_m, 0.26288, 0.05, 0.5, "m", "[U]")                                              \
    X(wheel_width_m, 0.33, 0.01, 1.0, "m", "[U]")                                                  \
    X(front_x_m, 1.18502, 0.1, 5.0, "m", "hub of the front wheel in ROVER [U]")                    \
    X(front_y_m, 1.0625, 0.1, 5.0, "m", "hub of the front wheel, distance from the middle [U]")    \
    X(middle_x_m, 0.0, -1.0, 1.0, "m", "hub of the middle wheel in ROVER [U]")                     \
    X(middle_y_m, 1.1845, 0.1, 5.0, "m", "hub of the middle wheel, distance from the middle [U]")  \
    X(rear_x_m, -1.07498, -5.0, -0.1, "m", "hub of the rear wheel in ROVER [U]")                   \
    X(rear_y_m, 1.0625, 0.1, 5.0, "m", "hub of the rear wheel, distance from the middle [U]")      \
    X(rocker_pivot_x_m, 0.30402, -2.0, 2.0, "m", "[U]")                                            \
    X(rocker_pivot_height_m, 0.89288, 0.1, 3.0, "m", "above the flat ground [U]")                  \
    X(bogie_pivot_x_m, -0.44998, -3.0, 3.0, "m", "[U]")                                            \
    X(bogie_pivot_height_m, 0.66288, 0.1, 3.0, "m", "above the flat ground [U]")                   \
    X(belly_front_x_m, 0.90, -5.0, 5.0, "m", "front of the belly box [C]: outline not published")  \
    X(belly_rear_x_m, -1.18, -5.0, 5.0, "m", "rear of the belly box [C]: outline not published")   \
    X(belly_half_width_m, 0.775, 0.05, 3.0, "m", "half width of the belly box [C]")                \
    X(belly_height_m, 0.60, 0.1, 3.0, "m",                                                         \
      "belly pan above the flat ground [C]: from a landing "                                       \
      "rule of 60 cm")                                                                             \
    X(product_level, 0.0, 0.0, 2.0, "1",                                                           \
      "data products sent: 0 inputs and outputs, 1 also the tree, 2 also the grids [C]")

#define NAV_PARAM_MEMBER(name, value, low, high, unit, doc) double name;
typedef struct
{
    NAV_PARAM_TABLE(NAV_PARAM_MEMBER)
} nav_params_t;

typedef struct
{
    const char *name;
    double default_value;
    double min_value;
    double max_value;
    const char *unit;
    const char *doc;
} nav_param_def_t;

#define NAV_PARAM_ONE(name, value, low, high, unit, doc) +1
#define NAV_PARAM_COUNT (0 NAV_PARAM_TABLE(NAV_PARAM_ONE))

/** One row per parameter, in the order of the struct. */
extern const nav_param_def_t nav_param_defs[NAV_PARAM_COUNT];

/** Writes the default of every parameter. Does nothing on a null pointer. */
void nav_params_default(nav_params_t *params);

/**
 * Checks every parameter against its range and against the others.
 * @param index  the first parameter refused, or NAV_PARAM_COUNT; may not be null
 * @return NAV_OK, NAV_NULL_POINTER, NAV_PARAMETER_RANGE, NAV_PARAMETER_CONFLICT
 */
nav_status_t nav_params_check(const nav_params_t *params, uint32_t *index);

#endif
