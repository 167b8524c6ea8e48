// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_kioz.h"
#include "nav_math.h"
}

namespace
{

struct Point
{
    double x;
    double y;
};

nav_zone_t circle(double x, double y, double radius)
{
    nav_zone_t zone = {};
    zone.shape = NAV_ZONE_CIRCLE;
    zone.center_x_site_m = x;
    zone.center_y_site_m = y;
    zone.radius_m = radius;
    return zone;
}

nav_zone_t rectangle(double x, double y, double length, double width, double heading)
{
    nav_zone_t zone = {};
    zone.shape = NAV_ZONE_RECTANGLE;
    zone.center_x_site_m = x;
    zone.center_y_site_m = y;
    zone.length_m = length;
    zone.width_m = width;
    zone.heading_rad = heading;
    return zone;
}

nav_zone_t triangle(Point a, Point b, Point c)
{
    nav_zone_t zone = {};
    zone.shape = NAV_ZONE_TRIANGLE;
    const Point corners[3] = {a, b, c};
    for (int i = 0; i < 3; i++)
    {
        zone.vertex_x_site_m[i] = corners[i].x;
        zone.vertex_y_site_m[i] = corners[i].y;
    }
    return zone;
}

nav_zone_t keep_in(nav_zone_t zone)
{
    zone.kind = NAV_ZONE_KEEP_IN;
    return zone;
}

nav_kioz_t kioz_of(const std::vector<nav_zone_t> &zones)
{
    nav_kioz_t kioz;
    nav_kioz_set(&kioz, zones.data(), static_cast<uint32_t>(zones.size()));
    return kioz;
}

// signed distance to a polygon, by its sides and by counting crossings
double polygon_distance(const std::vector<Point> &corners, Point p)
{
    double least = std::numeric_limits<double>::infinity();
    bool is_inside = false;
    for (size_t i = 0; i < corners.size(); i++)
    {
        const Point a = corners[i];
        const Point b = corners[(i + 1) % corners.size()];
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        double along = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length;
        along = std::clamp(along, 0.0, length);
        least = std::min(least, std::hypot(p.x - a.x - (b.x - a.x) * along / length,
                                           p.y - a.y - (b.y - a.y) * along / length));
        if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x)
        {
            is_inside = !is_inside;
        }
    }
    return is_inside ? -least : least;
}

} // namespace

TEST(NavKioz, GoodZonesOfEveryShapeAreAccepted)
{
    for (const nav_zone_t &zone :
         {circle(1, 2, 3), rectangle(1, 2, 3, 4, 5), triangle({0, 0}, {1, 0}, {0, 1}),
          triangle({0, 0}, {0, 1}, {1, 0}), keep_in(circle(0, 0, 0.01))})
    {
        EXPECT_EQ(nav_kioz_check(&zone), NAV_OK);
    }
}

TEST(NavKioz, WhatIsNotFiniteIsRefusedInEveryField)
{
    for (double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    {
        const nav_zone_t good = triangle({0, 0}, {1, 0}, {0, 1});
        double nav_zone_t::*const fields[] = {
            &nav_zone_t::center_x_site_m, &nav_zone_t::center_y_site_m, &nav_zone_t::radius_m,
            &nav_zone_t::length_m,        &nav_zone_t::width_m,         &nav_zone_t::heading_rad};
        for (auto field : fields)
        {
            nav_zone_t zone = good;
            zone.*field = bad;
            EXPECT_EQ(nav_kioz_check(&zone), NAV_NOT_FINITE);
        }
        for (int corner = 0; corner < 3; corner++)
        {
            nav_zone_t zone = good;
            zone.vertex_x_site_m[corner] = bad;
            EXPECT_EQ(nav_kioz_check(&zone), NAV_NOT_FINITE);
            zone = good;
            zone.vertex_y_site_m[corner] = -bad;
            EXPECT_EQ(nav_kioz_check(&zone), NAV_NOT_FINITE);
        }
    }
}

TEST(NavKioz, UnknownKindsAndShapesAreRefused)
{
    nav_zone_t zone = circle(0, 0, 1);
    zone.kind = 2U;
    EXPECT_EQ(nav_kioz_check(&zone), NAV_ZONE);
    zone.kind = UINT32_MAX;
    EXPECT_EQ(nav_kioz_check(&zone), NAV_ZONE);
    zone = circle(0, 0, 1);
    zone.shape = 3U;
    EXPECT_EQ(nav_kioz_check(&zone), NAV_ZONE);
}

TEST(NavKioz, DegenerateZonesAreRefused)
{
    for (const nav_zone_t &zone :
         {circle(0, 0, 0.0), circle(0, 0, 0.0099), circle(0, 0, -1.0), rectangle(0, 0, 0.0, 1, 0),
          rectangle(0, 0, 1, 0.0099, 0), rectangle(0, 0, -1, 1, 0),
          triangle({0, 0}, {0, 0}, {0, 0}), triangle({0, 0}, {1, 1}, {2, 2}),
          triangle({0, 0}, {10, 0}, {5, 0.0099}), triangle({0, 0}, {0, 0}, {5, 1})})
    {
        EXPECT_EQ(nav_kioz_check(&zone), NAV_ZONE);
    }
    for (const nav_zone_t &zone : {circle(0, 0, 0.01), rectangle(0, 0, 0.01, 0.01, 0),
                                   triangle({0, 0}, {10, 0}, {5, 0.0101})})
    {
        EXPECT_EQ(nav_kioz_check(&zone), NAV_OK);
    }
}

TEST(NavKioz, ZonesBeyondTheirBoundsAreRefused)
{
    for (const nav_zone_t &zone :
         {circle(1.01e8, 0, 1), circle(0, -1e300, 1), circle(0, 0, 1.01e8),
          rectangle(0, 0, 1, 1, 1.01e4), triangle({0, 0}, {2e8, 0}, {0, 1})})
    {
        EXPECT_EQ(nav_kioz_check(&zone), NAV_ZONE);
    }
    const nav_zone_t largest = rectangle(1e8, -1e8, 1e8, 1e8, -1e4);
    EXPECT_EQ(nav_kioz_check(&largest), NAV_OK);
}

TEST(NavKioz, DistanceToACircle)
{
    const nav_zone_t zone = circle(1, 2, 3);
    EXPECT_DOUBLE_EQ(nav_kioz_distance_m(&zone, 1, 2), -3.0);
    EXPECT_DOUBLE_EQ(nav_kioz_distance_m(&zone, 4, 2), 0.0);
    EXPECT_DOUBLE_EQ(nav_kioz_distance_m(&zone, 4, 6), 2.0);
}

TEST(NavKioz, DistanceToARectangle)
{
    const nav_zone_t zone = rectangle(0, 0, 4, 2, 0); // 4 north-south, 2 east-west
    EXPECT_DOUBLE_EQ(nav_kioz_distance_m(&zone, 0, 0), -1.0);
    EXPECT_NEAR(nav_kioz_distance_m(&zone, 1.9, 0), -0.1, 1e-15);
    EXPECT_DOUBLE_EQ(nav_kioz_distance_m(&zone, 3, 0), 1.0);
    EXPECT_DOUBLE_EQ(nav_kioz_distance_m(&zone, 0, -3), 2.0);
    EXPECT_DOUBLE_EQ(nav_kioz_distance_m(&zone, 5, 5), 5.0);
    const nav_zone_t turned = rectangle(0, 0, 4, 2, NAV_PI / 2);
    EXPECT_NEAR(nav_kioz_distance_m(&turned, 0, 3), 1.0, 1e-15);
    const nav_zone_t diagonal = rectangle(0, 0, 4, 2, NAV_PI / 4); // towards north-east
    EXPECT_NEAR(nav_kioz_distance_m(&diagonal, 3, 3), 3 * std::sqrt(2) - 2, 1e-14);
}

TEST(NavKioz, DistancesAgreeWithThoseToPolygons)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> coordinates(-10.0, 10.0);
    std::uniform_real_distribution<double> sides(0.1, 8.0);
    for (int i = 0; i < 50000; i++)
    {
        const Point p = {coordinates(random), coordinates(random)};
        const Point a = {coordinates(random), coordinates(random)};
        const Point b = {coordinates(random), coordinates(random)};
        const Point c = {coordinates(random), coordinates(random)};
        const nav_zone_t three = triangle(a, b, c);
        ASSERT_NEAR(nav_kioz_distance_m(&three, p.x, p.y), polygon_distance({a, b, c}, p), 1e-10);
        const nav_zone_t four = rectangle(a.x, a.y, sides(random), sides(random), b.x);
        std::vector<Point> corners;
        for (Point q : {Point{1, 1}, Point{1, -1}, Point{-1, -1}, Point{-1, 1}})
        {
            const double ahead = q.x * four.length_m / 2;
            const double right = q.y * four.width_m / 2;
            corners.push_back({a.x + ahead * std::cos(b.x) - right * std::sin(b.x),
                               a.y + ahead * std::sin(b.x) + right * std::cos(b.x)});
        }
        ASSERT_NEAR(nav_kioz_distance_m(&four, p.x, p.y), polygon_distance(corners, p), 1e-10);
    }
}

TEST(NavKioz, WithoutZonesNothingIsForbidden)
{
    const nav_kioz_t kioz = kioz_of({});
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 0, 0, 0.0));
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 1e6, -1e6, 100.0));
}

TEST(NavKioz, AKeepOutZoneForbidsItsInsideGrownByTheMargin)
{
    for (const nav_zone_t &zone : {circle(0, 0, 2), rectangle(0, 0, 4, 4, 0)})
    {
        const nav_kioz_t kioz = kioz_of({zone});
        EXPECT_TRUE(nav_kioz_forbids(&kioz, 0, 0, 0.0));
        EXPECT_TRUE(nav_kioz_forbids(&kioz, 2, 0, 0.0));
        EXPECT_FALSE(nav_kioz_forbids(&kioz, 2.001, 0, 0.0));
        EXPECT_TRUE(nav_kioz_forbids(&kioz, 2.499, 0, 0.5));
        EXPECT_FALSE(nav_kioz_forbids(&kioz, 2.501, 0, 0.5));
        EXPECT_FALSE(nav_kioz_forbids(&kioz, 100, 0, 0.5));
    }
}

TEST(NavKioz, KeepInZonesForbidWhatLiesInNoneOfThemShrunkByTheMargin)
{
    const nav_kioz_t kioz = kioz_of({keep_in(circle(0, 0, 2)), keep_in(rectangle(10, 0, 4, 4, 0)),
                                     keep_in(triangle({20, 0}, {24, 0}, {20, 4}))});
    EXPECT_EQ(kioz.keep_in_count, 3U);
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 0, 0, 0.5));
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 10, 1, 0.5));
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 21, 1, 0.5));
    EXPECT_TRUE(nav_kioz_forbids(&kioz, 5, 0, 0.0));
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 1.9, 0, 0.0));
    EXPECT_TRUE(nav_kioz_forbids(&kioz, 1.9, 0, 0.5));
    EXPECT_TRUE(nav_kioz_forbids(&kioz, 0, 0, 2.1));
    EXPECT_TRUE(nav_kioz_forbids(&kioz, 1e6, 0, 0.0));
}

TEST(NavKioz, AKeepOutZoneInsideAKeepInZoneWins)
{
    const nav_kioz_t kioz = kioz_of({keep_in(circle(0, 0, 10)), circle(3, 0, 1)});
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 0, 0, 0.0));
    EXPECT_TRUE(nav_kioz_forbids(&kioz, 3, 0, 0.0));
    EXPECT_TRUE(nav_kioz_forbids(&kioz, 11, 0, 0.0));
}

TEST(NavKioz, TheQuickAnswerIsTheExactOne)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> coordinates(-12.0, 12.0);
    std::uniform_real_distribution<double> sides(0.1, 8.0);
    for (int i = 0; i < 50000; i++)
    {
        const nav_zone_t zone = rectangle(coordinates(random), coordinates(random), sides(random),
                                          sides(random), coordinates(random));
        const double x = coordinates(random);
        const double y = coordinates(random);
        const double margin = sides(random) / 4;
        const double distance = nav_kioz_distance_m(&zone, x, y);
        const nav_kioz_t out = kioz_of({zone});
        const nav_kioz_t in = kioz_of({keep_in(zone)});
        ASSERT_EQ(nav_kioz_forbids(&out, x, y, margin), distance <= margin);
        ASSERT_EQ(nav_kioz_forbids(&in, x, y, margin), distance > -margin);
    }
}

TEST(NavKioz, SettingReplacesAllZonesAndStopsAtTheCapacity)
{
    nav_kioz_t kioz = kioz_of({keep_in(circle(0, 0, 1)), circle(0, 0, 1)});
    const std::vector<nav_zone_t> many(NAV_ZONES_MAX + 1, circle(5, 5, 1));
    nav_kioz_set(&kioz, many.data(), static_cast<uint32_t>(many.size()));
    EXPECT_EQ(kioz.zone_count, static_cast<uint32_t>(NAV_ZONES_MAX));
    EXPECT_EQ(kioz.keep_in_count, 0U);
    EXPECT_TRUE(nav_kioz_forbids(&kioz, 5, 5, 0));
    kioz.zone_count = NAV_ZONES_MAX + 1;
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 0, 0, 0));
    nav_kioz_set(&kioz, many.data(), 0U);
    EXPECT_FALSE(nav_kioz_forbids(&kioz, 5, 5, 0));
}
