// SPDX-License-Identifier: Apache-2.0
// The geometry of the default rover, or of one with other parameters.
#ifndef NAV_ROVER_HPP
#define NAV_ROVER_HPP

#include <functional>

extern "C"
{
#include "nav_vehicle.h"
}

inline nav_vehicle_t vehicle_of(const std::function<void(nav_params_t &)> &change = {})
{
    nav_params_t params;
    nav_params_default(&params);
    if (change)
    {
        change(params);
    }
    nav_vehicle_t vehicle;
    nav_vehicle_init(&params, &vehicle);
    return vehicle;
}

#endif
