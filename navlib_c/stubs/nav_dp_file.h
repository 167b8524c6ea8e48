/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_dp_file.h
 * @brief Writes data product files (navlib_c/SPEC_DP.md) without Python: the same bytes for the same
 * records.
 *
 * An error stays: what is written after it is ignored, and every later call says so.
 */
#ifndef NAV_DP_FILE_H
#define NAV_DP_FILE_H

#include "nav_dp.h"

/** A file being written; its members belong to the functions below. */
typedef struct
{
    void *stream; /* FILE of <stdio.h>, NULL when closed */
    uint32_t crc;
    uint32_t sequence;
    uint32_t size_bytes;
    bool is_counting;
    bool is_bad;
} nav_dp_file_t;

/**
 * Makes a file, replacing one of that name, and writes its header.
 * @param drive_json  the object `drive` of the description, as JSON text
 * @return false when it cannot be written
 */
bool nav_dp_file_open(nav_dp_file_t *file, const char *path, const char *drive_json);

/** Appends a record; kind 0 is the end record. @return false after any error */
bool nav_dp_file_write(
    nav_dp_file_t *file, uint32_t kind, double time_s, const void *payload, uint32_t size_bytes);

/** Hands what was written to the operating system. @return false after any error */
bool nav_dp_file_flush(nav_dp_file_t *file);

/** Closes the file. @return true when everything has been written */
bool nav_dp_file_close(nav_dp_file_t *file);

#endif
