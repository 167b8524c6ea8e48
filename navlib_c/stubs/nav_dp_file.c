/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_dp_file.c
 * @brief The header's description is made from the tables of the records; it is written twice: first
 * only to count its bytes, which stand before it.
 */
#include "nav_dp_file.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "nav_host.h"

#define ALIGNMENT_BYTES 8U
#define BYTE_ORDER_MARK 0x01020304U
#define FORMAT_VERSION 1U
#define RECORD_MARK 0x52444E45U
#define CRC_POLYNOMIAL 0xEDB88320U
#define CRC_ALL_ONES 0xFFFFFFFFU

static const char magic[8] = {'E', 'N', 'A', 'V', 'D', 'P', '\r', '\n'};
static const uint8_t zeros[ALIGNMENT_BYTES];

#define ENUM_NAME(value, name, text) #name,
static const char *const status_names[] = {NAV_STATUS_TABLE(ENUM_NAME)};
static const char *const reason_names[] = {NAV_REASON_TABLE(ENUM_NAME)};
static const char *const mode_names[] = {NAV_MODE_TABLE(ENUM_NAME)};
static const char *const activity_names[] = {NAV_HOST_ACTIVITY_TABLE(ENUM_NAME)};

/* --- bytes and checksums ----------------------------------------------------------------------- */

/** Four bits at a time: a table of 64 bytes, fast enough for point clouds. */
static uint32_t crc_of(uint32_t crc, const void *data, uint32_t size_bytes)
{
    const uint8_t *bytes = (const uint8_t *) data;
    uint32_t table[16];
    for (uint32_t k = 0U; k < 16U; k++)
    {
        table[k] = k;
        for (int bit = 0; bit < 4; bit++)
        {
            table[k] = (table[k] >> 1U) ^ (((table[k] & 1U) != 0U) ? CRC_POLYNOMIAL : 0U);
        }
    }
    crc ^= CRC_ALL_ONES;
    for (uint32_t k = 0U; k < size_bytes; k++)
    {
        crc ^= bytes[k];
        crc = (crc >> 4U) ^ table[crc & 15U];
        crc = (crc >> 4U) ^ table[crc & 15U];
    }
    return crc ^ CRC_ALL_ONES;
}

static uint32_t padding_of(uint32_t size_bytes)
{
    return (ALIGNMENT_BYTES - (size_bytes % ALIGNMENT_BYTES)) % ALIGNMENT_BYTES;
}

static void put(nav_dp_file_t *file, const void *data, uint32_t size_bytes)
{
    const bool is_open = file->stream != NULL;
    file->is_bad = file->is_bad || !(is_open || file->is_counting);
    if (is_open && !file->is_bad)
    {
        file->is_bad = fwrite(data, 1U, size_bytes, (FILE *) file->stream) != size_bytes;
        file->crc = crc_of(file->crc, data, size_bytes);
    }
    file->size_bytes += size_bytes;
}

static void put_u32(nav_dp_file_t *file, uint32_t value)
{
    put(file, &value, (uint32_t) sizeof(value));
}

static void put_text(nav_dp_file_t *file, const char *text)
{
    put(file, text, (uint32_t) strlen(text));
}

static void put_number(nav_dp_file_t *file, uint32_t number)
{
    char text[16];
    (void) snprintf(text, sizeof(text), "%" PRIu32, number);
    put_text(file, text);
}

/** A JSON string; the tables hold no control characters. */
static void put_string(nav_dp_file_t *file, const char *text)
{
    put_text(file, "\"");
    for (const char *at = text; *at != '\0'; at++)
    {
        if ((*at == '"') || (*at == '\\'))
        {
            put_text(file, "\\");
        }
        put(file, at, 1U);
    }
    put_text(file, "\"");
}

static void put_key(nav_dp_file_t *file, const char *key, bool is_first)
{
    put_text(file, is_first ? "{\"" : ",\"");
    put_text(file, key);
    put_text(file, "\":");
}

static void put_pair(nav_dp_file_t *file, const char *key, const char *text, bool is_first)
{
    put_key(file, key, is_first);
    put_string(file, text);
}

static void put_comma(nav_dp_file_t *file, uint32_t index)
{
    put_text(file, (index == 0U) ? "" : ",");
}

/* --- the description --------------------------------------------------------------------------- */

static void put_names(nav_dp_file_t *file, const char *const *names, uint32_t count)
{
    put_text(file, "[");
    for (uint32_t k = 0U; k < count; k++)
    {
        put_comma(file, k);
        put_string(file, names[k]);
    }
    put_text(file, "]");
}

static void put_enums(nav_dp_file_t *file)
{
    put_key(file, "nav_status_t", true);
    put_names(file, status_names, (uint32_t) NAV_STATUS_COUNT);
    put_key(file, "nav_reason_t", false);
    put_names(file, reason_names, (uint32_t) NAV_REASON_COUNT);
    put_key(file, "nav_mode_t", false);
    put_names(file, mode_names, (uint32_t) NAV_MODE_COUNT);
    put_key(file, "nav_host_activity_t", false);
    put_names(file, activity_names, (uint32_t) NAV_HOST_ACTIVITY_COUNT);
    put_text(file, "}");
}

static void put_events(nav_dp_file_t *file,
                       const nav_evr_def_t *rows,
                       uint32_t count,
                       bool is_first)
{
    for (uint32_t k = 0U; k < count; k++)
    {
        put_comma(file, is_first ? k : 1U);
        put_key(file, "id", true);
        put_number(file, rows[k].id);
        put_pair(file, "name", rows[k].name, false);
        put_pair(file, "text", rows[k].text, false);
        put_text(file, "}");
    }
}

static void put_kinds(nav_dp_file_t *file, const nav_dp_def_t *rows, uint32_t count, bool is_first)
{
    for (uint32_t k = 0U; k < count; k++)
    {
        put_comma(file, is_first ? k : 1U);
        put_key(file, "kind", true);
        put_number(file, rows[k].kind);
        put_pair(file, "name", rows[k].name, false);
        put_pair(file, "type", rows[k].type, false);
        put_pair(file, "doc", rows[k].doc, false);
        put_text(file, "}");
    }
}

static void put_parameters(nav_dp_file_t *file)
{
    put_text(file, "[");
    for (uint32_t k = 0U; k < (uint32_t) NAV_PARAM_COUNT; k++)
    {
        put_comma(file, k);
        put_string(file, nav_param_defs[k].name);
    }
    put_text(file, "]");
}

static void put_field(nav_dp_file_t *file, const nav_field_def_t *field)
{
    put_pair(file, "name", field->name, true);
    put_pair(file, "type", field->type, false);
    put_key(file, "count", false);
    put_number(file, field->count);
    put_key(file, "offset", false);
    put_number(file, field->offset);
    put_pair(file, "unit", field->unit, false);
    put_pair(file, "doc", field->doc, false);
    put_text(file, "}");
}

static void put_records(nav_dp_file_t *file,
                        const nav_record_def_t *rows,
                        uint32_t count,
                        bool is_first)
{
    for (uint32_t k = 0U; k < count; k++)
    {
        put_comma(file, is_first ? k : 1U);
        put_pair(file, "type", rows[k].type, true);
        put_key(file, "size_bytes", false);
        put_number(file, rows[k].size);
        put_key(file, "fields", false);
        put_text(file, "[");
        for (uint32_t i = 0U; i < rows[k].field_count; i++)
        {
            put_comma(file, i);
            put_field(file, &rows[k].fields[i]);
        }
        put_text(file, "]}");
    }
}

static void put_description(nav_dp_file_t *file, const char *drive_json)
{
    put_key(file, "drive", true);
    put_text(file, drive_json);
    put_key(file, "enums", false);
    put_enums(file);
    put_key(file, "events", false);
    put_text(file, "[");
    put_events(file, nav_evr_defs, (uint32_t) NAV_EVR_COUNT, true);
    put_events(file, nav_host_evr_defs, (uint32_t) NAV_HOST_EVR_COUNT, false);
    put_text(file, "]");
    put_key(file, "kinds", false);
    put_text(file, "[");
    put_kinds(file, nav_dp_defs, (uint32_t) NAV_DP_COUNT, true);
    put_kinds(file, nav_host_dp_defs, (uint32_t) NAV_HOST_DP_COUNT, false);
    put_text(file, "]");
    put_key(file, "parameters", false);
    put_parameters(file);
    put_key(file, "records", false);
    put_text(file, "[");
    put_records(file, nav_record_defs, (uint32_t) NAV_RECORD_COUNT, true);
    put_records(file, nav_host_record_defs, (uint32_t) NAV_HOST_RECORD_COUNT, false);
    put_text(file, "]}");
    for (uint32_t k = padding_of(file->size_bytes); k > 0U; k--)
    {
        put_text(file, " ");
    }
}

static uint32_t description_bytes(const char *drive_json)
{
    nav_dp_file_t counted = {.is_counting = true};
    put_description(&counted, drive_json);
    return counted.size_bytes;
}

/* --- the file ---------------------------------------------------------------------------------- */

bool nav_dp_file_open(nav_dp_file_t *file, const char *path, const char *drive_json)
{
    (void) memset(file, 0, sizeof(*file));
    file->stream = fopen(path, "wb");
    put(file, magic, (uint32_t) sizeof(magic));
    put_u32(file, BYTE_ORDER_MARK);
    put_u32(file, FORMAT_VERSION);
    put_u32(file, (uint32_t) NAV_DP_VERSION);
    put_u32(file, description_bytes(drive_json));
    put_description(file, drive_json);
    put_u32(file, file->crc);
    put_u32(file, 0U);
    return !file->is_bad;
}

bool nav_dp_file_write(
    nav_dp_file_t *file, uint32_t kind, double time_s, const void *payload, uint32_t size_bytes)
{
    file->crc = 0U;
    put_u32(file, RECORD_MARK);
    put_u32(file, kind);
    put_u32(file, size_bytes);
    put_u32(file, file->sequence);
    put(file, &time_s, (uint32_t) sizeof(time_s));
    put_u32(file, file->crc);
    put_u32(file, crc_of(0U, payload, size_bytes));
    put(file, payload, size_bytes);
    put(file, zeros, padding_of(size_bytes));
    file->sequence += 1U;
    return !file->is_bad;
}

bool nav_dp_file_flush(nav_dp_file_t *file)
{
    if ((file->stream != NULL) && !file->is_bad)
    {
        file->is_bad = fflush((FILE *) file->stream) != 0;
    }
    return !file->is_bad;
}

bool nav_dp_file_close(nav_dp_file_t *file)
{
    if (file->stream != NULL)
    {
        file->is_bad = (fclose((FILE *) file->stream) != 0) || file->is_bad;
        file->stream = NULL;
    }
    return !file->is_bad;
}
