/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_minmax.h
 * @brief Private to Navlib: lesser and greater of two numbers, inline because inner loops need them.
 */
#ifndef NAV_MINMAX_H
#define NAV_MINMAX_H

/** The lesser; b where one is a NaN. */
static inline double nav_min(double a, double b)
{
    return (a < b) ? a : b;
}

/** The greater; b where one is a NaN. */
static inline double nav_max(double a, double b)
{
    return (a > b) ? a : b;
}

/** The nearest number to x within [low, high]; a NaN stays one. */
static inline double nav_clamp(double x, double low, double high)
{
    const double raised = (x < low) ? low : x;
    return (raised > high) ? high : raised;
}

#endif
