// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <string>

#include <gtest/gtest.h>

extern "C"
{
#include "navlib.h"
}

TEST(NavTypes, EveryStatusHasItsOwnText)
{
    std::set<std::string> texts;
    for (int status = 0; status < NAV_STATUS_COUNT; status++)
    {
        texts.insert(nav_status_text(static_cast<nav_status_t>(status)));
    }
    EXPECT_EQ(texts.size(), static_cast<size_t>(NAV_STATUS_COUNT));
    EXPECT_STREQ(nav_status_text(NAV_OK), "done");
    EXPECT_STREQ(nav_status_text(NAV_SINK), "the host refused a data product");
    EXPECT_EQ(texts.count("unknown status"), 0U);
}

TEST(NavTypes, EveryReasonHasItsOwnText)
{
    std::set<std::string> texts;
    for (int reason = 0; reason < NAV_REASON_COUNT; reason++)
    {
        texts.insert(nav_reason_text(static_cast<nav_reason_t>(reason)));
    }
    EXPECT_EQ(texts.size(), static_cast<size_t>(NAV_REASON_COUNT));
    EXPECT_STREQ(nav_reason_text(NAV_REASON_NONE), "not rejected");
    EXPECT_EQ(texts.count("unknown reason"), 0U);
}

TEST(NavTypes, TheCountsCoverTheTables)
{
#define NAV_TEST_ONE(value, name, text) +1
    EXPECT_EQ(0 NAV_STATUS_TABLE(NAV_TEST_ONE), NAV_STATUS_COUNT);
    EXPECT_EQ(0 NAV_REASON_TABLE(NAV_TEST_ONE), NAV_REASON_COUNT);
    EXPECT_EQ(0 NAV_MODE_TABLE(NAV_TEST_ONE), NAV_MODE_COUNT);
}

TEST(NavTypes, AValueOutsideTheTableIsUnknown)
{
    EXPECT_STREQ(nav_status_text(NAV_STATUS_COUNT), "unknown status");
    EXPECT_STREQ(nav_reason_text(NAV_REASON_COUNT), "unknown reason");
    EXPECT_STREQ(nav_status_text(static_cast<nav_status_t>(15)), "unknown status");
    EXPECT_STREQ(nav_reason_text(static_cast<nav_reason_t>(15)), "unknown reason");
}
