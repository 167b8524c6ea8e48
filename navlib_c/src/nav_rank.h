/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_rank.h
 * @brief Private to Navlib: costs of the candidates, and their order. Nothing is tested.
 */
#ifndef NAV_RANK_H
#define NAV_RANK_H

#include "nav_walk.h"

/** Index of the rest of the path selected before. */
#define NAV_RANK_KEPT ((uint32_t) NAV_TREE_PATHS)

/** Cost-to-go from the end of a path, and whether it leads away. */
nav_reason_t nav_rank_to_go(const nav_request_t *request, const nav_branch_t *leaf, double *cost_s);

/** Cost of a path whose last arc is the leaf, or the reason of an infinite one. */
nav_reason_t nav_rank_path(const nav_request_t *request,
                           double before_s,
                           const nav_branch_t *leaf,
                           double *cost_s);

/** Cost of an arc from the start alone; NAV_COST_INFINITE with a reason. */
double nav_rank_arc(const nav_request_t *request, const nav_arc_t *arc);

/**
 * Costs of all candidates and first arcs, and the order in which to test the candidates.
 * @return how many candidates there are: those of the tree, and one more if the rover is where the rest
 * of the path selected before begins and the mode looks for more than one path
 */
uint32_t nav_rank_candidates(const nav_request_t *request, nav_tree_t *tree);

#endif
