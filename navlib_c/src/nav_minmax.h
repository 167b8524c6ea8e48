/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_minmax.h
 * @brief Private to Navlib: lesser and greater of two numbers, inline because inner loops need them.
 *
 * In single precision for loops over batches: compilers turn these, not comparisons in the loops
 * themselves, into instructions for several numbers at once.
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

/** The lesser in single precision; b where one is a NaN. */
static inline float nav_min_f(float a, float b)
{
    return (a < b) ? a : b;
}

/** The greater in single precision; b where one is a NaN. */
static inline float nav_max_f(float a, float b)
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
