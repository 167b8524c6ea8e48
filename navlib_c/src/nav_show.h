/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_show.h
 * @brief Private to Navlib: what of the selected path is driven, shown and kept.
 */
#ifndef NAV_SHOW_H
#define NAV_SHOW_H

#include "nav_walk.h"

/** Describes the path selected in out, and keeps in the tree what is left of it for the next call. */
void nav_show_path(const nav_request_t *request, nav_tree_t *tree, nav_select_arc_out_t *out);

#endif
