/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_relief.h
 * @brief Highest and lowest ground of each costmap cell against the plane fitted there, and how high a
 * ball as large as a wheel rests over each heightmap cell.
 *
 * ACE asks it first: where even the highest and lowest ground of the cells around a wheel or under the
 * belly is harmless, and where a ball rests low enough, it need not look closer.
 */
#ifndef NAV_RELIEF_H
#define NAV_RELIEF_H

#include "nav_costmap.h"

/** Of one costmap cell; both heights along z, up, and 0 when is_whole is 0. */
typedef struct
{
    float above_m;     /* of the highest heightmap cell above the plane */
    float below_m;     /* of the lowest; negative under the plane */
    uint32_t is_whole; /* 1 when the cell has a plane and all its heightmap cells are known */
} nav_relief_cell_t;

typedef struct
{
    nav_relief_cell_t cells[NAV_COSTMAP_CELLS]; /* in the order of the costmap's */
    /* of the surface's cells, down: the highest that the lowest point of a wheel can stand whose hub is
     * over one of four neighbours or between them, of their four numbers the least;
     * -NAV_SURFACE_UNKNOWN_M where not all ground nearby is known */
    float rest_z_site_m[NAV_HEIGHTMAP_CELLS];
    uint32_t surface_count; /* of the last surface that balls rested on; 0: none */
    int32_t origin_row;     /* its */
    int32_t origin_col;
} nav_relief_t;

/**
 * Takes the relief of the costmap cells that lie wholly on the surface from it and from their planes: of
 * those only that the last update of the costmap has recomputed; the others keep what they have.
 */
void nav_relief_update(nav_relief_t *relief,
                       const nav_costmap_t *costmap,
                       const nav_costmap_state_t *state,
                       const nav_surface_t *surface);

/**
 * Lets balls of the wheels' radius rest on the surface: anew only near blocks that changed since the last
 * one; the outcome is that of doing so on all of it. An empty relief makes it do so. The radius is that
 * of the call before.
 */
void nav_relief_rest(nav_relief_t *relief,
                     const nav_surface_t *surface,
                     const nav_surface_state_t *changes,
                     double radius_m);

#endif
