/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_evr.c
 * @brief The table of event reports.
 */
#include "nav_evr.h"

#define NAV_EVR_DEF(value, name, severity, count, text, cause, args)                               \
    {(value), NAV_EVR_##severity, (count), #name, (text), (cause), (args)},

const nav_evr_def_t nav_evr_defs[NAV_EVR_COUNT] = {NAV_EVR_TABLE(NAV_EVR_DEF)};

void nav_evr_report(
    double time_s, nav_evr_id_t id, double arg0, double arg1, double arg2, double arg3)
{
    const double args[NAV_EVR_ARGS_MAX] = {arg0, arg1, arg2, arg3};
    nav_evr_t evr = {0};

    evr.time_s = time_s;
    evr.id = (uint32_t) id;
    evr.severity = (uint32_t) NAV_EVR_WARNING_HIGH;
    for (uint32_t row = 0U; row < (uint32_t) NAV_EVR_COUNT; row++)
    {
        if (nav_evr_defs[row].id == evr.id)
        {
            evr.severity = (uint32_t) nav_evr_defs[row].severity;
            evr.arg_count = nav_evr_defs[row].arg_count;
        }
    }
    for (uint32_t arg = 0U; arg < (uint32_t) NAV_EVR_ARGS_MAX; arg++)
    {
        if (arg < evr.arg_count)
        {
            evr.args[arg] = args[arg];
        }
    }
    nav_evr_send(&evr);
}
