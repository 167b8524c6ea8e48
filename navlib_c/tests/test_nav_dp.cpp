// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_dp_stub.h"
#include "nav_host.h"
#include "navlib.h"
}

namespace
{

std::map<std::string, uint32_t> number_sizes()
{
    return {{"double", 8U},   {"float", 4U},    {"int32_t", 4U},
            {"uint32_t", 4U}, {"uint16_t", 2U}, {"uint8_t", 1U}};
}

// checks that records only use what came before them, and that fields follow without a gap
void expect_described(const nav_record_def_t *defs,
                      size_t count,
                      std::map<std::string, uint32_t> &sizes)
{
    for (size_t row = 0; row < count; row++)
    {
        const nav_record_def_t &record = defs[row];
        std::set<std::string> names;
        uint32_t offset = 0U;
        for (uint32_t index = 0U; index < record.field_count; index++)
        {
            const nav_field_def_t &field = record.fields[index];
            ASSERT_EQ(sizes.count(field.type), 1U) << record.type << " " << field.type;
            EXPECT_EQ(field.offset, offset) << record.type << " " << field.name;
            EXPECT_GE(field.count, 1U);
            offset += field.count * sizes[field.type];
            names.insert(field.name);
        }
        EXPECT_EQ(offset, record.size) << record.type;
        EXPECT_EQ(names.size(), record.field_count) << record.type;
        sizes[record.type] = record.size;
    }
}

const nav_field_def_t &field_of(const std::string &type, const std::string &name)
{
    for (const nav_record_def_t &record : nav_record_defs)
    {
        for (uint32_t index = 0U; (type == record.type) && (index < record.field_count); index++)
        {
            if (name == record.fields[index].name)
            {
                return record.fields[index];
            }
        }
    }
    ADD_FAILURE() << type << " " << name;
    return nav_record_defs[0].fields[0];
}

class NavDpStub : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        nav_stub_clear();
    }
    void TearDown() override
    {
        nav_stub_clear();
    }
};

} // namespace

TEST(NavDp, RecordsAreDescribedWithoutGaps)
{
    auto sizes = number_sizes();
    expect_described(nav_record_defs, NAV_RECORD_COUNT, sizes);
    expect_described(nav_host_record_defs, NAV_HOST_RECORD_COUNT, sizes);
    EXPECT_EQ(sizes["nav_pose_t"], sizeof(nav_pose_t));
    EXPECT_EQ(sizes["nav_costmap_t"], sizeof(nav_costmap_t));
    EXPECT_EQ(sizes["nav_host_truth_t"], sizeof(nav_host_truth_t));
}

TEST(NavDp, FieldsCarryTheirTypeCountOffsetAndUnit)
{
    const nav_field_def_t &z = field_of("nav_surface_t", "z_site_m");
    EXPECT_STREQ(z.type, "float");
    EXPECT_EQ(z.count, static_cast<uint32_t>(NAV_HEIGHTMAP_CELLS));
    EXPECT_EQ(z.offset, offsetof(nav_surface_t, z_site_m));
    EXPECT_STREQ(z.unit, "m");
    const nav_field_def_t &points = field_of("nav_process_disparity_in_t", "points");
    EXPECT_STREQ(points.type, "nav_point_t");
    EXPECT_EQ(points.count, static_cast<uint32_t>(NAV_CHUNK_POINTS_MAX));
    EXPECT_STREQ(points.unit, "");
    const nav_field_def_t &pose = field_of("nav_select_arc_in_t", "pose");
    EXPECT_STREQ(pose.type, "nav_pose_t");
    EXPECT_EQ(pose.count, 1U);
    EXPECT_EQ(pose.offset, offsetof(nav_select_arc_in_t, pose));
    EXPECT_STREQ(pose.doc, "predicted pose at the end of the current arc");
}

TEST(NavDp, EveryKindHasItsOwnNumberNameAndADescribedRecord)
{
    std::set<std::string> types;
    std::set<std::string> names;
    std::set<uint32_t> kinds;
    for (const nav_record_def_t &record : nav_record_defs)
    {
        types.insert(record.type);
    }
    for (const nav_record_def_t &record : nav_host_record_defs)
    {
        types.insert(record.type);
    }
    for (const nav_dp_def_t &def : nav_dp_defs)
    {
        EXPECT_EQ(types.count(def.type), 1U) << def.type;
        names.insert(def.name);
        kinds.insert(def.kind);
    }
    for (const nav_dp_def_t &def : nav_host_dp_defs)
    {
        EXPECT_EQ(types.count(def.type), 1U) << def.type;
        names.insert(def.name);
        kinds.insert(def.kind);
    }
    EXPECT_EQ(names.size(), static_cast<size_t>(NAV_DP_COUNT + NAV_HOST_DP_COUNT));
    EXPECT_EQ(kinds.size(), static_cast<size_t>(NAV_DP_COUNT + NAV_HOST_DP_COUNT));
    EXPECT_STREQ(nav_dp_defs[NAV_DP_EVR - 1].name, "EVR");
    EXPECT_EQ(nav_host_dp_defs[0].kind, static_cast<uint32_t>(NAV_HOST_DP_TRUTH));
}

TEST_F(NavDpStub, RecordsComeBackInOrderEachAtAMultipleOfEight)
{
    const std::string texts[] = {"a", "12345678", "123456789"};
    for (size_t index = 0; index < 3; index++)
    {
        EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0 + static_cast<double>(index), texts[index].data(),
                              static_cast<uint32_t>(texts[index].size())),
                  NAV_OK);
    }
    uint32_t at = 0U;
    for (size_t index = 0; index < 3; index++)
    {
        nav_stub_header_t header;
        std::memcpy(&header, nav_stub_data() + at, sizeof(header));
        EXPECT_EQ(header.kind, static_cast<uint32_t>(NAV_DP_TREE));
        EXPECT_EQ(header.time_s, 1.0 + static_cast<double>(index));
        ASSERT_EQ(header.size_bytes, texts[index].size());
        at += static_cast<uint32_t>(sizeof(header));
        EXPECT_EQ(std::memcmp(nav_stub_data() + at, texts[index].data(), header.size_bytes), 0);
        while (header.size_bytes % 8U != 0U)
        {
            EXPECT_EQ(nav_stub_data()[at + header.size_bytes], 0U);
            header.size_bytes++;
        }
        at += header.size_bytes;
    }
    EXPECT_EQ(at, nav_stub_size());
    EXPECT_EQ(reinterpret_cast<uintptr_t>(nav_stub_data()) % 8U, 0U);
}

TEST_F(NavDpStub, AnEmptyRecordIsAHeader)
{
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, "", 0U), NAV_OK);
    EXPECT_EQ(nav_stub_size(), sizeof(nav_stub_header_t));
}

TEST_F(NavDpStub, ANullRecordIsLost)
{
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, nullptr, 8U), NAV_SINK);
    EXPECT_EQ(nav_stub_lost_count(), 1U);
    EXPECT_EQ(nav_stub_size(), 0U);
}

TEST_F(NavDpStub, ARecordLargerThanTheRoomIsLostAndASmallerOneTaken)
{
    std::vector<uint8_t> record(NAV_STUB_BUFFER_BYTES, 0x5AU);
    const uint32_t room = NAV_STUB_BUFFER_BYTES - static_cast<uint32_t>(sizeof(nav_stub_header_t));
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, record.data(), room + 1U), NAV_SINK);
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, record.data(), UINT32_MAX), NAV_SINK);
    EXPECT_EQ(nav_stub_lost_count(), 2U);
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, record.data(), room - 24U), NAV_OK);
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, record.data(), 9U), NAV_SINK);
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, record.data(), 1U), NAV_OK);
    EXPECT_EQ(nav_stub_size(), static_cast<uint32_t>(NAV_STUB_BUFFER_BYTES));
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, record.data(), 0U), NAV_SINK);
    EXPECT_EQ(nav_stub_lost_count(), 4U);
}

TEST_F(NavDpStub, ClearingForgetsEverything)
{
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, "x", 1U), NAV_OK);
    EXPECT_EQ(nav_dp_send(NAV_DP_TREE, 1.0, nullptr, 1U), NAV_SINK);
    nav_stub_clear();
    EXPECT_EQ(nav_stub_size(), 0U);
    EXPECT_EQ(nav_stub_lost_count(), 0U);
}
