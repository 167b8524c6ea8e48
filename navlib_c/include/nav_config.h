/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_config.h
 * @brief Capacities. They are macros with #ifndef so that proofs and exhaustive tests can shrink them.
 */
#ifndef NAV_CONFIG_H
#define NAV_CONFIG_H

/** Cells along one side of the heightmap: 30 m at 0.1 m. */
#ifndef NAV_HEIGHTMAP_SIZE
#define NAV_HEIGHTMAP_SIZE 300
#endif

/** Cells along one side of the costmap: 50 m at 0.5 m. */
#ifndef NAV_COSTMAP_SIZE
#define NAV_COSTMAP_SIZE 100
#endif

/** Heightmap cells along one side of a costmap cell: the two grids share their lines. */
#ifndef NAV_CELLS_PER_COST_CELL
#define NAV_CELLS_PER_COST_CELL 5
#endif

/** Headings over a costmap cell, evenly spaced from north: forwards and backwards are the same. */
#define NAV_HEADINGS 4

/** Points in one chunk of a point cloud. */
#ifndef NAV_CHUNK_POINTS_MAX
#define NAV_CHUNK_POINTS_MAX 8192
#endif

/** Keep-in and keep-out zones together. */
#ifndef NAV_ZONES_MAX
#define NAV_ZONES_MAX 32
#endif

/** Turns in place at the root of the tree, evenly spaced over the circle. */
#ifndef NAV_TREE_TURNS
#define NAV_TREE_TURNS 14
#endif

/** Arcs that leave each node of the tree. Odd: the middle one is straight. */
#ifndef NAV_TREE_ARCS
#define NAV_TREE_ARCS 11
#endif

/** Poses at which one arc or turn is evaluated. */
#ifndef NAV_ARC_POSES_MAX
#define NAV_ARC_POSES_MAX 64
#endif

/** Points of a path that is shown: a turn and two arcs. */
#ifndef NAV_PATH_POINTS_MAX
#define NAV_PATH_POINTS_MAX 64
#endif

/** Points of the global path that is shown. */
#ifndef NAV_GLOBAL_POINTS_MAX
#define NAV_GLOBAL_POINTS_MAX 256
#endif

/** Wheels: left front, left middle, left rear, right front, right middle, right rear. */
#define NAV_WHEELS 6

/* Derived sizes. */
#define NAV_HEIGHTMAP_CELLS (NAV_HEIGHTMAP_SIZE * NAV_HEIGHTMAP_SIZE)
#define NAV_COSTMAP_CELLS (NAV_COSTMAP_SIZE * NAV_COSTMAP_SIZE)
#define NAV_TREE_PATHS (NAV_TREE_TURNS * NAV_TREE_ARCS * NAV_TREE_ARCS)
#define NAV_TREE_FIRST_ARCS (NAV_TREE_TURNS * NAV_TREE_ARCS)

#if (NAV_HEIGHTMAP_SIZE % NAV_CELLS_PER_COST_CELL) != 0
#error "the heightmap must be a whole number of costmap cells wide"
#endif
#if (NAV_COSTMAP_SIZE * NAV_CELLS_PER_COST_CELL) < NAV_HEIGHTMAP_SIZE
#error "the costmap must be at least as wide as the heightmap"
#endif
#if (NAV_TREE_ARCS % 2) != 1
#error "the number of arcs must be odd"
#endif

#endif
