// SPDX-License-Identifier: Apache-2.0
#include "nav_scene.hpp"

extern "C"
{
#include "nav_arc.h"
}

namespace
{

TEST(Tree, its_shapes_are_the_poses_of_its_arcs_from_the_origin)
{
    Scene scene;
    const nav_tree_shapes_t &shapes = scene.ctx->tree_shapes;
    const nav_pose2_t origin = {};
    EXPECT_EQ(12U, shapes.pose_count);
    for (int k = 0; k < NAV_TREE_ARCS; k++)
    {
        const nav_arc_t arc = {3.0, (k - 5) * 12.0 * DEG};
        EXPECT_NEAR(arc.heading_change_rad, shapes.heading_change_rad[k], 1e-9);
        for (uint32_t place = 0; place < shapes.pose_count; place++)
        {
            const nav_pose2_t pose = nav_arc_pose(&origin, &arc, (place + 1.0) / 12.0);
            EXPECT_NEAR(pose.x_m, shapes.forward_m[k][place], 1e-9);
            EXPECT_NEAR(pose.y_m, shapes.right_m[k][place], 1e-9);
        }
    }
}

} // namespace
