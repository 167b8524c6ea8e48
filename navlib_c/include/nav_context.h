/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_context.h
 * @brief All state of Navlib, owned by the caller. Hosts may read it, never write it.
 */
#ifndef NAV_CONTEXT_H
#define NAV_CONTEXT_H

#include "nav_tree.h"

/** Marks a context that nav_init has accepted; anything else is refused. */
#define NAV_CONTEXT_MAGIC 0x4E415634

typedef struct
{
    uint32_t magic;
    uint32_t is_mapped;   /* 1 after the first merged chunk */
    uint32_t is_analyzed; /* 1 after the first analysis */
    uint32_t image_id;    /* of the last chunk */
    uint32_t chunk_next;  /* chunk expected next of that image; 0: a new image */
    uint32_t chunk_count; /* of that image */
    double time_s;        /* of the last call other than process_disparity */
    nav_params_t params;
    nav_vehicle_t vehicle;
    nav_kioz_t kioz;
    nav_heightmap_t heightmap;
    nav_surface_t surface;
    nav_surface_state_t surface_state;
    nav_costmap_t costmap;
    nav_costmap_state_t costmap_state;
    nav_relief_t relief;
    nav_rover_footprint_t footprint;
    nav_ace_work_t ace_work;
    nav_global_t global;
    nav_tree_t tree;
    nav_tree_shapes_t tree_shapes;
} nav_ctx_t;

#endif
