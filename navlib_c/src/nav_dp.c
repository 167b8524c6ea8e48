/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_dp.c
 * @brief Descriptions of all records, made from their field rows.
 */
#include "nav_dp.h"

#include <stddef.h>

#define NAV_TEXT(name) #name

/* The rows of a record do not name it: NAV_ROW_OF does, once for each record below. */
#define NAV_ROW(type, name, count, unit, doc)                                                      \
    {NAV_TEXT(name),                                                                               \
     NAV_TEXT(type),                                                                               \
     (uint32_t) (sizeof(type[count]) / sizeof(type)),                                              \
     (uint32_t) offsetof(NAV_ROW_OF, name),                                                        \
     (unit),                                                                                       \
     (doc)},
#define NAV_ROW_S(type, name, unit, doc) NAV_ROW(type, name, 1, unit, doc)
#define NAV_ROW_A(type, name, count, unit, doc) NAV_ROW(type, name, count, unit, doc)
#define NAV_ROW_N(type, name, doc) NAV_ROW(type, name, 1, "", doc)
#define NAV_ROW_M(type, name, count, doc) NAV_ROW(type, name, count, "", doc)
#define NAV_ROWS(FIELDS) FIELDS(NAV_ROW_S, NAV_ROW_A, NAV_ROW_N, NAV_ROW_M)

#define NAV_SIZE_S(type, name, unit, doc) +sizeof(type)
#define NAV_SIZE_A(type, name, count, unit, doc) +sizeof(type[count])
#define NAV_SIZE_N(type, name, doc) +sizeof(type)
#define NAV_SIZE_M(type, name, count, doc) +sizeof(type[count])
#define NAV_ASSERT_PACKED(type, FIELDS)                                                            \
    _Static_assert((0U FIELDS(NAV_SIZE_S, NAV_SIZE_A, NAV_SIZE_N, NAV_SIZE_M)) == sizeof(type),    \
                   NAV_TEXT(type) " has implicit padding");
NAV_RECORD_TABLE(NAV_ASSERT_PACKED)

/* MISRA deviation 20.5: the macro names one record after another. */
/* cppcheck-suppress-begin misra-c2012-20.5 */
#define NAV_ROW_OF nav_pose_t
static const nav_field_def_t fields_nav_pose_t[] = {NAV_ROWS(NAV_POSE_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_uncertainty_t
static const nav_field_def_t fields_nav_uncertainty_t[] = {NAV_ROWS(NAV_UNCERTAINTY_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_waydisc_t
static const nav_field_def_t fields_nav_waydisc_t[] = {NAV_ROWS(NAV_WAYDISC_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_arc_t
static const nav_field_def_t fields_nav_arc_t[] = {NAV_ROWS(NAV_ARC_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_point_t
static const nav_field_def_t fields_nav_point_t[] = {NAV_ROWS(NAV_POINT_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_steering_t
static const nav_field_def_t fields_nav_steering_t[] = {NAV_ROWS(NAV_STEERING_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_zone_t
static const nav_field_def_t fields_nav_zone_t[] = {NAV_ROWS(NAV_ZONE_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_cost_cell_t
static const nav_field_def_t fields_nav_cost_cell_t[] = {NAV_ROWS(NAV_COST_CELL_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_ace_bounds_t
static const nav_field_def_t fields_nav_ace_bounds_t[] = {NAV_ROWS(NAV_ACE_BOUNDS_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_evr_t
static const nav_field_def_t fields_nav_evr_t[] = {NAV_ROWS(NAV_EVR_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_init_in_t
static const nav_field_def_t fields_nav_init_in_t[] = {NAV_ROWS(NAV_INIT_IN_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_init_out_t
static const nav_field_def_t fields_nav_init_out_t[] = {NAV_ROWS(NAV_INIT_OUT_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_set_kioz_in_t
static const nav_field_def_t fields_nav_set_kioz_in_t[] = {NAV_ROWS(NAV_SET_KIOZ_IN_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_set_kioz_out_t
static const nav_field_def_t fields_nav_set_kioz_out_t[] = {NAV_ROWS(NAV_SET_KIOZ_OUT_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_process_disparity_in_t
static const nav_field_def_t fields_nav_process_disparity_in_t[] = {
    NAV_ROWS(NAV_PROCESS_DISPARITY_IN_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_process_disparity_out_t
static const nav_field_def_t fields_nav_process_disparity_out_t[] = {
    NAV_ROWS(NAV_PROCESS_DISPARITY_OUT_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_analyze_terrain_in_t
static const nav_field_def_t fields_nav_analyze_terrain_in_t[] = {
    NAV_ROWS(NAV_ANALYZE_TERRAIN_IN_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_analyze_terrain_out_t
static const nav_field_def_t fields_nav_analyze_terrain_out_t[] = {
    NAV_ROWS(NAV_ANALYZE_TERRAIN_OUT_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_select_arc_in_t
static const nav_field_def_t fields_nav_select_arc_in_t[] = {NAV_ROWS(NAV_SELECT_ARC_IN_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_select_arc_out_t
static const nav_field_def_t fields_nav_select_arc_out_t[] = {NAV_ROWS(NAV_SELECT_ARC_OUT_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_evaluate_arc_in_t
static const nav_field_def_t fields_nav_evaluate_arc_in_t[] = {
    NAV_ROWS(NAV_EVALUATE_ARC_IN_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_evaluate_arc_out_t
static const nav_field_def_t fields_nav_evaluate_arc_out_t[] = {
    NAV_ROWS(NAV_EVALUATE_ARC_OUT_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_path_t
static const nav_field_def_t fields_nav_path_t[] = {NAV_ROWS(NAV_PATH_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_tree_t
static const nav_field_def_t fields_nav_tree_t[] = {NAV_ROWS(NAV_TREE_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_surface_t
static const nav_field_def_t fields_nav_surface_t[] = {NAV_ROWS(NAV_SURFACE_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_costmap_t
static const nav_field_def_t fields_nav_costmap_t[] = {NAV_ROWS(NAV_COSTMAP_FIELDS)};
#undef NAV_ROW_OF
/* cppcheck-suppress-end misra-c2012-20.5 */

#define NAV_FIELDS_OF(type) fields_##type
#define NAV_RECORD_DEF(type, FIELDS)                                                               \
    {NAV_TEXT(type), (uint32_t) sizeof(type),                                                      \
     (uint32_t) (sizeof(NAV_FIELDS_OF(type)) / sizeof(nav_field_def_t)), NAV_FIELDS_OF(type)},
const nav_record_def_t nav_record_defs[NAV_RECORD_COUNT] = {NAV_RECORD_TABLE(NAV_RECORD_DEF)};

#define NAV_DP_DEF(value, name, type, doc) {(value), NAV_TEXT(name), NAV_TEXT(type), (doc)},
const nav_dp_def_t nav_dp_defs[NAV_DP_COUNT] = {NAV_DP_TABLE(NAV_DP_DEF)};
