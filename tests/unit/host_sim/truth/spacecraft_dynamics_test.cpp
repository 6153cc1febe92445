#include "host_sim/truth/spacecraft_dynamics.h"

#include <exception>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/third_body_force.h"
#include "tests/unit/host_sim/truth/forces_fixture.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;
using test::dynamics_with;
using test::fly;
using test::InertialJ2;
using test::list;
using test::servicer_state;
using test::sunlight;

template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Dynamics, SharesAddUpAndLeaveTheRegime) {
  const auto dynamics = dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical),
                                           std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kSun)));
  dynamics->enter_regime_of(0.0, servicer_state());
  ASSERT_EQ(dynamics->edge_count(), 1);
  const auto side = dynamics->regime().sides;
  // Behind the Earth: there the light's share is nothing, whatever the integrator was told.
  CartesianState behind = servicer_state();
  behind.position_eci = -7e6 * sun_moon_series(tt_of(test::mission_epoch())).sun_eci.normalized();
  const auto shares = dynamics->accelerations(0.0, behind);
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_EQ(shares[0].force, "inertial J2");
  EXPECT_EQ(shares[1].force, "radiation_pressure");
  EXPECT_EQ(shares[1].acceleration_eci, Vector3::Zero());
  EXPECT_EQ(shares[2].force, "sun");
  EXPECT_EQ(dynamics->regime().sides, side);

  Vector3 sum = Vector3::Zero();
  for (const auto& share : dynamics->accelerations(0.0, servicer_state())) sum += share.acceleration_eci;
  EXPECT_EQ(sum, dynamics->perturbation_eci(0.0, servicer_state()));
}

TEST(Dynamics, MeasuresTimeOnlyWhenAsked) {
  const auto dynamics = dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)));
  const auto total = [&] {
    double sum = 0.0;
    for (const auto& time : dynamics->times()) sum += time.wall_s;
    return sum;
  };
  const Vector3 untimed = dynamics->perturbation_eci(0.0, servicer_state());
  EXPECT_EQ(total(), 0.0);
  dynamics->measure_time(true);
  EXPECT_EQ(dynamics->perturbation_eci(0.0, servicer_state()), untimed);
  EXPECT_GT(total(), 0.0);
  ASSERT_EQ(dynamics->times().size(), 3u);
  EXPECT_EQ(dynamics->times()[0].force, "frames");
  EXPECT_EQ(dynamics->times()[2].force, "radiation_pressure");
}

/// A thrust along the velocity, m/s^2: forwards it leaves the ellipse, backwards it falls.
class Thrust final : public Force {
 public:
  explicit Thrust(double along_velocity) : along_velocity_(along_velocity) {}
  std::string_view name() const override { return "thrust"; }
  Vector3 acceleration_eci(const ForceInput& input) override {
    return along_velocity_ * input.velocity_eci.normalized();
  }

 private:
  double along_velocity_;
};

TEST(Propagator, SaysWhoLeavesItsOrbitAndWhen) {
  // The mission begins at 2011-07-18T01:00:00 UTC; both last under an hour.
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(error_of([] { fly(list(std::make_unique<Thrust>(-0.5)), 1e-12, 20000.0); }),
              AllOf(HasSubstr("spacecraft \"test\": re-enters: "), HasSubstr(" km above the Earth at 2011-07-18T01:")));
  EXPECT_THAT(error_of([] { fly(list(std::make_unique<Thrust>(5.0)), 1e-12, 20000.0); }),
              AllOf(HasSubstr("spacecraft \"test\": the orbit is not an ellipse"), HasSubstr(", at 2011-07-18T01:")));
  const auto start_at = [](double scale_r, double scale_v) {
    CartesianState state = servicer_state();
    state.position_eci *= scale_r;
    state.velocity_eci *= scale_v;
    SpacecraftPropagator(dynamics_with({}), 1e-12, 0.0, state);
  };
  // 7076.7 km from the centre at the start: 79.9 and 80.1 km above 6378.1363 km.
  const double start = servicer_state().position_eci.norm();
  EXPECT_THAT(error_of([&] { start_at((test::kEarthRadius + 79.9e3) / start, 1.05); }),
              HasSubstr("spacecraft \"test\": re-enters: 79.9 km above the Earth at 2011-07-18T01:00:00"));
  EXPECT_EQ(error_of([&] { start_at((test::kEarthRadius + 80.1e3) / start, 1.05); }), "");
  EXPECT_THAT(error_of([&] { start_at(1.0, 1.5); }),
              HasSubstr("spacecraft \"test\": the orbit is not an ellipse: at distance"));
}

}  // namespace
}  // namespace vbar::truth
