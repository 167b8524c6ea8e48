/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_dp_stub.h
 * @brief Stands in for flight's data product and event report services: keeps both, in the order in
 * which they came, in one fixed buffer that the host drains after each call.
 */
#ifndef NAV_DP_STUB_H
#define NAV_DP_STUB_H

#include "nav_dp.h"

/** Bytes the buffer holds: a call that also sends tree, surface and costmap, with room to spare. */
#define NAV_STUB_BUFFER_BYTES 4194304

/** Stands before each record in the buffer; records start at multiples of 8 bytes. */
typedef struct
{
    double time_s;
    uint32_t kind;
    uint32_t size_bytes; /* of the record, without the padding behind it */
} nav_stub_header_t;

/** The records captured since the last clear: header, record, padding; header, record, ... */
const uint8_t *nav_stub_data(void);
/** Bytes in use. */
uint32_t nav_stub_size(void);
/** Records that did not fit since the last clear; Navlib was told NAV_SINK. */
uint32_t nav_stub_lost_count(void);
/** Empties the buffer. */
void nav_stub_clear(void);

#endif
