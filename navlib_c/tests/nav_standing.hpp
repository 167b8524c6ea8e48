// SPDX-License-Identifier: Apache-2.0
// Where one wheel really stands on the ground of a scene, by dense sampling.
#ifndef NAV_STANDING_HPP
#define NAV_STANDING_HPP

#include "nav_scene.hpp"

extern "C"
{
#include "nav_ground.h"
}

inline constexpr double RADIUS_M = 0.26288;

inline nav_ground_t placed(const Scene &scene, double yaw_rad, double x_m = 0.25, double y_m = 0.25)
{
    const nav_pose2_t pose = {x_m, y_m, yaw_rad};
    nav_ground_t ground;
    EXPECT_TRUE(nav_ground_place(&ground, &scene.ctx->surface, &scene.ctx->costmap,
                                 &scene.ctx->relief, &pose));
    return ground;
}

/// The bilinear surface over a foot, above the plane along its normal.
inline double eta_at(const nav_ground_t &ground, double u_m, double v_m)
{
    const double row = ground.row + 10.0 * (ground.forward_xy[0] * u_m + ground.right_xy[0] * v_m);
    const double col = ground.col + 10.0 * (ground.forward_xy[1] * u_m + ground.right_xy[1] * v_m);
    const int r = static_cast<int>(row);
    const int c = static_cast<int>(col);
    const float *z = &ground.surface->z_site_m[(r * NAV_HEIGHTMAP_SIZE) + c];
    const double south = z[0] + ((col - c) * (z[1] - z[0]));
    const double north =
        z[NAV_HEIGHTMAP_SIZE] + ((col - c) * (z[NAV_HEIGHTMAP_SIZE + 1] - z[NAV_HEIGHTMAP_SIZE]));
    const double z_m = south + ((row - r) * (north - south));
    const double plane_m = ground.z_site_m + ground.dz_dx * 0.1 * (row - ground.row) +
                           ground.dz_dy * 0.1 * (col - ground.col);
    return (plane_m - z_m) * ground.cos_slope;
}

/// The lowest point of a wheel whose hub is at a place: dense sampling of its disc on level planes.
inline double standing_m(const nav_ground_t &ground, double u_m, double v_m)
{
    double hub_m = -1e9;
    for (double along = -RADIUS_M; along <= RADIUS_M; along += 0.002)
    {
        const double over = std::sqrt(std::max(RADIUS_M * RADIUS_M - along * along, 0.0));
        hub_m = std::max(hub_m, eta_at(ground, u_m + along, v_m) + over);
    }
    return hub_m - RADIUS_M;
}

#endif
