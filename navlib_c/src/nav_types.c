/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_types.c
 * @brief Texts of statuses and reasons.
 */
#include "nav_types.h"

#define NAV_TEXT_ROW(value, name, text) [(value)] = (text),

const char *nav_status_text(nav_status_t status)
{
    static const char *const texts[NAV_STATUS_COUNT] = {NAV_STATUS_TABLE(NAV_TEXT_ROW)};
    const uint32_t index = (uint32_t) status;
    const char *text = "unknown status";

    if (index < (uint32_t) NAV_STATUS_COUNT)
    {
        text = texts[index];
    }
    return text;
}

const char *nav_reason_text(nav_reason_t reason)
{
    static const char *const texts[NAV_REASON_COUNT] = {NAV_REASON_TABLE(NAV_TEXT_ROW)};
    const uint32_t index = (uint32_t) reason;
    const char *text = "unknown reason";

    if (index < (uint32_t) NAV_REASON_COUNT)
    {
        text = texts[index];
    }
    return text;
}
