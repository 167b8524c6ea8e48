// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

extern "C"
{
#include "nav_arc.h"
#include "nav_math.h"
}

namespace
{

nav_params_t defaults()
{
    nav_params_t params;
    nav_params_default(&params);
    return params;
}

const nav_steering_t kStraight = {0.0, 0U, 0U};
const nav_steering_t kInPlace = {0.0, 1U, 0U};

nav_steering_t curved(double curvature_per_m)
{
    return {curvature_per_m, 0U, 0U};
}

} // namespace

TEST(NavArc, AStraightArcKeepsItsHeading)
{
    const nav_pose2_t start = {1.0, 2.0, 0.5};
    const nav_arc_t arc = {3.0, 0.0};
    const nav_pose2_t pose = nav_arc_pose(&start, &arc, 0.5);
    EXPECT_NEAR(pose.x_m, 1.0 + 1.5 * std::cos(0.5), 1e-14);
    EXPECT_NEAR(pose.y_m, 2.0 + 1.5 * std::sin(0.5), 1e-14);
    EXPECT_EQ(pose.yaw_rad, 0.5);
}

TEST(NavArc, APositiveHeadingChangeTurnsEastWhenDrivingNorth)
{
    const nav_pose2_t start = {0.0, 0.0, 0.0};
    const nav_arc_t quarter = {NAV_PI, NAV_PI / 2.0}; // radius 2 m
    const nav_pose2_t pose = nav_arc_pose(&start, &quarter, 1.0);
    EXPECT_NEAR(pose.x_m, 2.0, 1e-14);
    EXPECT_NEAR(pose.y_m, 2.0, 1e-14);
    EXPECT_NEAR(pose.yaw_rad, NAV_PI / 2.0, 1e-15);
}

TEST(NavArc, DrivingBackwardUndoesDrivingForward)
{
    const nav_pose2_t start = {5.0, -3.0, 2.0};
    const nav_arc_t there = {2.5, 0.8};
    const nav_arc_t back = {-2.5, -0.8};
    const nav_pose2_t end = nav_arc_pose(&start, &there, 1.0);
    const nav_pose2_t again = nav_arc_pose(&end, &back, 1.0);
    EXPECT_NEAR(again.x_m, start.x_m, 1e-14);
    EXPECT_NEAR(again.y_m, start.y_m, 1e-14);
    EXPECT_NEAR(again.yaw_rad, start.yaw_rad, 1e-14);
}

TEST(NavArc, ATurnInPlaceStaysInPlaceAndWrapsItsYaw)
{
    const nav_pose2_t start = {5.0, -3.0, 3.0};
    const nav_arc_t turn = {0.0, 1.0};
    const nav_pose2_t pose = nav_arc_pose(&start, &turn, 1.0);
    EXPECT_EQ(pose.x_m, 5.0);
    EXPECT_EQ(pose.y_m, -3.0);
    EXPECT_NEAR(pose.yaw_rad, 4.0 - 2.0 * NAV_PI, 1e-15);
}

TEST(NavArc, PosesLieOnTheCircleForEveryHeadingChange)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> exponents(-15.0, 0.7);
    const nav_pose2_t start = {0.0, 0.0, 0.0};
    for (int i = 0; i < 100000; i++)
    {
        const double change = std::pow(10.0, exponents(random)) * ((i % 2 == 0) ? 1.0 : -1.0);
        const nav_arc_t arc = {3.0, change};
        const long double angle = static_cast<long double>(change);
        const nav_pose2_t pose = nav_arc_pose(&start, &arc, 1.0);
        const long double half = angle / 2.0L;
        ASSERT_NEAR(pose.x_m, static_cast<double>(3.0L * std::sin(angle) / angle), 3e-15);
        ASSERT_NEAR(pose.y_m, static_cast<double>(3.0L * std::sin(half) / half * std::sin(half)),
                    3e-15);
    }
}

TEST(NavArc, TheFractionIsContinuousAcrossTheSwitchOfFormulas)
{
    const nav_pose2_t start = {0.0, 0.0, 0.0};
    for (double half : {0.99999e-4, 1.00001e-4})
    {
        const nav_arc_t arc = {6.0, 2.0 * half};
        EXPECT_NEAR(nav_arc_pose(&start, &arc, 1.0).x_m, 6.0 * std::sin(2.0 * half) / (2.0 * half),
                    1e-14);
    }
}

TEST(NavArc, SteeringIsTheCurvature)
{
    nav_arc_t arc = {3.0, 0.6};
    EXPECT_DOUBLE_EQ(nav_arc_steering(&arc).curvature_per_m, 0.2);
    EXPECT_EQ(nav_arc_steering(&arc).in_place, 0U);
    arc = {-3.0, 0.6};
    EXPECT_DOUBLE_EQ(nav_arc_steering(&arc).curvature_per_m, -0.2);
    arc = {0.0, -0.6};
    EXPECT_EQ(nav_arc_steering(&arc).in_place, 1U);
    EXPECT_EQ(nav_arc_steering(&arc).curvature_per_m, 0.0);
    EXPECT_EQ(nav_arc_steering(&arc).pad_0, 0U);
    arc = {0.0, 0.0};
    EXPECT_EQ(nav_arc_steering(&arc).in_place, 0U);
    EXPECT_EQ(nav_arc_steering(&arc).curvature_per_m, 0.0);
}

TEST(NavArc, AnArcShorterThanAMicrometreIsATurnInPlace)
{
    nav_arc_t arc = {5e-324, 1.0};
    EXPECT_EQ(nav_arc_steering(&arc).in_place, 1U);
    arc = {-0.99e-6, 1.0};
    EXPECT_EQ(nav_arc_steering(&arc).in_place, 1U);
    arc = {1.01e-6, 1.0};
    EXPECT_EQ(nav_arc_steering(&arc).in_place, 0U);
}

TEST(NavArc, AStraightArcIsDrivenAtFullSpeed)
{
    const nav_params_t params = defaults();
    const nav_arc_t forward = {3.0, 0.0};
    const nav_arc_t backward = {-3.0, 0.0};
    EXPECT_DOUBLE_EQ(nav_arc_duration_s(&params, &forward), 3.0 / params.speed_max_m_per_s);
    EXPECT_DOUBLE_EQ(nav_arc_duration_s(&params, &backward), 3.0 / params.speed_max_m_per_s);
}

TEST(NavArc, TheFastestWheelOfACurveRunsAtFullSpeed)
{
    const nav_params_t params = defaults();
    const double radius = 4.0;
    const double fastest = std::max({std::hypot(params.front_x_m, radius + params.front_y_m),
                                     radius + params.middle_y_m,
                                     std::hypot(params.rear_x_m, radius + params.rear_y_m)});
    for (double sign : {-1.0, 1.0})
    {
        const nav_arc_t arc = {3.0, sign * 3.0 / radius};
        EXPECT_NEAR(nav_arc_duration_s(&params, &arc),
                    3.0 * fastest / radius / params.speed_max_m_per_s, 1e-10);
    }
}

TEST(NavArc, ATurnInPlaceTakesTheTimeOfTheOutermostWheel)
{
    nav_params_t params = defaults();
    const nav_arc_t turn = {0.0, -NAV_PI / 2.0};
    const double outermost = std::hypot(params.front_x_m, params.front_y_m);
    EXPECT_NEAR(nav_arc_duration_s(&params, &turn),
                outermost * NAV_PI / 2.0 / params.speed_max_m_per_s, 1e-10);
    const nav_arc_t nothing = {0.0, 0.0};
    EXPECT_EQ(nav_arc_duration_s(&params, &nothing), 0.0);
}

TEST(NavArc, TighteningACurveTendsToTheTurnInPlace)
{
    const nav_params_t params = defaults();
    const nav_arc_t tight = {1e-5, 1.0};
    const nav_arc_t turn = {0.0, 1.0};
    EXPECT_NEAR(nav_arc_duration_s(&params, &tight), nav_arc_duration_s(&params, &turn), 1e-3);
}

TEST(NavArc, TheSameSteeringTakesNoTime)
{
    const nav_params_t params = defaults();
    const nav_steering_t curve = curved(0.3);
    EXPECT_EQ(nav_arc_steering_duration_s(&params, &kStraight, &kStraight), 0.0);
    EXPECT_EQ(nav_arc_steering_duration_s(&params, &curve, &curve), 0.0);
    EXPECT_EQ(nav_arc_steering_duration_s(&params, &kInPlace, &kInPlace), 0.0);
}

TEST(NavArc, SteeringTakesTheTimeOfTheWheelThatTurnsFurthest)
{
    const nav_params_t params = defaults();
    const nav_steering_t right = curved(0.25);
    const nav_steering_t left = curved(-0.25);
    const double inner_front = std::atan2(params.front_x_m, 4.0 - params.front_y_m);
    const double expected = inner_front / params.steering_rate_rad_per_s;
    EXPECT_NEAR(nav_arc_steering_duration_s(&params, &kStraight, &right), expected, 1e-12);
    EXPECT_NEAR(nav_arc_steering_duration_s(&params, &left, &kStraight), expected, 1e-12);
    const double outer_front = std::atan2(params.front_x_m, 4.0 + params.front_y_m);
    EXPECT_NEAR(nav_arc_steering_duration_s(&params, &left, &right),
                (inner_front + outer_front) / params.steering_rate_rad_per_s, 1e-12);
}

TEST(NavArc, ForATurnInPlaceNoWheelTurnsBeyondAQuarter)
{
    const nav_params_t params = defaults();
    const double front = std::atan2(params.front_x_m, params.front_y_m);
    const double rear = std::atan2(-params.rear_x_m, params.rear_y_m);
    EXPECT_NEAR(nav_arc_steering_duration_s(&params, &kStraight, &kInPlace),
                std::max(front, rear) / params.steering_rate_rad_per_s, 1e-12);
    for (double curvature : {1e7, -1e7})
    {
        const nav_steering_t tight = curved(curvature);
        EXPECT_NEAR(nav_arc_steering_duration_s(&params, &tight, &kInPlace), 0.0, 1e-4);
    }
}

TEST(NavArc, PosesAreNoFurtherApartThanTheSpacing)
{
    const nav_params_t params = defaults();
    const struct
    {
        nav_arc_t arc;
        uint32_t count;
    } cases[] = {{{3.0, 0.0}, 12U},      {{-3.0, 0.0}, 12U},    {{3.001, 0.0}, 13U},
                 {{2.999, 0.0}, 12U},    {{0.25, 0.0}, 1U},     {{0.2501, 0.0}, 2U},
                 {{0.0, 0.0}, 1U},       {{5e-324, 0.0}, 1U},   {{0.0, 0.15}, 1U},
                 {{0.0, 0.16}, 2U},      {{0.0, -NAV_PI}, 20U}, {{3.0, 1.0}, 12U},
                 {{0.001, NAV_PI}, 20U}, {{10.0, 0.0}, 40U},    {{16.0, 0.0}, 64U},
                 {{16.1, 0.0}, 64U},     {{1e300, 0.0}, 64U}};
    for (const auto &c : cases)
    {
        EXPECT_EQ(nav_arc_pose_count(&params, &c.arc), c.count)
            << c.arc.length_m << " " << c.arc.heading_change_rad;
    }
}
