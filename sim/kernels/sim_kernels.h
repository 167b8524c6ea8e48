/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sim_kernels.h
 * @brief The hot loops of the simulator: rocker-bogie settling, ray casting, point clouds.
 *
 * Frames: SITE x north, y east, z down. Rover x forward, y right, z down, origin on the ground
 * under the middle axle. Attitude R = Rz(yaw) Ry(pitch) Rx(roll) maps rover to SITE. Metres, radians.
 *
 * All functions are pure: no heap, no file-scope data, no I/O; thread-safe on distinct outputs.
 */
#ifndef SIM_KERNELS_H
#define SIM_KERNELS_H

#include <stdint.h>

#define SIM_WHEEL_COUNT 6
#define SIM_SIDE_COUNT 2

/** Wheel models: a point under the hub, a thin disc, a cylinder sampled over its width. */
#define SIM_WHEEL_POINT 0
#define SIM_WHEEL_DISC 1
#define SIM_WHEEL_CYLINDER 2

/** Levels of the roof, which lets rays skip empty space. */
#define SIM_ROOF_LEVELS_MAX 10

/** Nodes z[row][col], row growing north, col growing east; bilinear in between. NaN is no ground. */
typedef struct
{
    const float *z_site_m;
    int32_t rows;
    int32_t cols;
    double resolution_m;
    double north_min_m;
    double east_min_m;
    /* slope of the ground around each cell: z down per metre north and east; NULL if not needed */
    const float *slope;
    int32_t slope_rows;
    int32_t slope_cols;
    double slope_cell_m;
    double slope_north_min_m;
    double slope_east_min_m;
} sim_terrain_t;

/** Geometry in the rover frame with all joints at zero. Wheels: LF, LM, LR, RF, RM, RR. */
typedef struct
{
    double hub_m[SIM_WHEEL_COUNT][3];
    double rocker_pivot_m[SIM_SIDE_COUNT][3];
    double bogie_pivot_m[SIM_SIDE_COUNT][3];
    double wheel_radius_m;
    double wheel_width_m;
    double belly_front_m;
    double belly_rear_m;
    double belly_half_width_m;
    double belly_z_m;
    double tolerance_m;
    int32_t iterations_max;
    int32_t wheel_kind;
} sim_vehicle_t;

/**
 * One settled rover.
 *
 * rocker_rad is the left rocker against the body, positive nose-down; the differential makes the
 * right one its negative. A bogie angle is the bogie against its rocker, positive nose-down.
 * clearance_m: smallest distance, along the body z axis, from the belly pan down to a terrain node
 * inside the belly box. wheel_drop_m: largest span of terrain in one wheel's box, measured across
 * the slope of the ground around the rover; NaN without that slope. Both are NaN when a node in
 * their boxes has no ground.
 */
typedef struct
{
    double x_m;
    double y_m;
    double z_m;
    double roll_rad;
    double pitch_rad;
    double yaw_rad;
    double rocker_rad;
    double bogie_left_rad;
    double bogie_right_rad;
    double tilt_rad;
    double clearance_m;
    double wheel_drop_m;
    double residual_m;
    double contact_site_m[SIM_WHEEL_COUNT][3];
    double hub_site_m[SIM_WHEEL_COUNT][3];
    int32_t iterations;
    int32_t converged;
    int32_t on_map;
    int32_t reserved;
} sim_settled_t;

/**
 * Settles the rover at pose = (x north, y east, yaw).
 *
 * Six unknowns (z, roll, pitch, rocker, two bogies), six contacts: damped Newton on the vertical
 * gap between each wheel and the ground. Contract: converged is 1 if and only if every |gap| is at
 * most tolerance_m; otherwise the best iterate is returned with its residual_m = largest |gap|.
 * With no ground under a wheel (off the map, NaN node or NaN pose) on_map is 0 and every derived
 * quantity is NaN.
 * guess: a settled state near by, on the same terrain, or NULL to start from the ground under the
 * hubs. From a guess closer than a few centimetres the posture is foretold by the ground under its
 * contacts, and iterations counts what that left to do.
 */
void sim_settle(const sim_terrain_t *terrain,
                const sim_vehicle_t *vehicle,
                const double *pose,
                const sim_settled_t *guess,
                sim_settled_t *out);

/**
 * Settles count poses (x, y, yaw each). With chained != 0 every pose starts from the one before it
 * (a drive), else each starts cold (a survey).
 */
void sim_settle_path(const sim_terrain_t *terrain,
                     const sim_vehicle_t *vehicle,
                     const double *poses,
                     int32_t count,
                     int32_t chained,
                     sim_settled_t *out);

/**
 * Settles the linkage alone on six given hub heights (SITE z); contacts are taken one radius under
 * the hubs. Clearance and wheel drop are NaN: there is no terrain.
 */
void sim_settle_hubs(const sim_vehicle_t *vehicle,
                     const double *pose,
                     const double *hub_z_site_m,
                     sim_settled_t *out);

/** Rays from one origin: count unit vectors in a frame that attitude, by rows, turns to SITE. */
typedef struct
{
    double origin_site_m[3];
    double attitude[3][3];
    double range_max_m;
    const double *directions;
    int32_t count;
    int32_t reserved;
} sim_rays_t;

/** Number of floats of the roof of a terrain. */
int64_t sim_roof_size(int32_t rows, int32_t cols);

/**
 * Fills the roof: levels of blocks of 1, 2, 4 ... cells that hold the highest ground (smallest z) of
 * a block and its neighbours. Cells without ground (a NaN node) count as infinitely low.
 */
void sim_roof_build(const sim_terrain_t *terrain, float *roof);

/** Number of floats that sim_raycast needs to work in; they need no content. */
int64_t sim_raycast_table_size(const sim_terrain_t *terrain, double range_max_m);

/**
 * First hit of every ray with the bilinear surface.
 *
 * range_m receives the distance, or NaN where the ray leaves the map or exceeds range_max_m. A ray
 * that starts below the ground has range 0. The origin must be finite.
 */
void sim_raycast(const sim_terrain_t *terrain,
                 const float *roof,
                 const sim_rays_t *rays,
                 float *table,
                 float *range_m);

/**
 * A stereo pair whose left camera, at center_m, looks along count unit vectors. The right one stands
 * baseline_m from it; pixel_rad is the angle of a pixel of the images that are matched.
 */
typedef struct
{
    double center_m[3];
    double baseline_m[3];
    double pixel_rad;
    const double *directions;
    int32_t count;
    int32_t reserved;
} sim_stereo_t;

/**
 * Points (x, y, z each) at the ranges along the left rays, none where a range is NaN; returns their
 * number. error_px holds the error of matching of each range that is not, in their order; it slides
 * the point along its ray, and what would come out behind the camera is dropped. NULL is no error.
 */
int32_t sim_cloud(const sim_stereo_t *stereo,
                  const float *range_m,
                  const double *error_px,
                  float *point_m);

#endif
