/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_interface.c
 * @brief The six calls: check everything, then do the work, then report.
 */
#include "nav_interface.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "nav_dp.h"
#include "nav_evr.h"
#include "nav_math.h"
#include "nav_select.h"

#define COORDINATE_MAX_M 1.0e6
#define YAW_MAX_RAD 1.0e4
#define POINT_MAX_M 1.0e5
#define UNCERTAINTY_MAX 100.0
#define RADIUS_MAX_M 1.0e4
#define ARC_LENGTH_MAX_M 10.0
#define CURVATURE_MAX_PER_M 100.0

/** Size of a record that ends after the used entries of its last field. */
#define TRIMMED(type, last, count, max)                                                            \
    ((uint32_t) (offsetof(type, last) + (sizeof(((type *) NULL)->last[0]) *                        \
                                         (size_t) (((count) < (max)) ? (count) : (max)))))

/** NOT_FINITE for a NaN or infinity, OUT_OF_RANGE beyond [low, high]. */
static nav_status_t check_range(double x, double low, double high)
{
    nav_status_t status = NAV_OK;
    if (!nav_isfinite(x))
    {
        status = NAV_NOT_FINITE;
    }
    else if ((x < low) || (x > high))
    {
        status = NAV_OUT_OF_RANGE;
    }
    else
    {
        status = NAV_OK;
    }
    return status;
}

static nav_status_t first_error(const nav_status_t *checks, uint32_t count)
{
    nav_status_t status = NAV_OK;
    for (uint32_t k = 0U; (k < count) && (status == NAV_OK); k++)
    {
        status = checks[k];
    }
    return status;
}

static nav_status_t check_pose(const nav_pose_t *pose)
{
    const nav_status_t checks[6] = {
        check_range(pose->x_site_m, -COORDINATE_MAX_M, COORDINATE_MAX_M),
        check_range(pose->y_site_m, -COORDINATE_MAX_M, COORDINATE_MAX_M),
        check_range(pose->z_site_m, -COORDINATE_MAX_M, COORDINATE_MAX_M),
        check_range(pose->roll_rad, -NAV_PI, NAV_PI),
        check_range(pose->pitch_rad, -0.5 * NAV_PI, 0.5 * NAV_PI),
        check_range(pose->yaw_rad, -YAW_MAX_RAD, YAW_MAX_RAD),
    };
    return first_error(checks, 6U);
}

static nav_status_t check_uncertainty(const nav_uncertainty_t *uncertainty)
{
    const nav_status_t checks[3] = {
        check_range(uncertainty->position_m, 0.0, UNCERTAINTY_MAX),
        check_range(uncertainty->yaw_rad, 0.0, NAV_PI),
        check_range(uncertainty->global_position_m, 0.0, UNCERTAINTY_MAX),
    };
    return first_error(checks, 3U);
}

static nav_status_t check_goal(const nav_waydisc_t *goal)
{
    const nav_status_t checks[3] = {
        check_range(goal->x_site_m, -COORDINATE_MAX_M, COORDINATE_MAX_M),
        check_range(goal->y_site_m, -COORDINATE_MAX_M, COORDINATE_MAX_M),
        check_range(goal->radius_m, 0.0, RADIUS_MAX_M),
    };
    return first_error(checks, 3U);
}

/** Time must be finite and must not run backwards. */
static nav_status_t check_time(const nav_ctx_t *ctx, double time_s)
{
    nav_status_t status = NAV_OK;
    if (!nav_isfinite(time_s))
    {
        status = NAV_NOT_FINITE;
    }
    else if (time_s < ctx->time_s)
    {
        status = NAV_ORDER;
    }
    else
    {
        status = NAV_OK;
    }
    return status;
}

static nav_status_t check_pointers(const void *ctx, const void *in, const void *out)
{
    return ((ctx == NULL) || (in == NULL) || (out == NULL)) ? NAV_NULL_POINTER : NAV_OK;
}

static nav_status_t check_context(const nav_ctx_t *ctx)
{
    return (ctx->magic == (uint32_t) NAV_CONTEXT_MAGIC) ? NAV_OK : NAV_NOT_INITIALIZED;
}

static void send(nav_dp_kind_t kind, double time_s, const void *record, uint32_t size_bytes)
{
    if (nav_dp_send(kind, time_s, record, size_bytes) != NAV_OK)
    {
        nav_evr_report(time_s, NAV_EVR_PRODUCT_REFUSED, (double) kind, 0.0, 0.0, 0.0);
    }
}

/** The time to put on reports: that of the call, if it is one. */
static double report_time_s(double time_s)
{
    return nav_isfinite(time_s) ? time_s : 0.0;
}

static void report_refusal(double time_s, nav_dp_kind_t call, nav_status_t status)
{
    if (status != NAV_OK)
    {
        nav_evr_report(time_s, NAV_EVR_CALL_REFUSED, (double) call, (double) status, 0.0, 0.0);
    }
}

nav_status_t nav_init(nav_ctx_t *ctx, const nav_init_in_t *in, nav_init_out_t *out)
{
    nav_status_t status = check_pointers(ctx, in, out);
    if (status == NAV_OK)
    {
        const double time_s = report_time_s(in->time_s);
        nav_params_t params;
        uint32_t refused = (uint32_t) NAV_PARAM_COUNT;
        (void) memset(out, 0, sizeof(*out));
        (void) memcpy(&params, in->params, sizeof(params));
        send(NAV_DP_INIT_IN, time_s, in, (uint32_t) sizeof(*in));
        status = nav_isfinite(in->time_s) ? nav_params_check(&params, &refused) : NAV_NOT_FINITE;
        if (status == NAV_OK)
        {
            (void) memset(ctx, 0, sizeof(*ctx));
            ctx->time_s = in->time_s;
            ctx->params = params;
            nav_vehicle_init(&ctx->params, &ctx->vehicle);
            nav_heightmap_init(&ctx->heightmap, &ctx->params);
            nav_costmap_init(&ctx->costmap, &ctx->params);
            nav_tree_init(&ctx->params, &ctx->tree_shapes);
            nav_passage_init(&ctx->params, &ctx->footprint);
            ctx->magic = (uint32_t) NAV_CONTEXT_MAGIC;
            nav_evr_report(time_s, NAV_EVR_INITIALIZED, (double) NAV_PARAM_COUNT, 0.0, 0.0, 0.0);
        }
        else if (refused < (uint32_t) NAV_PARAM_COUNT)
        {
            nav_evr_report(time_s, NAV_EVR_PARAMETER_REFUSED, (double) refused,
                           report_time_s(in->params[refused]), 0.0, 0.0);
        }
        else
        {
            /* the refusal of the call says it all */
        }
        report_refusal(time_s, NAV_DP_INIT_IN, status);
        out->status = (uint32_t) status;
        out->refused_index = refused;
        send(NAV_DP_INIT_OUT, time_s, out, (uint32_t) sizeof(*out));
    }
    return status;
}

/** Index of the first zone that cannot be used, or zone_count. */
static nav_status_t check_zones(const nav_set_kioz_in_t *in, uint32_t *refused)
{
    nav_status_t status = NAV_OK;
    *refused = in->zone_count;
    for (uint32_t k = 0U; (k < in->zone_count) && (status == NAV_OK); k++)
    {
        status = nav_kioz_check(&in->zones[k]);
        if (status != NAV_OK)
        {
            *refused = k;
        }
    }
    return status;
}

static nav_status_t check_set_kioz(const nav_ctx_t *ctx, const nav_set_kioz_in_t *in)
{
    nav_status_t status = check_context(ctx);
    if (status == NAV_OK)
    {
        status = check_time(ctx, in->time_s);
    }
    if ((status == NAV_OK) && (in->zone_count > (uint32_t) NAV_ZONES_MAX))
    {
        status = NAV_COUNT;
    }
    return status;
}

nav_status_t nav_set_kioz(nav_ctx_t *ctx, const nav_set_kioz_in_t *in, nav_set_kioz_out_t *out)
{
    nav_status_t status = check_pointers(ctx, in, out);
    if (status == NAV_OK)
    {
        const double time_s = report_time_s(in->time_s);
        uint32_t refused = in->zone_count;
        (void) memset(out, 0, sizeof(*out));
        send(NAV_DP_SET_KIOZ_IN, time_s, in,
             TRIMMED(nav_set_kioz_in_t, zones, in->zone_count, (uint32_t) NAV_ZONES_MAX));
        status = check_set_kioz(ctx, in);
        if (status == NAV_OK)
        {
            status = check_zones(in, &refused);
            if (status != NAV_OK)
            {
                nav_evr_report(time_s, NAV_EVR_ZONE_REFUSED, (double) refused, 0.0, 0.0, 0.0);
            }
        }
        if (status == NAV_OK)
        {
            nav_kioz_set(&ctx->kioz, in->zones, in->zone_count);
            ctx->time_s = in->time_s;
            nav_evr_report(time_s, NAV_EVR_ZONES_SET,
                           (double) (ctx->kioz.zone_count - ctx->kioz.keep_in_count),
                           (double) ctx->kioz.keep_in_count, 0.0, 0.0);
        }
        report_refusal(time_s, NAV_DP_SET_KIOZ_IN, status);
        out->status = (uint32_t) status;
        out->refused_index = refused;
        send(NAV_DP_SET_KIOZ_OUT, time_s, out, (uint32_t) sizeof(*out));
    }
    return status;
}

/** Why a point cannot be used. */
static nav_status_t check_point(const nav_point_t *point)
{
    const nav_status_t checks[3] = {
        check_range((double) point->x_m, -POINT_MAX_M, POINT_MAX_M),
        check_range((double) point->y_m, -POINT_MAX_M, POINT_MAX_M),
        check_range((double) point->z_m, -POINT_MAX_M, POINT_MAX_M),
    };
    return first_error(checks, 3U);
}

/** Whether all points are near and finite; one sum and comparison for each, false for a NaN. */
static bool are_near(const nav_point_t *points, uint32_t count)
{
    uint32_t far_count = 0U;
    for (uint32_t k = 0U; k < count; k++)
    {
        const float sum_m = fabsf(points[k].x_m) + fabsf(points[k].y_m) + fabsf(points[k].z_m);
        far_count += (sum_m <= (float) POINT_MAX_M) ? 0U : 1U;
    }
    return far_count == 0U;
}

static nav_status_t check_points(const nav_process_disparity_in_t *in)
{
    nav_status_t status = NAV_OK;
    if (!are_near(in->points, in->point_count))
    {
        for (uint32_t k = 0U; (k < in->point_count) && (status == NAV_OK); k++)
        {
            status = check_point(&in->points[k]);
        }
    }
    return status;
}

/** Chunks of one image come in order, and an image number is not used twice in a row. */
static nav_status_t check_sequence(const nav_ctx_t *ctx, const nav_process_disparity_in_t *in)
{
    const bool is_next = (ctx->chunk_next > 0U) && (in->image_id == ctx->image_id) &&
                         (in->chunk_index == ctx->chunk_next) &&
                         (in->chunk_count == ctx->chunk_count);
    const bool is_new =
        (in->chunk_index == 0U) && ((ctx->is_mapped == 0U) || (in->image_id != ctx->image_id));
    return (is_next || is_new) ? NAV_OK : NAV_ORDER;
}

static nav_status_t check_process_disparity(const nav_ctx_t *ctx,
                                            const nav_process_disparity_in_t *in)
{
    nav_status_t status = check_context(ctx);
    if ((status == NAV_OK) && !nav_isfinite(in->time_s))
    {
        status = NAV_NOT_FINITE;
    }
    if (status == NAV_OK)
    {
        status = check_pose(&in->pose);
    }
    if ((status == NAV_OK) && ((in->point_count > (uint32_t) NAV_CHUNK_POINTS_MAX) ||
                               (in->chunk_index >= in->chunk_count)))
    {
        status = NAV_COUNT;
    }
    if (status == NAV_OK)
    {
        status = check_sequence(ctx, in);
    }
    if (status == NAV_OK)
    {
        status = check_points(in);
    }
    return status;
}

static void merge_chunk(nav_ctx_t *ctx,
                        const nav_process_disparity_in_t *in,
                        nav_process_disparity_out_t *out)
{
    (void) nav_heightmap_center(&ctx->heightmap, in->pose.x_site_m, in->pose.y_site_m);
    const nav_merge_t merge = nav_heightmap_merge(&ctx->heightmap, &in->pose, in->time_s,
                                                  in->image_id, in->points, in->point_count);
    out->merged_count = merge.merged_count;
    out->outside_count = merge.outside_count;
    ctx->is_mapped = 1U;
    ctx->image_id = in->image_id;
    ctx->chunk_count = in->chunk_count;
    ctx->chunk_next = ((in->chunk_index + 1U) < in->chunk_count) ? (in->chunk_index + 1U) : 0U;
}

nav_status_t nav_process_disparity(nav_ctx_t *ctx,
                                   const nav_process_disparity_in_t *in,
                                   nav_process_disparity_out_t *out)
{
    nav_status_t status = check_pointers(ctx, in, out);
    if (status == NAV_OK)
    {
        const double time_s = report_time_s(in->time_s);
        (void) memset(out, 0, sizeof(*out));
        send(NAV_DP_PROCESS_DISPARITY_IN, time_s, in,
             TRIMMED(nav_process_disparity_in_t, points, in->point_count,
                     (uint32_t) NAV_CHUNK_POINTS_MAX));
        status = check_process_disparity(ctx, in);
        if (status == NAV_OK)
        {
            merge_chunk(ctx, in, out);
            nav_evr_report(time_s, NAV_EVR_CLOUD_MERGED, (double) in->image_id,
                           (double) out->merged_count, (double) out->outside_count, 0.0);
        }
        report_refusal(time_s, NAV_DP_PROCESS_DISPARITY_IN, status);
        out->status = (uint32_t) status;
        send(NAV_DP_PROCESS_DISPARITY_OUT, time_s, out, (uint32_t) sizeof(*out));
    }
    return status;
}

static nav_status_t check_analyze_terrain(const nav_ctx_t *ctx, const nav_analyze_terrain_in_t *in)
{
    nav_status_t status = check_context(ctx);
    if (status == NAV_OK)
    {
        const nav_status_t checks[4] = {
            check_time(ctx, in->time_s),
            check_pose(&in->pose),
            check_goal(&in->goal),
            check_range(in->global_position_m, 0.0, UNCERTAINTY_MAX),
        };
        status = first_error(checks, 4U);
    }
    if ((status == NAV_OK) && (ctx->is_mapped == 0U))
    {
        status = NAV_ORDER;
    }
    return status;
}

static void analyze(nav_ctx_t *ctx,
                    const nav_analyze_terrain_in_t *in,
                    nav_analyze_terrain_out_t *out)
{
    const double x_m = in->pose.x_site_m;
    const double y_m = in->pose.y_site_m;
    uint32_t index = 0U;
    ctx->time_s = in->time_s;
    (void) nav_heightmap_center(&ctx->heightmap, x_m, y_m);
    nav_heightmap_surface(&ctx->heightmap, &ctx->params, in->time_s, &ctx->surface_state,
                          &ctx->surface);
    out->is_recentered = nav_costmap_recenter(&ctx->costmap, &ctx->params, x_m, y_m) ? 1U : 0U;
    nav_costmap_update(&ctx->costmap, &ctx->costmap_state, &ctx->params, &ctx->surface,
                       &ctx->surface_state);
    nav_costmap_mark(&ctx->costmap, &ctx->params, &ctx->kioz, in->global_position_m);
    nav_relief_update(&ctx->relief, &ctx->costmap, &ctx->costmap_state, &ctx->surface);
    nav_passage_update(&ctx->costmap, &ctx->costmap_state, &ctx->params, &ctx->footprint,
                       &ctx->relief, &ctx->surface);
    ctx->is_analyzed = 1U;

    for (uint32_t k = 0U; k < (uint32_t) NAV_COSTMAP_CELLS; k++)
    {
        const nav_cost_cell_t *cell = &ctx->costmap.cells[k];
        out->known_count += cell->is_known;
        out->infinite[nav_costmap_reason(cell, true, true)]++;
    }
    out->is_goal_inside =
        nav_costmap_find(&ctx->costmap, in->goal.x_site_m, in->goal.y_site_m, &index) ? 1U : 0U;
    out->heightmap_min_x_site_m = (double) ctx->surface.origin_row * ctx->surface.cell_m;
    out->heightmap_min_y_site_m = (double) ctx->surface.origin_col * ctx->surface.cell_m;
    out->costmap_min_x_site_m = (double) ctx->costmap.origin_row * ctx->costmap.cell_m;
    out->costmap_min_y_site_m = (double) ctx->costmap.origin_col * ctx->costmap.cell_m;
}

static void report_analysis(const nav_ctx_t *ctx,
                            double time_s,
                            const nav_analyze_terrain_out_t *out)
{
    const uint32_t infinite =
        (uint32_t) NAV_COSTMAP_CELLS - out->infinite[(uint32_t) NAV_REASON_NONE];
    if (out->is_recentered != 0U)
    {
        const double half_m = 0.5 * (double) NAV_COSTMAP_SIZE * ctx->costmap.cell_m;
        nav_evr_report(time_s, NAV_EVR_COSTMAP_RECENTERED, out->costmap_min_x_site_m + half_m,
                       out->costmap_min_y_site_m + half_m, 0.0, 0.0);
    }
    nav_evr_report(time_s, NAV_EVR_TERRAIN_ANALYZED, (double) out->known_count, (double) infinite,
                   0.0, 0.0);
    if (ctx->params.product_level >= 2.0)
    {
        send(NAV_DP_SURFACE, time_s, &ctx->surface, (uint32_t) sizeof(ctx->surface));
        send(NAV_DP_COSTMAP, time_s, &ctx->costmap, (uint32_t) sizeof(ctx->costmap));
    }
}

nav_status_t nav_analyze_terrain(nav_ctx_t *ctx,
                                 const nav_analyze_terrain_in_t *in,
                                 nav_analyze_terrain_out_t *out)
{
    nav_status_t status = check_pointers(ctx, in, out);
    if (status == NAV_OK)
    {
        const double time_s = report_time_s(in->time_s);
        (void) memset(out, 0, sizeof(*out));
        send(NAV_DP_ANALYZE_TERRAIN_IN, time_s, in, (uint32_t) sizeof(*in));
        status = check_analyze_terrain(ctx, in);
        if (status == NAV_OK)
        {
            analyze(ctx, in, out);
            report_analysis(ctx, time_s, out);
        }
        report_refusal(time_s, NAV_DP_ANALYZE_TERRAIN_IN, status);
        out->status = (uint32_t) status;
        send(NAV_DP_ANALYZE_TERRAIN_OUT, time_s, out, (uint32_t) sizeof(*out));
    }
    return status;
}

static nav_status_t check_mode(uint32_t mode)
{
    return (mode < (uint32_t) NAV_MODE_COUNT) ? NAV_OK : NAV_OUT_OF_RANGE;
}

static nav_status_t check_select_arc(const nav_ctx_t *ctx, const nav_select_arc_in_t *in)
{
    nav_status_t status = check_context(ctx);
    if (status == NAV_OK)
    {
        const nav_status_t checks[6] = {
            check_time(ctx, in->time_s),
            check_pose(&in->pose),
            check_uncertainty(&in->uncertainty),
            check_goal(&in->goal),
            check_range(in->steering.curvature_per_m, -CURVATURE_MAX_PER_M, CURVATURE_MAX_PER_M),
            check_mode(in->mode),
        };
        status = first_error(checks, 6U);
    }
    if ((status == NAV_OK) && (ctx->is_analyzed == 0U))
    {
        status = NAV_ORDER;
    }
    return status;
}

/** The reason most paths were rejected for, cost aside. */
static uint32_t main_rejection(const nav_select_arc_out_t *out)
{
    uint32_t main = (uint32_t) NAV_REASON_KIOZ;
    for (uint32_t reason = main + 1U; reason < (uint32_t) NAV_REASON_COUNT; reason++)
    {
        if ((reason != (uint32_t) NAV_REASON_COST) &&
            (out->rejections[reason] > out->rejections[main]))
        {
            main = reason;
        }
    }
    return main;
}

static void report_selection(const nav_ctx_t *ctx, double time_s, const nav_select_arc_out_t *out)
{
    if (out->rejections[(uint32_t) NAV_REASON_BUDGET] > 0U)
    {
        nav_evr_report(time_s, NAV_EVR_BUDGET_USED, (double) out->ace_evaluations, 0.0, 0.0, 0.0);
    }
    if (out->status == (uint32_t) NAV_OK)
    {
        nav_evr_report(time_s, NAV_EVR_ARC_SELECTED, out->arc.length_m, out->arc.heading_change_rad,
                       out->path_cost_s, (double) out->ace_evaluations);
    }
    else
    {
        const uint32_t main = main_rejection(out);
        nav_evr_report(time_s, NAV_EVR_NO_PATH, (double) NAV_TREE_PATHS, (double) main,
                       (double) out->rejections[main], 0.0);
    }
    if (ctx->params.product_level >= 1.0)
    {
        send(NAV_DP_TREE, time_s, &ctx->tree, (uint32_t) sizeof(ctx->tree));
    }
}

static nav_ace_scene_t ace_scene(nav_ctx_t *ctx)
{
    const nav_ace_scene_t scene = {&ctx->params,  &ctx->vehicle, &ctx->surface,
                                   &ctx->costmap, &ctx->relief,  &ctx->ace_work};
    return scene;
}

static nav_status_t select_arc(nav_ctx_t *ctx,
                               const nav_select_arc_in_t *in,
                               nav_select_arc_out_t *out)
{
    const nav_tree_scene_t scene = {ace_scene(ctx), &ctx->kioz, &ctx->global, &ctx->tree_shapes,
                                    &ctx->costmap};
    const bool use_terrain = in->mode == (uint32_t) NAV_MODE_AVOID_ALL;
    const bool use_zones = use_terrain || (in->mode == (uint32_t) NAV_MODE_AVOID_KOZ);
    ctx->time_s = in->time_s;
    nav_global_plan(&ctx->global, &ctx->costmap, &ctx->params, &in->goal, use_terrain, use_zones);
    nav_select_path(&ctx->tree, &scene, in, out);
    if ((out->status == (uint32_t) NAV_NO_PATH) && (out->paths_tested == 0U))
    {
        /* what ACE closed may be what stands in the way of the next attempt */
        nav_costmap_clear_feedback(&ctx->costmap);
    }
    return (nav_status_t) out->status;
}

nav_status_t nav_select_arc(nav_ctx_t *ctx,
                            const nav_select_arc_in_t *in,
                            nav_select_arc_out_t *out)
{
    nav_status_t status = check_pointers(ctx, in, out);
    if (status == NAV_OK)
    {
        const double time_s = report_time_s(in->time_s);
        (void) memset(out, 0, sizeof(*out));
        send(NAV_DP_SELECT_ARC_IN, time_s, in, (uint32_t) sizeof(*in));
        status = check_select_arc(ctx, in);
        report_refusal(time_s, NAV_DP_SELECT_ARC_IN, status);
        if (status == NAV_OK)
        {
            status = select_arc(ctx, in, out);
            report_selection(ctx, time_s, out);
        }
        out->status = (uint32_t) status;
        send(NAV_DP_SELECT_ARC_OUT, time_s, out,
             TRIMMED(nav_select_arc_out_t, global_points, out->global_point_count,
                     (uint32_t) NAV_GLOBAL_POINTS_MAX));
    }
    return status;
}

static nav_status_t check_evaluate_arc(const nav_ctx_t *ctx, const nav_evaluate_arc_in_t *in)
{
    nav_status_t status = check_context(ctx);
    if (status == NAV_OK)
    {
        const nav_status_t checks[6] = {
            check_time(ctx, in->time_s),
            check_pose(&in->pose),
            check_uncertainty(&in->uncertainty),
            check_range(in->arc.length_m, -ARC_LENGTH_MAX_M, ARC_LENGTH_MAX_M),
            check_range(in->arc.heading_change_rad, -2.0 * NAV_PI, 2.0 * NAV_PI),
            check_mode(in->mode),
        };
        status = first_error(checks, 6U);
    }
    if ((status == NAV_OK) && (ctx->is_analyzed == 0U))
    {
        status = NAV_ORDER;
    }
    return status;
}

/** Zones in every mode, terrain in Guarded and Avoid All. */
static nav_reason_t evaluate_pose(nav_ctx_t *ctx,
                                  const nav_evaluate_arc_in_t *in,
                                  const nav_pose2_t *pose,
                                  double distance_m,
                                  nav_ace_bounds_t *bounds)
{
    const nav_ace_scene_t scene = ace_scene(ctx);
    const bool test_terrain =
        (in->mode == (uint32_t) NAV_MODE_GUARDED) || (in->mode == (uint32_t) NAV_MODE_AVOID_ALL);
    const nav_uncertainty_t grown = nav_ace_grow(&ctx->params, &in->uncertainty, distance_m);
    nav_reason_t reason = NAV_REASON_NONE;

    nav_ace_evaluate(&scene, pose, &grown,
                     (in->is_leaving != 0U) && (distance_m <= ctx->params.leave_length_m), bounds);
    if (nav_kioz_forbids(&ctx->kioz, pose->x_m, pose->y_m, in->uncertainty.global_position_m))
    {
        reason = NAV_REASON_KIOZ;
    }
    else if (test_terrain)
    {
        reason = (nav_reason_t) bounds->reason;
    }
    else
    {
        reason = NAV_REASON_NONE;
    }
    return reason;
}

static void evaluate_arc(nav_ctx_t *ctx,
                         const nav_evaluate_arc_in_t *in,
                         nav_evaluate_arc_out_t *out)
{
    const nav_pose2_t start = {in->pose.x_site_m, in->pose.y_site_m, in->pose.yaw_rad};
    const bool is_turn = fabs(in->arc.length_m) <= 0.0;
    const double whole = is_turn ? in->arc.heading_change_rad : in->arc.length_m;

    out->pose_count = nav_arc_pose_count(&ctx->params, &in->arc);
    out->failing_index = out->pose_count;
    for (uint32_t k = 0U; k < out->pose_count; k++)
    {
        const double fraction = (double) (k + 1U) / (double) out->pose_count;
        const nav_pose2_t pose = nav_arc_pose(&start, &in->arc, fraction);
        const nav_reason_t reason =
            evaluate_pose(ctx, in, &pose, fraction * fabs(in->arc.length_m), &out->bounds[k]);
        if ((reason != NAV_REASON_NONE) && (out->failing_index == out->pose_count))
        {
            out->failing_index = k;
            out->failing_at = fraction * whole;
            out->reason = (uint32_t) reason;
        }
    }
    out->is_safe = (out->failing_index == out->pose_count) ? 1U : 0U;
}

nav_status_t nav_evaluate_arc(nav_ctx_t *ctx,
                              const nav_evaluate_arc_in_t *in,
                              nav_evaluate_arc_out_t *out)
{
    nav_status_t status = check_pointers(ctx, in, out);
    if (status == NAV_OK)
    {
        const double time_s = report_time_s(in->time_s);
        (void) memset(out, 0, sizeof(*out));
        send(NAV_DP_EVALUATE_ARC_IN, time_s, in, (uint32_t) sizeof(*in));
        status = check_evaluate_arc(ctx, in);
        if (status == NAV_OK)
        {
            ctx->time_s = in->time_s;
            evaluate_arc(ctx, in, out);
            if (out->is_safe == 0U)
            {
                nav_evr_report(time_s, NAV_EVR_ARC_UNSAFE, out->failing_at,
                               (double) out->failing_index, (double) out->reason, 0.0);
            }
        }
        report_refusal(time_s, NAV_DP_EVALUATE_ARC_IN, status);
        out->status = (uint32_t) status;
        send(
            NAV_DP_EVALUATE_ARC_OUT, time_s, out,
            TRIMMED(nav_evaluate_arc_out_t, bounds, out->pose_count, (uint32_t) NAV_ARC_POSES_MAX));
    }
    return status;
}
