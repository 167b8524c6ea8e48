/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_math.c
 * @brief Elementary functions from IEEE basic operations.
 */
#include "nav_math.h"

#include <math.h>
#include <string.h>

#include "nav_minmax.h"

#define NAV_EXPONENT_MASK 0x7FF0000000000000ULL

/* pi/2 in three parts; a whole number below 2^20 times one of the first two is exact. */
#define NAV_HALF_PI_HIGH 1.57079632673412561416626
#define NAV_HALF_PI_MIDDLE 6.077100506303965976595549e-11
#define NAV_HALF_PI_LOW 2.022266248795950732399478e-21
#define NAV_HALF_PI 1.57079632679489661923132
/* A little more than pi/4: the multiple may be rounded either way at the middle between two. */
#define NAV_REMAINDER_MAX_RAD 0.79
#define NAV_HALF_TURNS_PER_RAD 0.636619772367581343075535

#define NAV_INDEX_LIMIT 1073741824.0

/* Nodes of the arc tangent: 0, 1/8, ... 1. */
#define NAV_ATAN_STEPS 8.0
#define NAV_ATAN_NODES 9U

typedef struct
{
    double remainder_rad; /* within pi/4 of 0, but for rounding */
    int32_t quadrant;     /* 0 to 3 */
} nav_reduced_t;

static double sin_near_zero(double x)
{
    const double xx = x * x;
    const double sum =
        (1.0 / 6.0) -
        (xx *
         ((1.0 / 120.0) -
          (xx * ((1.0 / 5040.0) -
                 (xx * ((1.0 / 362880.0) -
                        (xx * ((1.0 / 39916800.0) - (xx * ((1.0 / 6227020800.0) -
                                                           (xx * (1.0 / 1307674368000.0))))))))))));

    return x - (x * xx * sum);
}

static double cos_near_zero(double x)
{
    const double xx = x * x;
    const double sum =
        0.5 - (xx * ((1.0 / 24.0) -
                     (xx * ((1.0 / 720.0) -
                            (xx * ((1.0 / 40320.0) -
                                   (xx * ((1.0 / 3628800.0) -
                                          (xx * ((1.0 / 479001600.0) -
                                                 (xx * ((1.0 / 87178291200.0) -
                                                        (xx * (1.0 / 20922789888000.0))))))))))))));

    return 1.0 - (xx * sum);
}

/* Cody-Waite: the multiple of pi/2 is taken away part by part. */
static nav_reduced_t reduce(double angle_rad)
{
    const double multiple = floor((angle_rad * NAV_HALF_TURNS_PER_RAD) + 0.5);
    const double rest =
        ((angle_rad - (multiple * NAV_HALF_PI_HIGH)) - (multiple * NAV_HALF_PI_MIDDLE)) -
        (multiple * NAV_HALF_PI_LOW);
    nav_reduced_t reduced = {0.0, 0};

    /* beyond the stated range the rest can be anything; the result still is a sine */
    reduced.remainder_rad = nav_clamp(rest, -NAV_REMAINDER_MAX_RAD, NAV_REMAINDER_MAX_RAD);
    (void) nav_floor_index(multiple - (4.0 * floor(multiple * 0.25)), &reduced.quadrant);
    return reduced;
}

/* sin of the remainder plus a number of quarter turns */
static double sin_in_quadrant(double remainder_rad, int32_t quadrant)
{
    double value = 0.0;

    switch (quadrant)
    {
    case 0:
        value = sin_near_zero(remainder_rad);
        break;
    case 1:
        value = cos_near_zero(remainder_rad);
        break;
    case 2:
        value = -sin_near_zero(remainder_rad);
        break;
    default:
        value = -cos_near_zero(remainder_rad);
        break;
    }
    return value;
}

/* atan(t) = atan(c) + atan((t - c) / (1 + t c)) with the nearest node c, for t in [0, 1] */
static double atan_of_ratio(double ratio)
{
    static const double atan_of_node[NAV_ATAN_NODES] = {0.0,
                                                        0.124354994546761435031,
                                                        0.244978663126864154172,
                                                        0.358770670270572220396,
                                                        0.463647609000806116214,
                                                        0.558599315343562435972,
                                                        0.643501108793284386803,
                                                        0.718829999621624505417,
                                                        0.785398163397448309616};
    int32_t node = 0;

    (void) nav_floor_index((ratio * NAV_ATAN_STEPS) + 0.5, &node);
    const double center = (double) node / NAV_ATAN_STEPS;
    const double x = (ratio - center) / (1.0 + (ratio * center));
    const double xx = x * x;
    const double sum =
        (1.0 / 3.0) -
        (xx * ((1.0 / 5.0) -
               (xx * ((1.0 / 7.0) - (xx * ((1.0 / 9.0) - (xx * ((1.0 / 11.0) - (xx / 13.0)))))))));

    return atan_of_node[node] + (x - (x * xx * sum));
}

bool nav_isfinite(double x)
{
    const void *source = &x;
    uint64_t bits = 0U;
    void *target = &bits;

    (void) memcpy(target, source, sizeof(bits));
    return (bits & NAV_EXPONENT_MASK) != NAV_EXPONENT_MASK;
}

double nav_sin(double angle_rad)
{
    const nav_reduced_t reduced = reduce(angle_rad);

    return sin_in_quadrant(reduced.remainder_rad, reduced.quadrant);
}

double nav_cos(double angle_rad)
{
    const nav_reduced_t reduced = reduce(angle_rad);

    return sin_in_quadrant(reduced.remainder_rad, nav_wrap_index(reduced.quadrant + 1, 4));
}

void nav_sincos(double angle_rad, double *sine, double *cosine)
{
    if (fabs(angle_rad) < (0.5 * NAV_HALF_PI))
    {
        *sine = sin_near_zero(angle_rad);
        *cosine = cos_near_zero(angle_rad);
    }
    else
    {
        *sine = nav_sin(angle_rad);
        *cosine = nav_cos(angle_rad);
    }
}

double nav_atan2(double y, double x)
{
    const double y_size = fabs(y);
    const double x_size = fabs(x);
    const double longer = nav_max(x_size, y_size);
    double angle_rad = 0.0;

    if (longer > 0.0)
    {
        angle_rad = atan_of_ratio(nav_min(x_size, y_size) / longer);
    }
    if (y_size > x_size)
    {
        angle_rad = NAV_HALF_PI - angle_rad;
    }
    if (x < 0.0)
    {
        angle_rad = NAV_PI - angle_rad;
    }
    if (y < 0.0)
    {
        angle_rad = -angle_rad;
    }
    return angle_rad;
}

double nav_asin(double x)
{
    const double sine = nav_clamp(x, -1.0, 1.0);

    return nav_atan2(sine, sqrt((1.0 - sine) * (1.0 + sine)));
}

double nav_acos(double x)
{
    const double cosine = nav_clamp(x, -1.0, 1.0);

    return nav_atan2(sqrt((1.0 - cosine) * (1.0 + cosine)), cosine);
}

double nav_wrap_angle(double angle_rad)
{
    double wrapped_rad = angle_rad;

    if ((angle_rad < -NAV_PI) || (angle_rad >= NAV_PI))
    {
        const double quarters = 4.0 * floor((angle_rad * (NAV_HALF_TURNS_PER_RAD * 0.25)) + 0.5);

        wrapped_rad =
            ((angle_rad - (quarters * NAV_HALF_PI_HIGH)) - (quarters * NAV_HALF_PI_MIDDLE)) -
            (quarters * NAV_HALF_PI_LOW);
        /* rounding can leave it just outside; both ends are the same direction */
        if ((wrapped_rad < -NAV_PI) || (wrapped_rad >= NAV_PI))
        {
            wrapped_rad = -NAV_PI;
        }
    }
    return wrapped_rad;
}

bool nav_floor_index(double x, int32_t *index)
{
    const bool is_valid = fabs(x) < NAV_INDEX_LIMIT;

    *index = 0;
    if (is_valid)
    {
        /* towards zero, then down */
        const int32_t whole = (int32_t) x;

        *index = ((double) whole > x) ? (whole - 1) : whole;
    }
    return is_valid;
}

int32_t nav_wrap_index(int32_t index, int32_t size)
{
    const int32_t rest = index % size;

    return (rest < 0) ? (rest + size) : rest;
}
