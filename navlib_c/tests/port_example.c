/* SPDX-License-Identifier: Apache-2.0 */
/*
 * How a host uses Navlib: this file, navlib_c/include, navlib_c/src and the C library are all there is.
 * The host supplies the memory, the two functions through which Navlib speaks, and the inputs. Here a
 * flat plain with one rock on the straight way is imaged, analyzed, and an arc is selected and checked.
 */
#include <stdio.h>
#include <string.h>

#include "navlib.h"

/* All memory of Navlib, and the larger inputs and outputs: static, as flight software would have it. */
static nav_ctx_t ctx;
static nav_process_disparity_in_t cloud;
static nav_select_arc_out_t selected;
static nav_evaluate_arc_out_t evaluated;

static unsigned event_count;
static unsigned product_count;

void nav_evr_send(const nav_evr_t *evr)
{
    for (int row = 0; row < NAV_EVR_COUNT; row++)
    {
        if (nav_evr_defs[row].id == evr->id)
        {
            (void) printf("event %s %g %g %g %g\n", nav_evr_defs[row].name, evr->args[0],
                          evr->args[1], evr->args[2], evr->args[3]);
        }
    }
    event_count++;
}

nav_status_t nav_dp_send(nav_dp_kind_t kind, double time_s, const void *record, uint32_t size_bytes)
{
    (void) kind;
    (void) time_s;
    (void) record;
    (void) size_bytes;
    product_count++;
    return NAV_OK;
}

static nav_status_t start(void)
{
    static nav_init_in_t in;
    nav_init_out_t out;
    nav_params_t params;

    nav_params_default(&params);
    (void) memcpy(in.params, &params, sizeof(params));
    return nav_init(&ctx, &in, &out);
}

/* One row of the terrain as one image: a rock 0.5 m high, 4 m ahead. */
static nav_status_t image_row(int row)
{
    nav_process_disparity_out_t out;

    cloud.image_id++;
    cloud.chunk_count = 1U;
    cloud.point_count = NAV_HEIGHTMAP_SIZE;
    for (int col = 0; col < NAV_HEIGHTMAP_SIZE; col++)
    {
        const float x_m = 0.1F * ((float) (row - (NAV_HEIGHTMAP_SIZE / 2)) + 0.5F);
        const float y_m = 0.1F * ((float) (col - (NAV_HEIGHTMAP_SIZE / 2)) + 0.5F);
        const float away_m2 = ((x_m - 4.0F) * (x_m - 4.0F)) + (y_m * y_m);
        const nav_point_t point = {x_m, y_m, (away_m2 < 0.2F) ? -0.5F : 0.0F};
        cloud.points[col] = point;
    }
    return nav_process_disparity(&ctx, &cloud, &out);
}

int main(void)
{
    const nav_waydisc_t goal = {12.0, 0.0, 1.0};
    nav_analyze_terrain_in_t look = {0};
    nav_analyze_terrain_out_t looked;
    nav_select_arc_in_t select = {0};
    nav_evaluate_arc_in_t evaluate = {0};
    nav_status_t status = start();

    for (int row = 0; (row < NAV_HEIGHTMAP_SIZE) && (status == NAV_OK); row++)
    {
        status = image_row(row);
    }
    if (status == NAV_OK)
    {
        look.goal = goal;
        status = nav_analyze_terrain(&ctx, &look, &looked);
    }
    if (status == NAV_OK)
    {
        select.goal = goal;
        select.mode = NAV_MODE_AVOID_ALL;
        status = nav_select_arc(&ctx, &select, &selected);
    }
    if (status == NAV_OK)
    {
        evaluate.arc = selected.arc;
        evaluate.mode = NAV_MODE_AVOID_ALL;
        status = nav_evaluate_arc(&ctx, &evaluate, &evaluated);
    }
    (void) printf("%s: arc %.2f m, %.3f rad, %s; %u events, %u data products\n",
                  nav_status_text(status), selected.arc.length_m, selected.arc.heading_change_rad,
                  (evaluated.is_safe != 0U) ? "safe" : "not safe", event_count, product_count);
    return ((status == NAV_OK) && (evaluated.is_safe != 0U)) ? 0 : 1;
}
