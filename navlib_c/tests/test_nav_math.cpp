// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_math.h"
#include "nav_minmax.h"
}

namespace
{

constexpr int kSamples = 200000;
const double kInfinity = std::numeric_limits<double>::infinity();
const double kNan = std::numeric_limits<double>::quiet_NaN();

double error_of(double value, long double exact)
{
    return static_cast<double>(std::fabs(static_cast<long double>(value) - exact));
}

} // namespace

TEST(NavMath, SineAndCosineStayWithinTheirErrorBound)
{
    std::mt19937_64 random(1);
    for (double range : {1.0e-3, 1.0, 4.0, 100.0, 1.0e4})
    {
        std::uniform_real_distribution<double> angles(-range, range);
        for (int i = 0; i < kSamples; i++)
        {
            const double angle = angles(random);
            ASSERT_LE(error_of(nav_sin(angle), std::sin(static_cast<long double>(angle))), 1e-15);
            ASSERT_LE(error_of(nav_cos(angle), std::cos(static_cast<long double>(angle))), 1e-15);
        }
    }
}

TEST(NavMath, SineAndCosineAreAccurateAroundMultiplesOfAQuarterTurn)
{
    for (int quarter = -6366; quarter <= 6366; quarter++)
    {
        const double middle = quarter * (NAV_PI / 2.0);
        for (double angle : {middle, std::nextafter(middle, 1e9), std::nextafter(middle, -1e9),
                             middle + NAV_PI / 4.0, middle + 1e-9})
        {
            ASSERT_LE(error_of(nav_sin(angle), std::sin(static_cast<long double>(angle))), 1e-15);
            ASSERT_LE(error_of(nav_cos(angle), std::cos(static_cast<long double>(angle))), 1e-15);
        }
    }
}

TEST(NavMath, SineIsOddAndCosineIsEven)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> angles(0.0, 50.0);
    for (int i = 0; i < kSamples; i++)
    {
        const double angle = angles(random);
        ASSERT_EQ(nav_sin(-angle), -nav_sin(angle));
        ASSERT_EQ(nav_cos(-angle), nav_cos(angle));
    }
    EXPECT_EQ(nav_sin(0.0), 0.0);
    EXPECT_EQ(nav_cos(0.0), 1.0);
}

TEST(NavMath, SineAndCosineStayBetweenMinusOneAndOneForEveryFiniteAngle)
{
    for (double angle = 1.0; angle < 1e308; angle *= 7.3)
    {
        ASSERT_LE(std::fabs(nav_sin(angle)), 1.0);
        ASSERT_LE(std::fabs(nav_cos(-angle)), 1.0);
    }
}

TEST(NavMath, SineOfWhatIsNotFiniteIsNotANumber)
{
    EXPECT_TRUE(std::isnan(nav_sin(kNan)));
    EXPECT_TRUE(std::isnan(nav_sin(kInfinity)));
    EXPECT_TRUE(std::isnan(nav_cos(-kInfinity)));
}

TEST(NavMath, ArcTangentStaysWithinItsErrorBound)
{
    std::mt19937_64 random(3);
    for (double range : {1.0e-6, 1.0, 1.0e6})
    {
        std::uniform_real_distribution<double> sides(-range, range);
        for (int i = 0; i < kSamples; i++)
        {
            const double y = sides(random);
            const double x = (i % 3 == 0) ? sides(random) / range : sides(random);
            const long double exact =
                std::atan2(static_cast<long double>(y), static_cast<long double>(x));
            ASSERT_LE(error_of(nav_atan2(y, x), exact), 1e-15) << y << " " << x;
        }
    }
}

TEST(NavMath, ArcTangentKnowsItsAxes)
{
    EXPECT_EQ(nav_atan2(0.0, 0.0), 0.0);
    EXPECT_EQ(nav_atan2(0.0, 5.0), 0.0);
    EXPECT_EQ(nav_atan2(5.0, 0.0), NAV_PI / 2.0);
    EXPECT_EQ(nav_atan2(-5.0, 0.0), -NAV_PI / 2.0);
    EXPECT_EQ(nav_atan2(0.0, -5.0), NAV_PI);
    EXPECT_EQ(nav_atan2(-0.0, -5.0), NAV_PI);
    EXPECT_EQ(nav_atan2(1.0, 1.0), NAV_PI / 4.0);
    EXPECT_EQ(nav_atan2(1e-320, 1e308), 0.0);
    EXPECT_EQ(nav_atan2(1e308, 1e-320), NAV_PI / 2.0);
}

TEST(NavMath, ArcSineAndArcCosineStayWithinTheirErrorBound)
{
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> sines(-1.0, 1.0);
    for (int i = 0; i < kSamples; i++)
    {
        double x = sines(random);
        x = (i % 4 == 0) ? std::copysign(1.0 - std::fabs(x) * 1e-9, x) : x;
        ASSERT_LE(error_of(nav_asin(x), std::asin(static_cast<long double>(x))), 2e-15) << x;
        ASSERT_LE(error_of(nav_acos(x), std::acos(static_cast<long double>(x))), 2e-15) << x;
    }
}

TEST(NavMath, ArcSineAndArcCosineClampTheirArgument)
{
    EXPECT_EQ(nav_asin(1.0), NAV_PI / 2.0);
    EXPECT_EQ(nav_asin(1.5), NAV_PI / 2.0);
    EXPECT_EQ(nav_asin(-7.0), -NAV_PI / 2.0);
    EXPECT_EQ(nav_acos(1.0), 0.0);
    EXPECT_EQ(nav_acos(1.5), 0.0);
    EXPECT_EQ(nav_acos(-1.5), NAV_PI);
}

TEST(NavMath, AnAngleAlreadyWrappedIsLeftAlone)
{
    for (double angle = -NAV_PI; angle < NAV_PI; angle += 0.01)
    {
        ASSERT_EQ(nav_wrap_angle(angle), angle);
    }
}

TEST(NavMath, WrappedAnglesAreTheSameDirectionWithinHalfATurn)
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> angles(-1e4, 1e4);
    for (int i = 0; i < kSamples; i++)
    {
        const double angle = angles(random);
        const double wrapped = nav_wrap_angle(angle);
        ASSERT_GE(wrapped, -NAV_PI);
        ASSERT_LT(wrapped, NAV_PI);
        ASSERT_LE(std::fabs(nav_sin(angle) - nav_sin(wrapped)), 3e-15);
        ASSERT_LE(std::fabs(nav_cos(angle) - nav_cos(wrapped)), 3e-15);
    }
}

TEST(NavMath, WrappingIsSafeAtTheEndsOfItsRange)
{
    EXPECT_EQ(nav_wrap_angle(NAV_PI), -NAV_PI);
    EXPECT_EQ(nav_wrap_angle(-NAV_PI), -NAV_PI);
    EXPECT_EQ(nav_wrap_angle(std::nextafter(NAV_PI, 0.0)), std::nextafter(NAV_PI, 0.0));
    EXPECT_NEAR(std::fabs(nav_wrap_angle(std::nextafter(-NAV_PI, -4.0))), NAV_PI, 1e-15);
    for (double angle = 3.0; angle < 1e308; angle *= 3.7)
    {
        const double wrapped = nav_wrap_angle(-angle);
        ASSERT_GE(wrapped, -NAV_PI);
        ASSERT_LT(wrapped, NAV_PI);
    }
}

TEST(NavMath, FinitenessIsReadFromTheBits)
{
    for (double x : {0.0, -0.0, 1.0, -1e308, 5e-324, std::numeric_limits<double>::max()})
    {
        EXPECT_TRUE(nav_isfinite(x));
    }
    uint64_t payload = 0xFFF0000000000123ULL;
    double odd_nan = 0.0;
    std::memcpy(&odd_nan, &payload, sizeof(odd_nan));
    for (double x : {kInfinity, -kInfinity, kNan, -kNan, odd_nan})
    {
        EXPECT_FALSE(nav_isfinite(x));
    }
}

TEST(NavMath, MinimumMaximumAndClampPickTheRightOne)
{
    EXPECT_EQ(nav_min(1.0, 2.0), 1.0);
    EXPECT_EQ(nav_min(2.0, 1.0), 1.0);
    EXPECT_EQ(nav_max(1.0, 2.0), 2.0);
    EXPECT_EQ(nav_max(2.0, 1.0), 2.0);
    EXPECT_EQ(nav_clamp(-3.0, -1.0, 1.0), -1.0);
    EXPECT_EQ(nav_clamp(3.0, -1.0, 1.0), 1.0);
    EXPECT_EQ(nav_clamp(0.5, -1.0, 1.0), 0.5);
}

TEST(NavMath, FloorIndexRoundsDown)
{
    int32_t index = 99;
    const struct
    {
        double x;
        int32_t index;
    } cases[] = {{0.0, 0},
                 {-0.0, 0},
                 {0.999, 0},
                 {1.0, 1},
                 {-0.001, -1},
                 {-1.0, -1},
                 {-1.5, -2},
                 {1073741823.0, 1073741823},
                 {-1073741823.5, -1073741824}};
    for (const auto &c : cases)
    {
        EXPECT_TRUE(nav_floor_index(c.x, &index));
        EXPECT_EQ(index, c.index);
    }
}

TEST(NavMath, FloorIndexRefusesWhatHasNone)
{
    for (double x : {kNan, kInfinity, -kInfinity, 1073741824.0, -1073741824.0, 1e300})
    {
        int32_t index = 99;
        EXPECT_FALSE(nav_floor_index(x, &index));
        EXPECT_EQ(index, 0);
    }
}

TEST(NavMath, WrapIndexIsTheModuloForBothSigns)
{
    for (int32_t size : {1, 2, 5, 300})
    {
        for (int32_t index = -1000; index <= 1000; index++)
        {
            const int32_t wrapped = nav_wrap_index(index, size);
            ASSERT_GE(wrapped, 0);
            ASSERT_LT(wrapped, size);
            ASSERT_EQ((index - wrapped) % size, 0);
        }
    }
    EXPECT_EQ(nav_wrap_index(INT32_MIN, 300), 52);
}
