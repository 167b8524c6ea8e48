// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_dp_stub.h"
#include "navlib.h"
}

namespace
{

nav_evr_t only_report()
{
    nav_stub_header_t header = {};
    nav_evr_t evr = {};
    EXPECT_EQ(nav_stub_size(), sizeof(header) + sizeof(evr));
    std::memcpy(&header, nav_stub_data(), sizeof(header));
    std::memcpy(&evr, nav_stub_data() + sizeof(header), sizeof(evr));
    EXPECT_EQ(header.kind, static_cast<uint32_t>(NAV_DP_EVR));
    EXPECT_EQ(header.size_bytes, sizeof(evr));
    EXPECT_EQ(header.time_s, evr.time_s);
    nav_stub_clear();
    return evr;
}

} // namespace

TEST(NavEvr, AReportCarriesTimeSeverityAndArguments)
{
    nav_stub_clear();
    nav_evr_report(12.5, NAV_EVR_ARC_SELECTED, 1.0, 2.0, 3.0, 4.0);
    const nav_evr_t evr = only_report();
    EXPECT_EQ(evr.time_s, 12.5);
    EXPECT_EQ(evr.id, static_cast<uint32_t>(NAV_EVR_ARC_SELECTED));
    EXPECT_EQ(evr.severity, static_cast<uint32_t>(NAV_EVR_ACTIVITY_HIGH));
    EXPECT_EQ(evr.arg_count, 4U);
    EXPECT_EQ(evr.args[0], 1.0);
    EXPECT_EQ(evr.args[3], 4.0);
}

TEST(NavEvr, ArgumentsBeyondTheirNumberAreZero)
{
    nav_stub_clear();
    nav_evr_report(1.0, NAV_EVR_CALL_REFUSED, 5.0, 6.0, 7.0, 8.0);
    const nav_evr_t evr = only_report();
    EXPECT_EQ(evr.arg_count, 2U);
    EXPECT_EQ(evr.args[1], 6.0);
    EXPECT_EQ(evr.args[2], 0.0);
    EXPECT_EQ(evr.args[3], 0.0);
}

TEST(NavEvr, AnUnknownReportIsAWarningWithoutArguments)
{
    nav_stub_clear();
    nav_evr_report(1.0, static_cast<nav_evr_id_t>(15), 5.0, 6.0, 7.0, 8.0);
    const nav_evr_t evr = only_report();
    EXPECT_EQ(evr.id, 15U);
    EXPECT_EQ(evr.severity, static_cast<uint32_t>(NAV_EVR_WARNING_HIGH));
    EXPECT_EQ(evr.arg_count, 0U);
    EXPECT_EQ(evr.args[0], 0.0);
}

TEST(NavEvr, EveryTextHasABracePairForEachArgument)
{
    uint32_t last_id = 0U;
    for (const nav_evr_def_t &def : nav_evr_defs)
    {
        const std::string text = def.text;
        uint32_t pairs = 0U;
        for (size_t at = text.find("{}"); at != std::string::npos; at = text.find("{}", at + 2))
        {
            pairs++;
        }
        EXPECT_EQ(pairs, def.arg_count) << def.name;
        EXPECT_LE(def.arg_count, static_cast<uint32_t>(NAV_EVR_ARGS_MAX));
        EXPECT_EQ(def.id, last_id + 1U);
        last_id = def.id;
    }
    EXPECT_EQ(last_id, static_cast<uint32_t>(NAV_EVR_COUNT));
}

TEST(NavEvr, EveryEventHasACauseAndAMeaningForEachArgument)
{
    for (const nav_evr_def_t &def : nav_evr_defs)
    {
        EXPECT_GT(std::string(def.cause).size(), 10U) << def.name;
        const std::string args = def.args;
        const auto separators = std::count(args.begin(), args.end(), ';');
        EXPECT_EQ(separators + 1, static_cast<long>(def.arg_count)) << def.name;
    }
}

TEST(NavEvr, AReportThatDoesNotFitIsCounted)
{
    static uint8_t filler[NAV_STUB_BUFFER_BYTES];
    nav_stub_clear();
    const uint32_t most = NAV_STUB_BUFFER_BYTES - static_cast<uint32_t>(sizeof(nav_stub_header_t));
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 0.0, filler, most), NAV_OK);
    nav_evr_report(1.0, NAV_EVR_ASSERTION, 1.0, 0.0, 0.0, 0.0);
    EXPECT_EQ(nav_stub_lost_count(), 1U);
    nav_stub_clear();
    EXPECT_EQ(nav_stub_lost_count(), 0U);
}
