// Waypoints that a mission states as position and velocity in RTN.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/rtn.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

using fsw::Vector3;
using fsw::Vector6;
using testing::HasSubstr;

fsw::orbit::QnsElements servicer_mean(const Mission& mission) {
  const auto& orbit = std::get<OrbitByElements>(mission.find_spacecraft("servicer")->orbit);
  return fsw::orbit::mean_from_osculating(orbit.elements).value();
}

TEST(RtnWaypoints, AreTheStateThatTheFlightSoftwareDerivesFromTheElements) {
  const Mission mission =
      small_mission({"waypoint.0.position_rtn_m=[12, -950, 40]", "waypoint.0.velocity_rtn_mps=[0.01, -0.02, 0.03]"});
  const Vector6 roe = mission.find_waypoint(0)->a_roe_m / mission.guidance.reference_semi_major_axis_m;
  const auto state = fsw::orbit::relative_state_from_mean_roe(servicer_mean(mission), roe);
  ASSERT_TRUE(state.ok());
  EXPECT_LT((state.value().position_rtn - Vector3(12, -950, 40)).norm(), 2e-3);
  EXPECT_LT((state.value().velocity_rtn - Vector3(0.01, -0.02, 0.03)).norm(), 5e-6);
}

TEST(RtnWaypoints, OnTheVBarAreADistanceAlongTheTrack) {
  // Of a nearly circular orbit: e = 1.5e-3, and J2 changes elements by 1e-3 of their differences.
  const Mission mission =
      small_mission({"waypoint.1.position_rtn_m=[0, -600, 0]", "waypoint.1.velocity_rtn_mps=[0, 0, 0]"});
  const Vector6 expected = (Vector6() << 0, -600, 0, 0, 0, 0).finished();
  EXPECT_LT((mission.find_waypoint(1)->a_roe_m - expected).norm(), 600 * 5e-3);
}

TEST(RtnWaypoints, OfARelativeEllipseHaveItsElements) {
  // Parallel eccentricity and inclination vectors of 30 m, the target at its highest point: x = 30, vy = -2 n 30.
  const Mission nominal = small_mission({});
  const double n = std::sqrt(3.986004418e14 / std::pow(7087.3e3, 3));
  const Mission mission = small_mission(
      {"waypoint.1.position_rtn_m=[30, -600, 0]",
       "waypoint.1.velocity_rtn_mps=[0, " + std::to_string(-2.0 * n * 30.0) + ", " + std::to_string(n * 30.0) + "]"});
  const Vector6& a_roe_m = mission.find_waypoint(1)->a_roe_m;
  EXPECT_NEAR(a_roe_m(0), 0.0, 4.0);
  EXPECT_NEAR(std::hypot(a_roe_m(2), a_roe_m(3)), 30.0, 2.0);
  EXPECT_NEAR(std::hypot(a_roe_m(4), a_roe_m(5)), 30.0, 2.0);
}

TEST(RtnWaypoints, BadOnesEndWithOneMessage) {
  EXPECT_THAT(message_of(std::string(kSmallMission), {"waypoint.1.velocity_rtn_mps=[0, 0, 0]"}),
              HasSubstr("a velocity without position_rtn_m"));
  EXPECT_THAT(message_of(std::string(kSmallMission), {"waypoint.1.position_rtn_m=[0, 30]"}),
              HasSubstr("waypoint.1.position_rtn_m"));
  EXPECT_THAT(message_of(std::string(kSmallMission), {"waypoint.1.position_rtn_m=[0, 30, 0]"}),
              HasSubstr("waypoint.1.velocity_rtn_mps: found nothing"));
  EXPECT_THAT(message_of(std::string(kSmallMission),
                         {"waypoint.1.position_rtn_m=[0, 2e5, 0]", "waypoint.1.velocity_rtn_mps=[0, 0, 0]"}),
              HasSubstr("accepted: "));
}

}  // namespace
}  // namespace vbar::mission::test
