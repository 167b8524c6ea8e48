/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_passage.h
 * @brief Which ways across a costmap cell are barred by something under the belly or the wheels.
 *
 * A plane fit does not say whether a rover gets past a rock. So the rover's footprint is laid over each
 * cell, with its origin on the middle of the cell, along each of NAV_HEADINGS headings: a heading is
 * barred when ground under the belly stands higher above the plane than clearance_min_m allows, or
 * ground under a wheel differs by more than wheel_drop_max_m. This only makes ways dearer
 * (cost_barred_factor), for Dijkstra and for the order of paths: whether a pose is safe, ACE decides.
 */
#ifndef NAV_PASSAGE_H
#define NAV_PASSAGE_H

#include "nav_relief.h"

/** Costmap cells around the rover's own that its footprint can touch; beyond, it is cut off. */
#ifndef NAV_PASSAGE_REACH
#define NAV_PASSAGE_REACH 4
#endif
#define NAV_PASSAGE_SIDE ((2 * NAV_PASSAGE_REACH) + 1)

/** A heightmap cell within its costmap cell is a bit: row * NAV_CELLS_PER_COST_CELL + column. */
typedef struct
{
    int32_t row; /* of a costmap cell, from the rover's own */
    int32_t col;
    uint32_t belly[NAV_HEADINGS]; /* the heightmap cells that lie under it */
    uint32_t wheels[NAV_HEADINGS];
} nav_rover_footprint_cell_t;

/** The footprint as the costmap cells it touches. */
typedef struct
{
    nav_rover_footprint_cell_t cells[NAV_PASSAGE_SIDE * NAV_PASSAGE_SIDE];
    uint32_t count;
} nav_rover_footprint_t;

/** Lays out the footprint, grown by barred_growth_m, from checked parameters. */
void nav_passage_init(const nav_params_t *params, nav_rover_footprint_t *footprint);

/**
 * Finds the obstacles in the costmap cells that the last update of the costmap has recomputed, and
 * the barred headings of all cells. Cells off the surface keep their obstacles.
 */
void nav_passage_update(nav_costmap_t *map,
                        const nav_costmap_state_t *state,
                        const nav_params_t *params,
                        const nav_rover_footprint_t *footprint,
                        const nav_relief_t *relief,
                        const nav_surface_t *surface);

#endif
