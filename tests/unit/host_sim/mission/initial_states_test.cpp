#include "host_sim/mission/initial_states.h"

#include <gtest/gtest.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

using fsw::orbit::CartesianState;

Mission ideal_navigation() {
  return load_mission(VBAR_SOURCE_DIR "/missions/ideal_navigation.toml");
}

// The paper's element table as an ECI state, computed with an independent program (double precision, mu of GGM05S):
// printed to 0.1 mm and 1e-10 m/s, so half of that is the bound, plus rounding of 7e6 m in a double, 1e-9 m.
TEST(InitialStates, ServicerStandsWhereThePapersElementsPutIt) {
  const Mission mission = ideal_navigation();
  const auto& orbit = std::get<OrbitByElements>(mission.find_spacecraft("servicer")->orbit);
  const auto state = state_at_epoch(orbit);
  ASSERT_TRUE(state.ok());
  const fsw::Vector3 position(12161.8456633, -7076153.584868, -84606.5539942);
  const fsw::Vector3 velocity(-1068.5690877908, -90.5830005301, 7433.7358593127);
  EXPECT_NEAR((state.value().position_eci - position).norm(), 0.0, 1e-6);
  EXPECT_NEAR((state.value().velocity_eci - velocity).norm(), 0.0, 1e-9);
}

// Mean elements of the servicer by an independent program (first-order Brouwer), to the digits printed there.
TEST(InitialStates, MeanElementsGiveTheSameOrbitAsOsculatingOnes) {
  OrbitByElements mean{ElementsKind::kMean, {}};
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  mean.elements = {7078138.944,          0.00104134174,         1.5923745e-5,
                   98.1853293 * kDegree, -90.0001291 * kDegree, -0.6886792 * kDegree};
  const auto from_mean = state_at_epoch(mean);
  const auto from_osculating =
      state_at_epoch(std::get<OrbitByElements>(ideal_navigation().find_spacecraft("servicer")->orbit));
  ASSERT_TRUE(from_mean.ok() && from_osculating.ok());
  // 1e-7 deg of the printed angles is 6 mm at 7.1e6 m a half digit, 1e-11 of e 0.07 mm: a bound of 3 cm holds all of
  // them.
  EXPECT_LT((from_mean.value().position_eci - from_osculating.value().position_eci).norm(), 0.03);
}

// Back through both mean element sets the target's ROE are those of the waypoint: 75 km ahead of nothing else.
TEST(InitialStates, TargetStandsAtItsWaypoint) {
  const Mission mission = ideal_navigation();
  const auto servicer = state_at_epoch(std::get<OrbitByElements>(mission.find_spacecraft("servicer")->orbit));
  ASSERT_TRUE(servicer.ok());
  const auto target =
      state_at_waypoint(mission, std::get<OrbitByWaypoint>(mission.find_spacecraft("target")->orbit), servicer.value());
  ASSERT_TRUE(target.ok());

  const auto mean_of = [](const CartesianState& state) {
    return fsw::orbit::mean_from_osculating(fsw::orbit::qns_from_cartesian(state).value()).value();
  };
  const fsw::Vector6 a_roe_m =
      7078138.944 * fsw::orbit::roe_from_qns(mean_of(servicer.value()), mean_of(target.value()));
  const fsw::Vector6 expected(-2000.0, -75000.0, 0.0, 0.0, 0.0, 0.0);
  // The mean map is a fixed point to 1e-12 rad, 7 micrometres here, twice; ten of these.
  EXPECT_LT((a_roe_m - expected).cwiseAbs().maxCoeff(), 1e-4);
  // Physically: the target is behind the servicer, so 75 km against the servicer's velocity.
  const fsw::Vector3 relative = target.value().position_eci - servicer.value().position_eci;
  const double along_track = relative.dot(servicer.value().velocity_eci.normalized());
  EXPECT_NEAR(along_track, -75000.0, 500.0);  // mean against osculating: up to 390 m at this waypoint, and curvature
}

TEST(InitialStates, UnknownWaypointIsRefused) {
  const Mission mission = small_mission();
  const auto servicer = state_at_epoch(std::get<OrbitByElements>(mission.find_spacecraft("servicer")->orbit));
  ASSERT_TRUE(servicer.ok());
  EXPECT_EQ(state_at_waypoint(mission, {"servicer", 99}, servicer.value()).status(), fsw::Status::kInvalidArgument);
}

}  // namespace
}  // namespace vbar::mission::test
