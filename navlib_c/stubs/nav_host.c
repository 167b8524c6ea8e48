/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_host.c
 * @brief Descriptions of the simulator's records, made as nav_dp.c makes those of Navlib.
 */
#include "nav_host.h"

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
NAV_HOST_RECORD_TABLE(NAV_ASSERT_PACKED)

/* MISRA deviation 20.5: the macro names one record after another. */
/* cppcheck-suppress-begin misra-c2012-20.5 */
#define NAV_ROW_OF nav_host_truth_t
static const nav_field_def_t fields_nav_host_truth_t[] = {NAV_ROWS(NAV_HOST_TRUTH_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_host_estimate_t
static const nav_field_def_t fields_nav_host_estimate_t[] = {NAV_ROWS(NAV_HOST_ESTIMATE_FIELDS)};
#undef NAV_ROW_OF

#define NAV_ROW_OF nav_host_timeline_t
static const nav_field_def_t fields_nav_host_timeline_t[] = {NAV_ROWS(NAV_HOST_TIMELINE_FIELDS)};
#undef NAV_ROW_OF
/* cppcheck-suppress-end misra-c2012-20.5 */

#define NAV_FIELDS_OF(type) fields_##type
#define NAV_RECORD_DEF(type, FIELDS)                                                               \
    {NAV_TEXT(type), (uint32_t) sizeof(type),                                                      \
     (uint32_t) (sizeof(NAV_FIELDS_OF(type)) / sizeof(nav_field_def_t)), NAV_FIELDS_OF(type)},
const nav_record_def_t nav_host_record_defs[NAV_HOST_RECORD_COUNT] = {
    NAV_HOST_RECORD_TABLE(NAV_RECORD_DEF)};

#define NAV_DP_DEF(value, name, type, doc) {(value), NAV_TEXT(name), NAV_TEXT(type), (doc)},
const nav_dp_def_t nav_host_dp_defs[NAV_HOST_DP_COUNT] = {NAV_HOST_DP_TABLE(NAV_DP_DEF)};

#define NAV_HOST_EVR_DEF(value, name, severity, count, text, cause, args)                          \
    {(value), NAV_EVR_##severity, (count), NAV_TEXT(name), (text), (cause), (args)},
const nav_evr_def_t nav_host_evr_defs[NAV_HOST_EVR_COUNT] = {NAV_HOST_EVR_TABLE(NAV_HOST_EVR_DEF)};
