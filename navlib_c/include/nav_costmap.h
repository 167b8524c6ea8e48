/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_costmap.h
 * @brief 50 x 50 m of traversal costs: plane fits over rover-sized patches, zones, ACE's failures.
 *
 * Row 0 is south, column 0 west. The costmap's grid lines are the heightmap's: a costmap cell is
 * NAV_CELLS_PER_COST_CELL heightmap cells wide. It is recentred only when the rover nears its edge.
 * Cells that the heightmap no longer covers keep what was last known of them.
 */
#ifndef NAV_COSTMAP_H
#define NAV_COSTMAP_H

#include "nav_arc.h"
#include "nav_heightmap.h"
#include "nav_kioz.h"

#define NAV_COST_CELL_FIELDS(S, A, N, M)                                                           \
    S(float, plane_z_site_m, "m", "height of the fitted plane at the centre, down")                \
    S(float, plane_dz_dx, "1", "plane: z down per metre north")                                    \
    S(float, plane_dz_dy, "1", "plane: z down per metre east")                                     \
    S(float, tilt_rad, "rad", "tilt of the plane")                                                 \
    S(float, roughness_m2, "m^2", "mean squared residual to the plane")                            \
    S(float, cost_s_per_m, "s/m", "time and terrain, per metre driven")                            \
    S(uint32_t, ace_cycle, "1", "analysis in which ACE last failed here")                          \
    S(uint8_t, ace_failed_headings, "1",                                                           \
      "bit k: ACE failed last along heading k * 45 deg or back")                                   \
    S(uint8_t, ace_reason, "1", "nav_reason_t of its last failure")                                \
    S(uint8_t, terrain_reason, "1", "nav_reason_t: tilt, unexpected, or none")                     \
    S(uint8_t, is_known, "1", "1 when a plane has been fitted")                                    \
    S(uint8_t, is_forbidden, "1", "1 when zones forbid it")                                        \
    S(uint8_t, barred_headings, "1", "bit k: obstacles under a rover that stands so")              \
    A(uint8_t, pad_0, 2, "1", "zero")                                                              \
    S(uint32_t, belly_obstacles, "1", "bit 5 * row + column: too high for the belly")              \
    S(uint32_t, wheel_obstacles, "1", "the same: too high or too deep for a wheel")
NAV_RECORD(NAV_COST_CELL_FIELDS, nav_cost_cell_t);

#define NAV_COSTMAP_FIELDS(S, A, N, M)                                                             \
    S(double, cell_m, "m", "side of a cell")                                                       \
    S(int32_t, origin_row, "1", "global index of the southernmost row, in costmap cells")          \
    S(int32_t, origin_col, "1", "global index of the westernmost column")                          \
    S(uint32_t, is_placed, "1", "0 until first centred")                                           \
    S(uint32_t, cycle, "1", "analyses so far")                                                     \
    M(nav_cost_cell_t, cells, NAV_COSTMAP_CELLS, "row by row from south")
NAV_RECORD(NAV_COSTMAP_FIELDS, nav_costmap_t);

/** Sums over the known heightmap cells of a patch; u, v count cells north and east of its middle. */
typedef struct
{
    double count;
    double u;
    double v;
    double z;
    double uu;
    double uv;
    double vv;
    double uz;
    double vz;
    double zz;
} nav_moments_t;

/**
 * What is kept from one update to the next, so that only what changed is computed again. Blocks and
 * strips stand as in nav_surface_state_t.
 */
typedef struct
{
    nav_moments_t blocks[NAV_BLOCKS];
    nav_moments_t strips[NAV_BLOCKS];      /* a patch wide, a block high */
    uint32_t fitted_at[NAV_COSTMAP_CELLS]; /* surface_count when the cell was last recomputed */
    double z_reference_m;   /* heights are taken from here, to keep their squares small */
    uint32_t surface_count; /* of the last surface seen; 0: none */
    int32_t origin_row;     /* of the map in the last update */
    int32_t origin_col;
} nav_costmap_state_t;

/** Empties the map and takes its cell size. */
void nav_costmap_init(nav_costmap_t *map, const nav_params_t *params);

/**
 * Recentres the map on the position if it is nearer than costmap_recenter_margin_m to the edge, or
 * not placed yet. Kept cells keep their content, new ones are unknown.
 * @return true when it was recentred
 */
bool nav_costmap_recenter(nav_costmap_t *map,
                          const nav_params_t *params,
                          double x_site_m,
                          double y_site_m);

/**
 * Recomputes the cells that lie wholly on the surface. A recomputed cell with too little known ground in
 * its patch is unknown, whatever it was before: so expired ground is forgotten. What lies off the surface
 * counts as unknown. Only cells are recomputed in whose patch the surface changed since the last update;
 * the outcome is that of recomputing all. An empty state makes it recompute all.
 */
void nav_costmap_update(nav_costmap_t *map,
                        nav_costmap_state_t *state,
                        const nav_params_t *params,
                        const nav_surface_t *surface,
                        const nav_surface_state_t *changes);

/**
 * Begins a cycle: adds one to cycle, opens cells closed by ACE for longer than ace_feedback_cycles, and
 * applies the zones with the margin to all cells.
 */
void nav_costmap_mark(nav_costmap_t *map,
                      const nav_params_t *params,
                      const nav_kioz_t *kioz,
                      double zone_margin_m);

/** Index of the cell a position falls in. @return false, *index = 0, outside the map */
bool nav_costmap_find(const nav_costmap_t *map, double x_site_m, double y_site_m, uint32_t *index);

/**
 * The reason why a cell is infinite for planning round terrain and/or zones; NONE when it is not. ACE
 * makes a cell infinite by failing along every heading.
 */
nav_reason_t nav_costmap_reason(const nav_cost_cell_t *cell, bool use_terrain, bool use_zones);

/** The heading nearest to a yaw. */
uint32_t nav_costmap_heading(double yaw_rad);

/**
 * Headings along which a way over a cell is dearer, a bit each: those along which ACE failed last, and
 * those along which obstacles stand in the way.
 */
uint32_t nav_costmap_barred(const nav_cost_cell_t *cell);

/** Feeds back the verdict of ACE on a pose, for the nearest heading over its cell. */
void nav_costmap_feedback(nav_costmap_t *map, const nav_pose2_t *pose, nav_reason_t reason);

/** Opens every cell closed by ACE. */
void nav_costmap_clear_feedback(nav_costmap_t *map);

#endif
