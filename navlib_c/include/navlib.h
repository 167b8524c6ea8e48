/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file navlib.h
 * @brief The whole public contract of Navlib in one include.
 */
#ifndef NAVLIB_H
#define NAVLIB_H

#include "nav_dp.h"
#include "nav_evr.h"
#include "nav_interface.h"
#include "nav_math.h"

#endif
