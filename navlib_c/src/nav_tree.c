/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_tree.c
 * @brief Shapes of the tree of candidate paths.
 */
#include "nav_tree.h"

#define ARCS ((uint32_t) NAV_TREE_ARCS)

void nav_tree_init(const nav_params_t *params, nav_tree_shapes_t *shapes)
{
    const nav_pose2_t origin = {0.0, 0.0, 0.0};
    for (uint32_t k = 0U; k < ARCS; k++)
    {
        const double step = (double) k - (0.5 * (double) (ARCS - 1U));
        const nav_arc_t arc = {params->tree_arc_length_m, step * params->tree_heading_step_rad};
        shapes->heading_change_rad[k] = arc.heading_change_rad;
        shapes->pose_count = nav_arc_pose_count(params, &arc);
        for (uint32_t place = 0U; place < shapes->pose_count; place++)
        {
            const nav_pose2_t pose =
                nav_arc_pose(&origin, &arc, (double) (place + 1U) / (double) shapes->pose_count);
            shapes->forward_m[k][place] = pose.x_m;
            shapes->right_m[k][place] = pose.y_m;
        }
    }
}
