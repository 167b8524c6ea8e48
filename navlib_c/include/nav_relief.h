/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_relief.h
 * @brief Highest and lowest ground of each costmap cell against the plane fitted there.
 *
 * ACE asks it first: where even the highest and lowest ground of the cells around a wheel or under the
 * belly is harmless it need not look closer.
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
} nav_relief_t;

/**
 * Takes the relief of the costmap cells that lie wholly on the surface from it and from their planes: of
 * those only that the last update of the costmap has recomputed; the others keep what they have.
 */
void nav_relief_update(nav_relief_t *relief,
                       const nav_costmap_t *costmap,
                       const nav_costmap_state_t *state,
                       const nav_surface_t *surface);

#endif
