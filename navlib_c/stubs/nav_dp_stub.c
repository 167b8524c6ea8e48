/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_dp_stub.c
 * @brief One fixed buffer of data products, drained by the host.
 */
#include "nav_dp_stub.h"

#include <string.h>

#define NAV_STUB_ALIGN 8U
#define NAV_STUB_BYTES ((uint32_t) NAV_STUB_BUFFER_BYTES)
#define NAV_STUB_HEADER_BYTES ((uint32_t) sizeof(nav_stub_header_t))

_Static_assert((NAV_STUB_BYTES % NAV_STUB_ALIGN) == 0U, "records start at multiples of 8");
_Static_assert((sizeof(nav_stub_header_t) % NAV_STUB_ALIGN) == 0U,
               "records start at multiples of 8");

typedef struct
{
    uint64_t words[NAV_STUB_BYTES / NAV_STUB_ALIGN];
    uint32_t size_bytes;
    uint32_t lost_count;
} nav_stub_t;

static nav_stub_t stub;

const uint8_t *nav_stub_data(void)
{
    return (const uint8_t *) stub.words;
}

uint32_t nav_stub_size(void)
{
    return stub.size_bytes;
}

uint32_t nav_stub_lost_count(void)
{
    return stub.lost_count;
}

void nav_stub_clear(void)
{
    stub.size_bytes = 0U;
    stub.lost_count = 0U;
}

nav_status_t nav_dp_send(nav_dp_kind_t kind, double time_s, const void *record, uint32_t size_bytes)
{
    const uint32_t free_bytes = NAV_STUB_BYTES - stub.size_bytes;
    nav_status_t status = NAV_SINK;

    if ((record != NULL) && (free_bytes >= NAV_STUB_HEADER_BYTES) &&
        (size_bytes <= (free_bytes - NAV_STUB_HEADER_BYTES)))
    {
        const nav_stub_header_t header = {
            .time_s = time_s, .kind = (uint32_t) kind, .size_bytes = size_bytes};
        const uint32_t padding = (NAV_STUB_ALIGN - (size_bytes % NAV_STUB_ALIGN)) % NAV_STUB_ALIGN;
        const void *source = &header;
        uint8_t *place = &((uint8_t *) stub.words)[stub.size_bytes];

        (void) memcpy(place, source, sizeof(header));
        (void) memcpy(&place[NAV_STUB_HEADER_BYTES], record, size_bytes);
        (void) memset(&place[NAV_STUB_HEADER_BYTES + size_bytes], 0, padding);
        stub.size_bytes += NAV_STUB_HEADER_BYTES + size_bytes + padding;
        status = NAV_OK;
    }
    else
    {
        stub.lost_count += 1U;
    }
    return status;
}
