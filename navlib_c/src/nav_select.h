/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_select.h
 * @brief Private to Navlib: selects the path to drive from the tree.
 */
#ifndef NAV_SELECT_H
#define NAV_SELECT_H

#include "nav_tree.h"

/**
 * Ranks all candidates, then tests them from the cheapest until one passes what its mode demands:
 * Unguarded and Guarded test the cheapest path only (zones; zones and terrain), Avoid KOZ and Avoid
 * All go on to the next, then to the last resorts, and do so again under the leave limits.
 * Fills out; sends nothing.
 */
void nav_select_path(nav_tree_t *tree,
                     const nav_tree_scene_t *scene,
                     const nav_select_arc_in_t *in,
                     nav_select_arc_out_t *out);

#endif
