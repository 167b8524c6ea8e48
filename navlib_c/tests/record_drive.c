/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A drive recorded by a host without Python: `record_drive FILE.dp`. A plain with two boulders is
 * imaged, analyzed and driven over exactly as commanded, arc after arc, until the goal is reached;
 * every input and output of Navlib goes into the file, and the truth of this little world.
 * Built for a big-endian target it makes the foreign files that the tests read and run again.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "nav_dp_file.h"
#include "nav_dp_stub.h"
#include "nav_host.h"
#include "navlib.h"

#define CLOUD_ROWS 102 /* 0.1 m apart, from 2.2 m behind the rover */
#define CLOUD_COLS 72  /* 0.1 m apart, 3.6 m to each side */
#define CYCLES_MAX 12
#define TRUTHS_PER_ARC 4

static const char drive_json[] =
    "{\"name\":\"record_drive\",\"planner\":\"enav\",\"seed\":0,\"start_north_m\":0.0,"
    "\"start_east_m\":0.0,\"start_yaw_rad\":0.0,\"waypoints\":[{\"north_m\":4.5,\"east_m\":0.0,"
    "\"radius_m\":1.0,\"mode\":\"avoid_all\"}]}";
static const char reached_json[] = "{\"outcome\":\"goal_reached\",\"fault_detail\":\"\"}";
static const char no_path_json[] = "{\"outcome\":\"no_path\",\"fault_detail\":\"\"}";
static const nav_waydisc_t goal = {4.5, 0.0, 1.0};

/* What flight software would have for good: the context, the larger inputs and outputs. */
static nav_ctx_t ctx;
static nav_params_t params;
static nav_process_disparity_in_t cloud;
static nav_set_kioz_in_t zones;
static nav_select_arc_out_t selected;
static nav_evaluate_arc_out_t evaluated;
static nav_dp_file_t file;

static double time_s;
static double driven_m;
static nav_pose2_t rover;
static uint32_t image_count;

/* --- the world --------------------------------------------------------------------------------- */

static double height_m(double north_m, double east_m)
{
    static const double boulders[2][3] = {{2.8, 0.2, 0.35}, {3.5, -2.4, 0.3}}; /* place, radius */
    double height = 0.0;
    for (int k = 0; k < 2; k++)
    {
        const double north = north_m - boulders[k][0];
        const double east = east_m - boulders[k][1];
        const double left = (boulders[k][2] * boulders[k][2]) - (north * north) - (east * east);
        height = (left > 0.0) ? (0.8 * sqrt(left)) : height;
    }
    return height;
}

static nav_pose_t rover_pose(void)
{
    const nav_pose_t pose = {rover.x_m, rover.y_m, 0.0, 0.0, 0.0, rover.yaw_rad};
    return pose;
}

/* --- records ----------------------------------------------------------------------------------- */

/** What the calls have sent goes from the buffer of the stubs into the file. */
static void save_products(void)
{
    const uint8_t *data = nav_stub_data();
    uint32_t at = 0U;
    while (at < nav_stub_size())
    {
        nav_stub_header_t header;
        (void) memcpy(&header, &data[at], sizeof(header));
        at += (uint32_t) sizeof(header);
        (void) nav_dp_file_write(&file, header.kind, header.time_s, &data[at], header.size_bytes);
        at += ((header.size_bytes + 7U) / 8U) * 8U;
    }
    nav_stub_clear();
}

static void save_truth(void)
{
    nav_host_truth_t truth = {.time_s = time_s, .pose = rover_pose(), .is_converged = 1U};
    truth.distance_driven_m = driven_m;
    truth.clearance_m = params.belly_height_m;
    (void) nav_dp_file_write(&file, (uint32_t) NAV_HOST_DP_TRUTH, time_s, &truth,
                             (uint32_t) sizeof(truth));
}

static void save_estimate(void)
{
    const nav_host_estimate_t estimate = {.time_s = time_s, .pose = rover_pose()};
    (void) nav_dp_file_write(&file, (uint32_t) NAV_HOST_DP_ESTIMATE, time_s, &estimate,
                             (uint32_t) sizeof(estimate));
}

static void save_driving(double start_s, uint32_t cycle)
{
    const nav_host_timeline_t line = {.start_s = start_s,
                                      .end_s = time_s,
                                      .activity = (uint32_t) NAV_HOST_DRIVING,
                                      .cycle = cycle,
                                      .arc = selected.arc};
    (void) nav_dp_file_write(&file, (uint32_t) NAV_HOST_DP_TIMELINE, time_s, &line,
                             (uint32_t) sizeof(line));
}

/* --- the calls --------------------------------------------------------------------------------- */

static nav_status_t start(void)
{
    static nav_init_in_t in;
    nav_init_out_t out;
    nav_set_kioz_out_t zones_out;
    nav_status_t status;
    nav_zone_t *zone = &zones.zones[0];

    nav_params_default(&params);
    (void) memcpy(in.params, &params, sizeof(params));
    status = nav_init(&ctx, &in, &out);
    if (status == NAV_OK)
    {
        zones.zone_count = 1U;
        zone->kind = (uint32_t) NAV_ZONE_KEEP_OUT;
        zone->shape = (uint32_t) NAV_ZONE_CIRCLE;
        zone->center_x_site_m = 2.5;
        zone->center_y_site_m = 3.0;
        zone->radius_m = 1.0;
        status = nav_set_kioz(&ctx, &zones, &zones_out);
    }
    save_products();
    return status;
}

static nav_status_t look(void)
{
    nav_process_disparity_out_t out;
    const double cosine = nav_cos(rover.yaw_rad);
    const double sine = nav_sin(rover.yaw_rad);

    cloud.time_s = time_s;
    cloud.pose = rover_pose();
    cloud.image_id = ++image_count;
    cloud.chunk_count = 1U;
    cloud.point_count = CLOUD_ROWS * CLOUD_COLS;
    for (int row = 0; row < CLOUD_ROWS; row++)
    {
        for (int col = 0; col < CLOUD_COLS; col++)
        {
            const double forward_m = (0.1 * row) - 2.15;
            const double right_m = (0.1 * col) - 3.55;
            const double north_m = rover.x_m + (cosine * forward_m) - (sine * right_m);
            const double east_m = rover.y_m + (sine * forward_m) + (cosine * right_m);
            const nav_point_t point = {(float) forward_m, (float) right_m,
                                       (float) -height_m(north_m, east_m)};
            cloud.points[(row * CLOUD_COLS) + col] = point;
        }
    }
    return nav_process_disparity(&ctx, &cloud, &out);
}

static nav_status_t think(void)
{
    const nav_uncertainty_t uncertainty = {.position_m = 0.02, .yaw_rad = 0.01};
    const nav_analyze_terrain_in_t analyze = {.time_s = time_s, .pose = rover_pose(), .goal = goal};
    const nav_select_arc_in_t select = {.time_s = time_s,
                                        .pose = rover_pose(),
                                        .uncertainty = uncertainty,
                                        .goal = goal,
                                        .mode = (uint32_t) NAV_MODE_AVOID_ALL};
    nav_evaluate_arc_in_t evaluate = {.time_s = time_s,
                                      .pose = rover_pose(),
                                      .uncertainty = uncertainty,
                                      .mode = (uint32_t) NAV_MODE_AVOID_ALL};
    nav_analyze_terrain_out_t analyzed;
    nav_status_t status = look();

    if (status == NAV_OK)
    {
        status = nav_analyze_terrain(&ctx, &analyze, &analyzed);
    }
    if (status == NAV_OK)
    {
        status = nav_select_arc(&ctx, &select, &selected);
    }
    if (status == NAV_OK)
    {
        evaluate.arc = selected.arc;
        evaluate.is_leaving = selected.is_leaving;
        status = nav_evaluate_arc(&ctx, &evaluate, &evaluated);
    }
    save_products();
    return status;
}

static void drive_arc(uint32_t cycle)
{
    const nav_pose2_t from = rover;
    const double start_s = time_s;
    const double duration_s = nav_arc_duration_s(&params, &selected.arc);
    const double start_m = driven_m;

    for (int k = 1; k <= TRUTHS_PER_ARC; k++)
    {
        const double fraction = (double) k / TRUTHS_PER_ARC;
        rover = nav_arc_pose(&from, &selected.arc, fraction);
        time_s = start_s + (fraction * duration_s);
        driven_m = start_m + (fraction * fabs(selected.arc.length_m));
        save_truth();
    }
    save_driving(start_s, cycle);
    save_estimate();
}

static bool is_reached(void)
{
    const double north_m = goal.x_site_m - rover.x_m;
    const double east_m = goal.y_site_m - rover.y_m;
    return ((north_m * north_m) + (east_m * east_m)) <= (goal.radius_m * goal.radius_m);
}

int main(int argument_count, char **arguments)
{
    nav_status_t status = NAV_OK;
    const char *end = reached_json;

    if ((argument_count != 2) || !nav_dp_file_open(&file, arguments[1], drive_json))
    {
        (void) fprintf(stderr, "record_drive: expected the name of a file that can be written\n");
        return 2;
    }
    status = start();
    save_truth();
    save_estimate();
    for (uint32_t cycle = 1U; (cycle <= CYCLES_MAX) && (status == NAV_OK) && !is_reached(); cycle++)
    {
        status = think();
        if (status == NAV_OK)
        {
            drive_arc(cycle);
        }
        (void) nav_dp_file_flush(&file);
    }
    end = is_reached() ? reached_json : no_path_json;
    (void) nav_dp_file_write(&file, 0U, time_s, end, (uint32_t) strlen(end));
    if (!nav_dp_file_close(&file))
    {
        (void) fprintf(stderr, "record_drive: %s: not all could be written\n", arguments[1]);
        return 2;
    }
    (void) printf("%s: %.2f m, %u images\n", is_reached() ? "goal_reached" : "no_path", driven_m,
                  image_count);
    return is_reached() ? 0 : 1;
}
