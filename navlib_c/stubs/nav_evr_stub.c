/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_evr_stub.c
 * @brief Event reports join the data products, so that their order is kept.
 */
#include "nav_dp.h"

void nav_evr_send(const nav_evr_t *evr)
{
    /* a report that does not fit is counted by the buffer */
    (void) nav_dp_send(NAV_DP_EVR, evr->time_s, evr, (uint32_t) sizeof(*evr));
}
