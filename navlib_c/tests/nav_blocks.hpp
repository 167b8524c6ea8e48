// SPDX-License-Identifier: Apache-2.0
// Blocks of the heightmap, found another way than Navlib finds them.
#ifndef NAV_BLOCKS_HPP
#define NAV_BLOCKS_HPP

#include <cmath>
#include <cstdint>

extern "C"
{
#include "nav_heightmap.h"
}

/// Where a block stands in tables, given the global indices of one of its cells.
inline int32_t block_in_tables(int32_t row, int32_t col)
{
    const auto in_table = [](int32_t index)
    {
        const int32_t block =
            static_cast<int32_t>(std::floor(static_cast<double>(index) / NAV_CELLS_PER_COST_CELL));
        return ((block % NAV_BLOCKS_SIDE) + NAV_BLOCKS_SIDE) % NAV_BLOCKS_SIDE;
    };
    return (in_table(row) * NAV_BLOCKS_SIDE) + in_table(col);
}

#endif
