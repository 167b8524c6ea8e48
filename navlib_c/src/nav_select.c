/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_select.c
 * @brief Selects the path to drive: candidates, last resorts, leave limits.
 */
#include "nav_select.h"

#include "nav_guard.h"
#include "nav_rank.h"
#include "nav_show.h"
#include "nav_trial.h"

#define FIRST_ARCS ((uint32_t) NAV_TREE_FIRST_ARCS)

/** Tests over candidates that are ranked. */
typedef struct
{
    nav_trial_t trial;
    uint32_t candidate_count;
    uint32_t budget_end; /* of the trial's ace_evaluations */
} selection_t;

/** Why the candidates after one that was tested are not: because one passed, or the budget is used up. */
static nav_reason_t reason_of_rest(const selection_t *selection, nav_reason_t tested)
{
    nav_reason_t rest = NAV_REASON_NONE;
    if ((tested == NAV_REASON_NONE) || selection->trial.request->is_one_path)
    {
        rest = NAV_REASON_COST;
    }
    else if (selection->trial.ace_evaluations >= selection->budget_end)
    {
        rest = NAV_REASON_BUDGET;
    }
    else
    {
        rest = NAV_REASON_NONE;
    }
    return rest;
}

/** Tests what of a candidate has not been tested before; bounds are its worst when it passes. */
static nav_reason_t test_candidate(nav_trial_t *trial, uint32_t path, nav_ace_bounds_t *bounds)
{
    nav_reason_t reason = NAV_REASON_NONE;
    if (path == NAV_RANK_KEPT)
    {
        reason = nav_trial_kept(trial, bounds);
    }
    else
    {
        reason = nav_trial_first(trial, path / (uint32_t) NAV_TREE_ARCS);
        if (reason == NAV_REASON_NONE)
        {
            reason = nav_trial_second(trial, path, bounds);
        }
    }
    return reason;
}

/** Tests the tree's paths from the cheapest, then, if none passed, the rest of the path selected
 * before. Paths not reached are rejected by cost or by the budget. */
static void test_candidates(selection_t *selection, nav_select_arc_out_t *out)
{
    nav_tree_t *tree = selection->trial.tree;
    nav_reason_t rest = NAV_REASON_NONE;

    for (uint32_t k = 0U; k < selection->candidate_count; k++)
    {
        const uint32_t path = tree->order[k];
        nav_reason_t reason = (nav_reason_t) tree->path_reason[path];
        if (reason == NAV_REASON_NONE)
        {
            /* the last resort is a few poses: the budget does not keep it from being tested */
            if ((rest == NAV_REASON_NONE) ||
                ((rest == NAV_REASON_BUDGET) && (path == NAV_RANK_KEPT)))
            {
                reason = test_candidate(&selection->trial, path, &out->bounds);
                out->paths_tested++;
                rest = reason_of_rest(selection, reason);
                if (reason == NAV_REASON_NONE)
                {
                    out->path_index = path;
                    out->path_cost_s = tree->path_cost_s[path];
                }
            }
            else
            {
                reason = rest;
            }
        }
        tree->path_reason[path] = (uint8_t) reason;
        out->rejections[reason]++;
    }
}

/** The cheapest first arc that may still pass; NAV_TREE_FIRST_ARCS when there is none. */
static uint32_t cheapest_first(const nav_trial_t *trial)
{
    uint32_t cheapest = FIRST_ARCS;
    double least_s = NAV_COST_INFINITE;
    for (uint32_t node = 0U; node < FIRST_ARCS; node++)
    {
        if (nav_trial_may_pass(trial, node) && (trial->tree->first_cost_s[node] < least_s))
        {
            least_s = trial->tree->first_cost_s[node];
            cheapest = node;
        }
    }
    return cheapest;
}

/** Takes the cheapest first arc that passes, if one does. */
static void take_short(nav_trial_t *trial, nav_select_arc_out_t *out)
{
    uint32_t node = cheapest_first(trial);
    bool is_found = false;
    /* every test refuses one more, or finds one */
    for (uint32_t k = 0U; NAV_ALWAYS(k <= FIRST_ARCS) && (node < FIRST_ARCS) && !is_found; k++)
    {
        is_found = nav_trial_first(trial, node) == NAV_REASON_NONE;
        if (is_found)
        {
            out->path_index = (uint32_t) NAV_TREE_SHORT + node;
            out->bounds = trial->tree->first_bounds[node];
            out->path_cost_s = trial->tree->first_cost_s[node];
        }
        else
        {
            /* refused now: another one is the cheapest */
            node = cheapest_first(trial);
        }
    }
}

/** Takes the cheapest arc backwards that passes, if one does. */
static void take_back(nav_trial_t *trial, nav_select_arc_out_t *out)
{
    double least_s = NAV_COST_INFINITE;
    for (uint32_t k = 0U; k < (uint32_t) NAV_TREE_ARCS; k++)
    {
        const nav_arc_t arc = nav_walk_back_arc(trial->request, k);
        const double cost_s = nav_rank_arc(trial->request, &arc);
        if (cost_s < least_s)
        {
            nav_ace_bounds_t bounds;
            nav_trial_best(&bounds);
            if (nav_trial_arc(trial, &arc, &bounds) == NAV_REASON_NONE)
            {
                least_s = cost_s;
                out->path_index = (uint32_t) NAV_TREE_BACK + k;
                out->bounds = bounds;
                out->path_cost_s = cost_s;
            }
        }
    }
}

static bool is_found(const nav_select_arc_out_t *out)
{
    return out->path_index < (uint32_t) NAV_TREE_NONE;
}

/** Tests all candidates, then, where the mode looks for more than one path, the last resorts. */
static void test_all(selection_t *selection, nav_select_arc_out_t *out)
{
    test_candidates(selection, out);
    if (!is_found(out) && !selection->trial.request->is_one_path)
    {
        take_short(&selection->trial, out);
    }
    if (!is_found(out) && !selection->trial.request->is_one_path)
    {
        take_back(&selection->trial, out);
    }
}

/** Makes the paths that ACE refused untested again, for the leave limits. */
static void begin_leaving(selection_t *selection, nav_select_arc_out_t *out)
{
    nav_tree_t *tree = selection->trial.tree;
    selection->trial.is_leaving = true;
    selection->budget_end += selection->trial.ace_evaluations;
    nav_trial_begin(&selection->trial);
    for (uint32_t path = 0U; path < selection->candidate_count; path++)
    {
        if (tree->path_cost_s[path] < NAV_COST_INFINITE)
        {
            tree->path_reason[path] = (uint8_t) NAV_REASON_NONE;
        }
    }
    for (uint32_t reason = 0U; reason < (uint32_t) NAV_REASON_COUNT; reason++)
    {
        out->rejections[reason] = 0U;
    }
}

void nav_select_path(nav_tree_t *tree,
                     const nav_tree_scene_t *scene,
                     const nav_select_arc_in_t *in,
                     nav_select_arc_out_t *out)
{
    const nav_request_t request = nav_walk_request(scene, in);
    selection_t selection = {.trial = {.request = &request, .tree = tree},
                             .candidate_count = nav_rank_candidates(&request, tree),
                             .budget_end = (uint32_t) request.params->ace_budget_poses};

    out->path_index = (uint32_t) NAV_TREE_NONE;
    nav_trial_begin(&selection.trial);
    test_all(&selection, out);
    if (!is_found(out) && request.test_terrain && !request.is_one_path)
    {
        begin_leaving(&selection, out);
        test_all(&selection, out);
        out->is_leaving = is_found(out) ? 1U : 0U;
    }
    out->ace_evaluations = selection.trial.ace_evaluations;
    if (is_found(out))
    {
        out->status = (uint32_t) NAV_OK;
        nav_show_path(&request, tree, out);
    }
    else
    {
        out->status = (uint32_t) NAV_NO_PATH;
        out->bounds = (nav_ace_bounds_t){0};
        tree->kept.is_kept = 0U;
    }
}
