// Free drifts from the paper's waypoints. The figures without a source in this file are of a separate implementation:
// J2 secular, linear map, sampled every 10 s, on the mission's orbit.

#include "fsw/safety/linear_drift.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "fsw/orbit/secular.h"
#include "fsw/safety/passive_safety.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::safety {
namespace {

namespace mission = orbit::mission;

constexpr double kDay_s = 86400.0;

/// Mean elements of the servicer at a waypoint.
orbit::QnsElements servicer_at(std::size_t waypoint) {
  return orbit::propagate_secular(mission::kServicerMean, 3600.0 * mission::kWaypoints[waypoint].time_h);
}
Vector6 a_roe_of(std::size_t waypoint) {
  return Vector6(mission::kWaypoints[waypoint].a_roe_m.data());
}
LinearDrift drift_from(std::size_t waypoint) {
  return LinearDrift::make(servicer_at(waypoint), kDay_s).value();
}

TEST(LinearDrift, LeastDistancesFromTheLastWaypoints) {
  EXPECT_NEAR(drift_from(8).min_distance(a_roe_of(8)), 1.498, 0.005);
  EXPECT_NEAR(drift_from(9).min_distance(a_roe_of(9)), 5.16, 0.02);
  EXPECT_NEAR(drift_from(10).min_distance(a_roe_of(10)), 6.46, 0.02);
}

TEST(LinearDrift, ErrorsOfSemiMajorAxisAndDrag) {
  EXPECT_NEAR(drift_from(9).min_distance(a_roe_of(9), {.a_da_m = -0.05}), 0.99, 0.02);
  EXPECT_NEAR(drift_from(10).min_distance(a_roe_of(10), {.a_da_m = -0.05}), 0.95, 0.02);
  EXPECT_NEAR(drift_from(10).min_distance(a_roe_of(10), {.differential_drag = -1e-9}), 0.80, 0.02);
}

// Constant acceleration along track moves the target by -3/2 d t^2 in the mean, and nothing else within a millimetre:
// the far end of a drift that only drag drives.
TEST(LinearDrift, DragDrivesTheTargetBack) {
  const LinearDrift drift = drift_from(10);
  Vector6 a_roe = Vector6::Zero();
  a_roe(1) = 20.0;
  const double end_s = drift.time_s(drift.samples() - 1);
  const double drag = 1e-9;
  const double along = 20.0 - 1.5 * drag * end_s * end_s;
  const double radial = 2.0 * drag / orbit::mean_motion(servicer_at(10).a) * end_s;
  EXPECT_NEAR(drift.min_distance(a_roe, {.differential_drag = drag}), std::hypot(along, radial), 0.02);
}

// Errors that began to act earlier: a da in error delays by 3/2 n da t, and drag as above, over the whole time.
TEST(LinearDrift, ErrorsThatHaveActedBefore) {
  const LinearDrift drift = drift_from(10);
  const double n = orbit::mean_motion(servicer_at(10).a);
  Vector6 a_roe = Vector6::Zero();
  a_roe(1) = 40.0;
  const double before_s = 2100.0;
  const double end_s = before_s + drift.time_s(drift.samples() - 1);
  const double drag = 1e-9;
  const double da = 0.05;
  const double along = 40.0 - 1.5 * drag * end_s * end_s - 1.5 * n * da * end_s;
  const double radial = da + 2.0 * drag / n * end_s;
  EXPECT_NEAR(drift.min_distance(a_roe, {.a_da_m = da, .differential_drag = drag, .acted_for = before_s}),
              std::hypot(along, radial), 0.03);
}

// Another model of the same drift: exact elements, curvilinear, a hundred samples a revolution.
TEST(LinearDrift, AgreesWithTheCurvilinearDrift) {
  for (std::size_t waypoint = 4; waypoint <= 10; ++waypoint) {
    const auto servicer = servicer_at(waypoint);
    const Vector6 a_roe = a_roe_of(waypoint);
    const double other = assess_drift(servicer, a_roe / servicer.a, kDay_s).value().spatial.distance;
    EXPECT_NEAR(drift_from(waypoint).min_distance(a_roe), other, 0.003 * std::abs(a_roe(1)) + 0.01) << waypoint;
  }
}

TEST(LinearDrift, TheMapIsThatOfTheOrbitLibrary) {
  const auto servicer = servicer_at(9);
  const LinearDrift drift = drift_from(9);
  const Vector6 a_roe = a_roe_of(9);
  for (const int sample : {0, 7, 36, 400}) {
    const double t = drift.time_s(sample);
    const auto then = orbit::propagate_secular(servicer, t);
    const Vector6 roe = orbit::roe_transition_j2(servicer, t) * a_roe / then.a;
    const Vector3 expected = orbit::rtn_from_roe_linear(then, roe).head<3>();
    EXPECT_LT((drift.map_at(sample) * a_roe - expected).norm(), 0.005) << sample;
  }
}

TEST(LinearDrift, ADriftThatIsTooCloseIsNotFollowedFurther) {
  const LinearDrift drift = drift_from(8);
  EXPECT_LT(drift.min_distance(a_roe_of(8), {}, 2.0), 2.0);
  EXPECT_GE(drift.min_distance(a_roe_of(8), {}, 2.0), drift.min_distance(a_roe_of(8)));
}

TEST(LinearDrift, RefusesWhatIsNoDrift) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(LinearDrift::make(servicer_at(8), nan).status(), Status::kNotFinite);
  EXPECT_EQ(LinearDrift::make(servicer_at(8), 0.0).status(), Status::kOutOfRange);
  EXPECT_EQ(LinearDrift::make(servicer_at(8), 10.0 * kDay_s).status(), Status::kOutOfRange);
  auto broken = servicer_at(8);
  broken.a = -1.0;
  EXPECT_EQ(LinearDrift::make(broken, kDay_s).status(), Status::kOutOfRange);
}

}  // namespace
}  // namespace vbar::fsw::safety
