/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_math.h
 * @brief Elementary functions from IEEE basic operations, the same bits on every target.
 *
 * libm's sin, cos and atan2 differ between C libraries in the last bit; these use only + - * / and
 * sqrt, fabs, floor, which IEEE 754 defines exactly. Error bounds are tested against libm.
 */
#ifndef NAV_MATH_H
#define NAV_MATH_H

#include <stdbool.h>
#include <stdint.h>

#define NAV_PI 3.14159265358979323846

/** True unless x is a NaN or an infinity; looks at the bits only. */
bool nav_isfinite(double x);

/** Sine; |error| <= 1e-15 for |angle| <= 1e4 rad. */
double nav_sin(double angle_rad);
/** Cosine; |error| <= 1e-15 for |angle| <= 1e4 rad. */
double nav_cos(double angle_rad);
/** Both, to the same bits; cheaper than one after the other, most of all for small angles. */
void nav_sincos(double angle_rad, double *sine, double *cosine);
/** Arc tangent of y / x in (-pi, pi]; |error| <= 1e-15; (0, 0) gives 0. */
double nav_atan2(double y, double x);
/** Arc sine of x clamped to [-1, 1]; |error| <= 2e-15. */
double nav_asin(double x);
/** Arc cosine of x clamped to [-1, 1]; |error| <= 2e-15. */
double nav_acos(double x);

/** The angle plus a multiple of 2 pi, in [-pi, pi). */
double nav_wrap_angle(double angle_rad);

/**
 * The one float-to-integer conversion of Navlib: floor(x) as an index.
 * @return false, and *index = 0, when x is not finite or |x| >= 2^30.
 */
bool nav_floor_index(double x, int32_t *index);

/** index modulo size in [0, size) for any sign of index; size > 0. */
int32_t nav_wrap_index(int32_t index, int32_t size);

#endif
