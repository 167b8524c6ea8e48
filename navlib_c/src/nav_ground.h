/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_ground.h
 * @brief Private to Navlib: the surface seen from the local ground plane under one pose.
 *
 * Plane frame: origin on the plane below the pose, u forward and v right in the plane, eta up along
 * its normal. The foot of a point is the place of the plane vertically below it: on a slope a point
 * eta above the plane stands eta * tan(slope) up the slope from where its foot is.
 */
#ifndef NAV_GROUND_H
#define NAV_GROUND_H

#include "nav_arc.h"
#include "nav_costmap.h"

/** Height of what is not known. */
#define NAV_ETA_NONE 1.0e9

/** Grid lines of one axis that a line of at most 2.6 m can cross, at the smallest cell size. */
#define NAV_CROSSINGS_MAX 56

/** The axes of the grid. */
#define NAV_GROUND_ROWS 0U
#define NAV_GROUND_COLUMNS 1U

/** The local ground plane along the heading, and where the pose is on the surface. */
typedef struct
{
    const nav_surface_t *surface;
    double rise_forward;  /* up per metre along the heading */
    double rise_right;    /* up per metre to its right */
    double forward_xy[2]; /* SITE north, east per metre of u */
    double right_xy[2];   /* SITE north, east per metre of v */
    double u_of_xy[2];    /* and back */
    double v_of_xy[2];
    double forward_up; /* up per metre of u */
    double right_up;   /* up per metre of v */
    double cos_slope;
    double z_site_m; /* of the plane at the pose, down */
    double dz_dx;
    double dz_dy;
    double row; /* of the pose, in cells, cell centres at whole numbers */
    double col;
    double cells_per_m;
} nav_ground_t;

/** A rectangle in the plane. */
typedef struct
{
    double u_m;
    double v_m;
    double half_u_m;
    double half_v_m;
} nav_box_t;

/** Columns first..last of a row; none when last < first. */
typedef struct
{
    int32_t first;
    int32_t last;
} nav_columns_t;

/** A surface cell in the plane frame. */
typedef struct
{
    double u_m;
    double v_m;
    double eta_m;
} nav_ground_point_t;

/** Places the frame on the plane fitted at the pose. @return false where there is none */
bool nav_ground_place(nav_ground_t *ground,
                      const nav_surface_t *surface,
                      const nav_costmap_t *costmap,
                      const nav_pose2_t *pose);

/** Rows that hold cells whose foot is in the box; may lie off the map. */
nav_columns_t nav_ground_rows(const nav_ground_t *ground, const nav_box_t *box);

/**
 * Cells of a row whose foot is in the box, on the map only.
 * @param outside_count  is raised by the number of cells off the map
 */
nav_columns_t nav_ground_columns(const nav_ground_t *ground,
                                 const nav_box_t *box,
                                 int32_t row,
                                 uint32_t *outside_count);

/** A cell on the map, in the plane frame. @return false where it is unknown */
bool nav_ground_cell(const nav_ground_t *ground,
                     int32_t row,
                     int32_t col,
                     nav_ground_point_t *point);

/** Height above the plane of the bilinear surface over a foot; -NAV_ETA_NONE where unknown. */
double nav_ground_eta_m(const nav_ground_t *ground, double foot_u_m, double foot_v_m);

/** Places of a line on the surface. */
typedef struct
{
    uint32_t count;
    double foot_u_m[NAV_CROSSINGS_MAX];
    double eta_m[NAV_CROSSINGS_MAX];
} nav_crossings_t;

/**
 * The known places, within reach_m of a foot, where a line forward through that foot crosses the grid
 * lines of one axis through cell centres: there the bilinear surface along the line has its corners.
 */
void nav_ground_crossings(const nav_ground_t *ground,
                          uint32_t axis,
                          double foot_u_m,
                          double foot_v_m,
                          double reach_m,
                          nav_crossings_t *crossings);

#endif
