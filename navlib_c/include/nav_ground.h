/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ground.h
 * @brief Used by ACE alone: the surface seen from the local ground plane under one pose.
 *
 * Plane frame: origin on the plane below the pose, u forward and v right in the plane, eta up along
 * its normal. The foot of a point is the place of the plane vertically below it: on a slope a point
 * eta above the plane stands eta * tan(slope) up the slope from where its foot is. "Above" is the
 * vertical height over the foot, eta / cos(slope).
 *
 * The grid is crossed in lines: lines of heightmap cells along the axis that the heading crosses more
 * steeply (the line's number is the major index), and cells along a line (the minor index).
 */
#ifndef NAV_GROUND_H
#define NAV_GROUND_H

#include "nav_arc.h"
#include "nav_relief.h"

/** Height of what is not known. */
#define NAV_ETA_NONE 1.0e9

/** How far above or below a hub or the belly's ground level what stands in its box is looked for: boxes
 * are scanned wider by this times slope and lean. */
#define NAV_STAND_MAX_M 0.8

/** Rows and columns of the grid. */
#define NAV_GROUND_AXES 2

typedef struct
{
    double low_m;
    double high_m;
} nav_interval_t;

/** A rectangle in the plane, along the heading. */
typedef struct
{
    double u_m;
    double v_m;
    double half_u_m;
    double half_v_m;
} nav_box_t;

/** How lines of the grid lie across the heading. */
typedef struct
{
    int32_t step_major; /* in z_site_m, to the same cell of the next line */
    int32_t step_minor; /* to the next cell of the line */
    double major;       /* of the pose, in cells, cell centres at whole numbers */
    double minor;
    double major_per_u; /* cells per metre */
    double major_per_v;
    double minor_per_u;
    double minor_per_v;
    double u_per_major; /* from line to line along the heading */
    double minor_per_major;
    double minor_across;  /* along one line, per metre of v */
    double u_per_minor;   /* along one line */
    double plane_major_m; /* z of the plane, down, from line to line, */
    double plane_minor_m; /* from cell to cell of a line, */
    double plane_first_m; /* and in the first cell of the first line */
} nav_lanes_t;

/** The local ground plane along the heading, and where the pose is on the surface. */
typedef struct
{
    const nav_surface_t *surface;
    const nav_costmap_t *costmap;
    const nav_relief_t *relief;
    double rise_forward;                /* up per metre along the heading */
    double rise_right;                  /* up per metre to its right */
    double forward_xy[NAV_GROUND_AXES]; /* SITE north, east per metre of u */
    double right_xy[NAV_GROUND_AXES];   /* SITE north, east per metre of v */
    double u_of_xy[NAV_GROUND_AXES];    /* and back */
    double v_of_xy[NAV_GROUND_AXES];
    double forward_up; /* up per metre of u */
    double right_up;   /* up per metre of v */
    double cos_slope;
    double z_site_m; /* of the plane at the pose, down */
    double dz_dx;
    double dz_dy;
    double row; /* of the pose, in cells, cell centres at whole numbers */
    double col;
    double cells_per_m;
    int32_t cost_row; /* heightmap cells from the costmap's first row to the surface's */
    int32_t cost_col;
    double tile_north_m; /* of the middle of the first costmap cell from the pose */
    double tile_east_m;
    double tile_side_m; /* of a costmap cell */
    nav_lanes_t lanes;
} nav_ground_t;

/** Whole numbers first..last; none when last < first. */
typedef struct
{
    int32_t first;
    int32_t last;
} nav_indices_t;

/** A stretch of an axis of the grid, in cells, cell centres at whole numbers. */
typedef struct
{
    double low;
    double high;
} nav_axis_range_t;

/** A rectangle along the grid. */
typedef struct
{
    nav_axis_range_t rows;
    nav_axis_range_t cols;
} nav_upright_t;

/** A box of costmap cells, by row and column. */
typedef struct
{
    nav_indices_t rows;
    nav_indices_t cols;
} nav_cost_box_t;

/** Heights of the ground of one costmap cell over the plane. */
typedef struct
{
    nav_interval_t above; /* vertical */
    bool is_whole;        /* false: not all of it is known, and the heights hold for nothing */
} nav_tile_t;

/** Places the frame on the plane fitted at the pose. @return false where there is none */
bool nav_ground_place(nav_ground_t *ground,
                      const nav_surface_t *surface,
                      const nav_costmap_t *costmap,
                      const nav_relief_t *relief,
                      const nav_pose2_t *pose);

/** Height over the plane of the cell nearest to a foot, along the normal; -NAV_ETA_NONE off the map. */
double nav_ground_eta_m(const nav_ground_t *ground, double foot_u_m, double foot_v_m);

/** Whole numbers within [low, high]; none where an end is no index. */
nav_indices_t nav_ground_between(double low, double high);

/** The upright rectangle around a box of feet, in cells of the surface; maybe off the map. */
nav_upright_t nav_ground_upright(const nav_ground_t *ground, const nav_box_t *box);

/**
 * Costmap cells that hold a heightmap cell in the upright rectangle around a box of feet.
 * @return false when some of it lies off the surface
 */
bool nav_ground_cost_box(const nav_ground_t *ground, const nav_box_t *box, nav_cost_box_t *cells);

/** How far north of the pose the middle of a row of costmap cells is. */
double nav_ground_tile_north_m(const nav_ground_t *ground, int32_t cost_row);

/** How far east of the pose the middle of a column of costmap cells is. */
double nav_ground_tile_east_m(const nav_ground_t *ground, int32_t cost_col);

/** The ground of a costmap cell of nav_ground_cost_box, given where its middle is from the pose. */
nav_tile_t nav_ground_tile(
    const nav_ground_t *ground, int32_t cost_row, int32_t cost_col, double north_m, double east_m);

/**
 * Between which heights over the plane all ground lies whose foot is in a box: from whole costmap
 * cells, so wider than need be.
 * @return false when some of it is unknown or off the map
 */
bool nav_ground_range(const nav_ground_t *ground, const nav_box_t *box, nav_interval_t *above);

#endif
