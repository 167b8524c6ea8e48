/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_guard.h
 * @brief Guards against states that only a defect can produce.
 *
 * They stay in flight builds as plain conditions; coverage builds make them constants, so that a
 * branch nobody can reach does not count as untested.
 */
#ifndef NAV_GUARD_H
#define NAV_GUARD_H

#if defined(NAV_COVERAGE)
#define NAV_ALWAYS(x) (true)
#define NAV_NEVER(x) (false)
#else
#define NAV_ALWAYS(x) (x)
#define NAV_NEVER(x) (x)
#endif

#endif
