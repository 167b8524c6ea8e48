/* SPDX-License-Identifier: Apache-2.0 */
/* Planted violations of rules 15.1 (goto) and 17.2 (recursion): `make misra` must notice both. */
#include <stdint.h>

static uint32_t recursive(uint32_t depth)
{
    uint32_t result = depth;
    if (depth == 0U)
    {
        goto done;
    }
    result = recursive(depth - 1U);
done:
    return result;
}

int main(void)
{
    return (int) recursive(3U);
}
