// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_dp_file.h"
}

namespace
{

constexpr const char *kDrive = "{\"name\":\"t\"}";

class DpFile : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        const auto *info = ::testing::UnitTest::GetInstance()->current_test_info();
        path_ = ::testing::TempDir() + "dp_file_" + info->name() + ".dp";
    }
    void TearDown() override
    {
        (void) std::remove(path_.c_str());
    }

    std::string bytes() const
    {
        std::ifstream in(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    static uint32_t u32(const std::string &data, size_t offset)
    {
        uint32_t value = 0U;
        std::memcpy(&value, &data.at(offset), sizeof(value));
        return value;
    }

    std::string path_;
    nav_dp_file_t file_{};
};

// Bit by bit, as the standard defines it.
uint32_t crc32(const std::string &data)
{
    uint32_t crc = 0xFFFFFFFFU;
    for (const char c : data)
    {
        crc ^= static_cast<uint8_t>(c);
        for (int bit = 0; bit < 8; bit++)
        {
            crc = (crc >> 1U) ^ (((crc & 1U) != 0U) ? 0xEDB88320U : 0U);
        }
    }
    return ~crc;
}

TEST_F(DpFile, HeaderIsAlignedCheckedAndDescribesTheRecords)
{
    ASSERT_TRUE(nav_dp_file_open(&file_, path_.c_str(), kDrive));
    ASSERT_TRUE(nav_dp_file_close(&file_));
    const std::string data = bytes();
    EXPECT_EQ(data.substr(0, 8), "ENAVDP\r\n");
    EXPECT_EQ(u32(data, 8), 0x01020304U);
    EXPECT_EQ(u32(data, 12), 1U);
    EXPECT_EQ(u32(data, 16), static_cast<uint32_t>(NAV_DP_VERSION));
    const uint32_t size = u32(data, 20);
    EXPECT_EQ(size % 8U, 0U);
    ASSERT_EQ(data.size(), 32U + size);
    EXPECT_EQ(u32(data, 24U + size), crc32(data.substr(0, 24U + size)));
    EXPECT_EQ(u32(data, 28U + size), 0U);
    const std::string text = data.substr(24, size);
    EXPECT_EQ(text.rfind("{\"drive\":{\"name\":\"t\"},\"enums\":{\"nav_status_t\":[\"OK\",", 0),
              0U);
    EXPECT_NE(text.find("{\"name\":\"x_site_m\",\"type\":\"double\",\"count\":1,\"offset\":0,"),
              std::string::npos);
    EXPECT_NE(text.find("\"nav_host_truth_t\""), std::string::npos);
}

TEST_F(DpFile, RecordsAreNumberedCheckedAndPadded)
{
    const char payload[] = "12345678901";
    ASSERT_TRUE(nav_dp_file_open(&file_, path_.c_str(), kDrive));
    ASSERT_TRUE(nav_dp_file_flush(&file_));
    const size_t start = bytes().size();
    ASSERT_TRUE(nav_dp_file_write(&file_, 13U, 2.5, payload, 11U));
    ASSERT_TRUE(nav_dp_file_write(&file_, 0U, 3.0, "{}", 2U));
    ASSERT_TRUE(nav_dp_file_close(&file_));
    const std::string data = bytes();
    ASSERT_EQ(data.size(), start + 32U + 16U + 32U + 8U);
    double time_s = 0.0;
    std::memcpy(&time_s, &data.at(start + 16U), sizeof(time_s));
    EXPECT_EQ(u32(data, start), 0x52444E45U);
    EXPECT_EQ(u32(data, start + 4U), 13U);
    EXPECT_EQ(u32(data, start + 8U), 11U);
    EXPECT_EQ(u32(data, start + 12U), 0U);
    EXPECT_DOUBLE_EQ(time_s, 2.5);
    EXPECT_EQ(u32(data, start + 24U), crc32(data.substr(start, 24)));
    EXPECT_EQ(u32(data, start + 28U), crc32("12345678901"));
    EXPECT_EQ(data.substr(start + 32U, 16U), std::string("12345678901\0\0\0\0\0", 16));
    EXPECT_EQ(u32(data, start + 48U + 12U), 1U);
}

TEST_F(DpFile, APlaceThatCannotBeWrittenIsReported)
{
    EXPECT_FALSE(nav_dp_file_open(&file_, "/nonexistent/file.dp", kDrive));
    EXPECT_FALSE(nav_dp_file_write(&file_, 13U, 0.0, "1", 1U));
    EXPECT_FALSE(nav_dp_file_flush(&file_));
    EXPECT_FALSE(nav_dp_file_close(&file_));
}

TEST_F(DpFile, AFullDiskIsReportedAtTheLatestByClose)
{
    ASSERT_TRUE(nav_dp_file_open(&file_, "/dev/full", kDrive) || file_.is_bad);
    const std::vector<char> cloud(100000U, 'x');
    (void) nav_dp_file_write(&file_, 5U, 0.0, cloud.data(), 100000U);
    EXPECT_FALSE(nav_dp_file_close(&file_));
}

TEST_F(DpFile, NothingIsWrittenAfterClose)
{
    ASSERT_TRUE(nav_dp_file_open(&file_, path_.c_str(), kDrive));
    ASSERT_TRUE(nav_dp_file_close(&file_));
    const std::string before = bytes();
    EXPECT_FALSE(nav_dp_file_write(&file_, 13U, 0.0, "1", 1U));
    EXPECT_FALSE(nav_dp_file_close(&file_));
    EXPECT_EQ(bytes(), before);
}

} // namespace
