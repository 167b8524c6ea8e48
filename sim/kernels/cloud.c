/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file cloud.c
 * @brief From ranges to the points that stereo matching would give.
 */
#include <math.h>
#include <stddef.h>

#include "sim_kernels.h"

/* least distance of the right camera from a left ray, squared: rays along the baseline see no depth */
#define HEIGHT2_MIN_M2 1e-12

/*
 * SIM equation (1): sigma = pixel * d / sin(theta), with d the distance to the right camera and theta
 * the angle between the cameras seen from the point. By the sine rule d / sin(theta) equals
 * d^2 / |baseline x ray|, which stays exact for far points.
 */
static inline double sigma_m(const sim_stereo_t *stereo, const double *ray, double range_m)
{
    const double *baseline = stereo->baseline_m;
    const double along = (ray[0] * baseline[0]) + (ray[1] * baseline[1]) + (ray[2] * baseline[2]);
    const double baseline2 =
        (baseline[0] * baseline[0]) + (baseline[1] * baseline[1]) + (baseline[2] * baseline[2]);
    const double distance2 = (range_m * range_m) - (2.0 * range_m * along) + baseline2;
    const double height2 = baseline2 - (along * along);
    return stereo->pixel_rad * distance2 /
           sqrt((height2 > HEIGHT2_MIN_M2) ? height2 : HEIGHT2_MIN_M2);
}

int32_t sim_cloud(const sim_stereo_t *stereo,
                  const float *range_m,
                  const double *error_px,
                  float *point_m)
{
    int32_t seen = 0;
    float *point = point_m;
    for (int32_t i = 0; i < stereo->count; i++)
    {
        if (!isnan(range_m[i]))
        {
            const double *ray = &stereo->directions[(ptrdiff_t) 3 * i];
            double slid_m = (double) range_m[i];
            if (error_px != NULL)
            {
                slid_m += error_px[seen] * sigma_m(stereo, ray, slid_m);
            }
            seen++;
            if ((error_px == NULL) || (slid_m > 0.0))
            {
                for (int axis = 0; axis < 3; axis++)
                {
                    point[axis] = (float) ((ray[axis] * slid_m) + stereo->center_m[axis]);
                }
                point += 3;
            }
        }
    }
    return (int32_t) ((point - point_m) / 3);
}
