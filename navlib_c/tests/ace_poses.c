/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Evaluates ACE at poses on a given surface, for counting its instructions: `ace_poses FILE`, run by
 * pyharness/bench.py under callgrind.
 *
 * FILE holds, in this machine's byte order: float z_site_m[NAV_HEIGHTMAP_CELLS], row by row from south,
 * of the cells around the SITE origin; then poses until the end, of five doubles each: x_site_m,
 * y_site_m, yaw_rad, and the uncertainty position_m and yaw_rad.
 */
#include <stdio.h>
#include <string.h>

#include "nav_ace.h"
#include "navlib.h"

#define POSE_NUMBERS 5

static nav_ctx_t ctx;
static nav_process_disparity_in_t cloud;

static nav_status_t start(void)
{
    static nav_init_in_t in;
    nav_init_out_t out;
    nav_params_t params;

    nav_params_default(&params);
    (void) memcpy(in.params, &params, sizeof(params));
    return nav_init(&ctx, &in, &out);
}

/* One exact point in every cell of a row. */
static nav_status_t image_row(FILE *file, int row)
{
    nav_process_disparity_out_t out;
    float z_m[NAV_HEIGHTMAP_SIZE];
    nav_status_t status = NAV_COUNT;

    if (fread(z_m, sizeof(float), NAV_HEIGHTMAP_SIZE, file) == (size_t) NAV_HEIGHTMAP_SIZE)
    {
        cloud.image_id++;
        cloud.chunk_count = 1U;
        cloud.point_count = NAV_HEIGHTMAP_SIZE;
        for (int col = 0; col < NAV_HEIGHTMAP_SIZE; col++)
        {
            cloud.points[col].x_m = 0.1F * ((float) (row - (NAV_HEIGHTMAP_SIZE / 2)) + 0.5F);
            cloud.points[col].y_m = 0.1F * ((float) (col - (NAV_HEIGHTMAP_SIZE / 2)) + 0.5F);
            cloud.points[col].z_m = z_m[col];
        }
        status = nav_process_disparity(&ctx, &cloud, &out);
    }
    return status;
}

static nav_status_t map_ground(FILE *file)
{
    nav_analyze_terrain_in_t in = {0};
    nav_analyze_terrain_out_t out;
    nav_status_t status = start();

    for (int row = 0; (row < NAV_HEIGHTMAP_SIZE) && (status == NAV_OK); row++)
    {
        status = image_row(file, row);
    }
    return (status == NAV_OK) ? nav_analyze_terrain(&ctx, &in, &out) : status;
}

static void evaluate_poses(FILE *file)
{
    const nav_ace_scene_t scene = {&ctx.params,  &ctx.vehicle, &ctx.surface,
                                   &ctx.costmap, &ctx.relief,  &ctx.ace_work};
    double numbers[POSE_NUMBERS];
    unsigned pose_count = 0U;
    unsigned certified_count = 0U;
    unsigned safe_count = 0U;

    while (fread(numbers, sizeof(double), POSE_NUMBERS, file) == (size_t) POSE_NUMBERS)
    {
        const nav_pose2_t pose = {numbers[0], numbers[1], numbers[2]};
        const nav_uncertainty_t uncertainty = {numbers[3], numbers[4], 0.0};
        nav_ace_bounds_t bounds;
        nav_ace_evaluate(&scene, &pose, &uncertainty, false, &bounds);
        pose_count++;
        certified_count += bounds.is_certified;
        safe_count += (bounds.reason == (uint32_t) NAV_REASON_NONE) ? 1U : 0U;
    }
    (void) printf("%u poses, %u certified, %u safe\n", pose_count, certified_count, safe_count);
}

int main(int argc, char **argv)
{
    FILE *file = (argc == 2) ? fopen(argv[1], "rb") : NULL;
    const int is_mapped = (file != NULL) && (map_ground(file) == NAV_OK);

    if (is_mapped != 0)
    {
        evaluate_poses(file);
    }
    else
    {
        (void) fprintf(stderr, "ace_poses: expected one file with a surface and poses\n");
    }
    if (file != NULL)
    {
        (void) fclose(file);
    }
    return (is_mapped != 0) ? 0 : 1;
}
