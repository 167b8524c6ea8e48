/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_heightmap.h
 * @brief 30 x 30 m of heights around the rover, and the surface that costmap and ACE read.
 *
 * A cell has a global index, floor(coordinate / cell size), and is stored at that index modulo the
 * map size: rolling the map moves no data. The height of a cell is the mean z of the points of the
 * newest image that fell in it (SIM section 3); points of one image accumulate, in any number of
 * chunks; a newer image overwrites the cell; a cell older than the expiry time is unknown.
 */
#ifndef NAV_HEIGHTMAP_H
#define NAV_HEIGHTMAP_H

#include "nav_params.h"

typedef struct
{
    double z_sum_m;       /* of the points of the newest image */
    double time_s;        /* of the newest image */
    uint32_t image_id;    /* of the newest image */
    uint32_t point_count; /* 0: unknown; saturates, later points are left out */
} nav_height_cell_t;

/**
 * Blocks along one side: squares of NAV_CELLS_PER_COST_CELL cells, on the lines of the costmap, of which
 * the map touches this many at most. A block stands in tables at its global index (that of its cells
 * divided by their number, rounded down) modulo this.
 */
#define NAV_BLOCKS_SIDE ((NAV_HEIGHTMAP_SIZE / NAV_CELLS_PER_COST_CELL) + 1)
#define NAV_BLOCKS (NAV_BLOCKS_SIDE * NAV_BLOCKS_SIDE)

/** Where a row or a column begins in storage: a cell's index is the sum of its row's and its column's. */
typedef struct
{
    int32_t cell;  /* in cells of a map; negative outside */
    int32_t block; /* in tables by block */
} nav_line_t;

typedef struct
{
    double cell_m;
    int32_t origin_row; /* global index of the southernmost row */
    int32_t origin_col; /* global index of the westernmost column */
    uint32_t is_placed; /* 0 until first centred */
    nav_height_cell_t cells[NAV_HEIGHTMAP_CELLS];
    uint8_t is_changed[NAV_BLOCKS];          /* 1 when the block changed since the last surface */
    nav_line_t rows[NAV_HEIGHTMAP_SIZE + 1]; /* what merging works with, from the map's corner; */
    nav_line_t cols[NAV_HEIGHTMAP_SIZE + 1]; /* the last one stands for all outside */
} nav_heightmap_t;

/** Surface height of an unknown cell: nothing on Mars is this deep. */
#define NAV_SURFACE_UNKNOWN_M 1.0e9F

/** The heightmap unwrapped: row 0 is south, column 0 west; small gaps closed; z down, SITE. */
#define NAV_SURFACE_FIELDS(S, A, N, M)                                                             \
    S(double, time_s, "s", "when it was made")                                                     \
    S(double, cell_m, "m", "side of a cell")                                                       \
    S(int32_t, origin_row, "1", "global index of the southernmost row")                            \
    S(int32_t, origin_col, "1", "global index of the westernmost column")                          \
    A(float, z_site_m, NAV_HEIGHTMAP_CELLS, "m", "down, row by row from south; 1e9 where unknown")
NAV_RECORD(NAV_SURFACE_FIELDS, nav_surface_t);

/** What lies in a block before gaps are closed. */
typedef struct
{
    double oldest_s;    /* time of its oldest height */
    uint32_t gap_count; /* cells of unknown height */
} nav_surface_block_t;

/** Cells along one side of the heightmap with a border of unknown ones. */
#define NAV_RAW_SIZE (NAV_HEIGHTMAP_SIZE + 2)

/**
 * What is kept from one surface to the next, so that only what changed is made again. Users of a surface
 * that keep results of their own remember surface_count, and renew those for which changed_at is
 * greater.
 */
typedef struct
{
    uint32_t surface_count;          /* surfaces made so far */
    uint32_t changed_at[NAV_BLOCKS]; /* surface_count when the block was last made */
    nav_surface_block_t blocks[NAV_BLOCKS];
    float z_m[NAV_RAW_SIZE * NAV_RAW_SIZE]; /* SITE, unwrapped, before gaps are closed */
} nav_surface_state_t;

/** What became of the points of a chunk; a point for a full cell counts as neither. */
typedef struct
{
    uint32_t merged_count;
    uint32_t outside_count;
} nav_merge_t;

/** Empties the map and takes its cell size. */
void nav_heightmap_init(nav_heightmap_t *map, const nav_params_t *params);

/**
 * Rolls the map so that the given position lies in its middle cell. Cells that leave become unknown;
 * the rest are untouched. Cost: the cells that leave.
 * @return false, and no change, when the position has no global index
 */
bool nav_heightmap_center(nav_heightmap_t *map, double x_site_m, double y_site_m);

/**
 * Merges points given in ROVER at the pose. The points must be finite (the interface has checked).
 * Points outside the map are counted and dropped. Which cell takes a point is decided to 1e-12 cells.
 */
nav_merge_t nav_heightmap_merge(nav_heightmap_t *map,
                                const nav_pose_t *pose,
                                double time_s,
                                uint32_t image_id,
                                const nav_point_t *points,
                                uint32_t point_count);

/**
 * Makes the surface: means, expired cells unknown, gaps with enough known neighbours closed. Only blocks
 * are made anew whose map changed since the last surface, by points, by expiry, by rolling, and those
 * beside them; the outcome is that of making all. Surface and state stay together: both are those of the
 * call before, or the state is empty.
 */
void nav_heightmap_surface(nav_heightmap_t *map,
                           const nav_params_t *params,
                           double time_s,
                           nav_surface_state_t *state,
                           nav_surface_t *surface);

/**
 * Moves heights that lie over a surface, width in a row, to where they lie over one whose corner is that
 * many cells further north and east. Cells that come hold anything.
 * @return false, and nothing moved, when none stays
 */
bool nav_heightmap_follow(float *z_m, int32_t width, int64_t rows, int64_t cols);

#endif
