/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_trial.h
 * @brief Private to Navlib: tests walks and paths by zones and by ACE, each shared arc once.
 */
#ifndef NAV_TRIAL_H
#define NAV_TRIAL_H

#include "nav_walk.h"

/** A round of tests. */
typedef struct
{
    const nav_request_t *request;
    nav_tree_t *tree;         /* verdicts and bounds of what has been tested are kept in it */
    bool is_leaving;          /* the leave limits apply */
    uint32_t ace_evaluations; /* so far */
} nav_trial_t;

/** Begins a round: nothing has been tested. */
void nav_trial_begin(nav_trial_t *trial);

/** Bounds that anything else is worse than. */
void nav_trial_best(nav_ace_bounds_t *bounds);

/** Tests an arc from the start of the request, or a turn in place, and worsens the bounds. */
nav_reason_t nav_trial_arc(nav_trial_t *trial, const nav_arc_t *arc, nav_ace_bounds_t *bounds);

/** May a turn and a first arc of the tree still pass, for all that has been tested? */
bool nav_trial_may_pass(const nav_trial_t *trial, uint32_t node);

/** Tests what of a turn and a first arc has not been tested before; their bounds are in the tree. */
nav_reason_t nav_trial_first(nav_trial_t *trial, uint32_t node);

/**
 * Tests the second arc of a path of the tree whose turn and first arc have passed. The bounds are the
 * worst of the whole path.
 */
nav_reason_t nav_trial_second(nav_trial_t *trial, uint32_t path, nav_ace_bounds_t *bounds);

/** Tests the rest of the path selected before. */
nav_reason_t nav_trial_kept(nav_trial_t *trial, nav_ace_bounds_t *bounds);

#endif
