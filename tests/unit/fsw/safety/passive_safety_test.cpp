// e/i-vector separation and the closest points of a free drift.

#include "fsw/safety/passive_safety.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/safety/linear_drift.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::safety {

namespace {

namespace mission = orbit::mission;
using orbit::QnsElements;

constexpr double kA = mission::kReferenceA;
constexpr double kRevolution = 5934.0;  // s, nodal period of the mission orbit and a bit

/// Metres to ROE.
Vector6 roe_of(double da, double dlambda, double dex, double dey, double dix, double diy) {
  Vector6 roe;
  roe << da, dlambda, dex, dey, dix, diy;
  return roe / kA;
}

TEST(EccentricityInclinationSeparation, OfParallelAndPerpendicularVectors) {
  // Parallel or antiparallel: the shorter one. Perpendicular: nothing. Between: singular values computed elsewhere.
  EXPECT_NEAR(eccentricity_inclination_separation(roe_of(0, 0, 0, 400, 0, 200), kA), 200.0, 1e-10);
  EXPECT_NEAR(eccentricity_inclination_separation(roe_of(0, 0, 0, 400, 0, -200), kA), 200.0, 1e-10);
  EXPECT_NEAR(eccentricity_inclination_separation(roe_of(0, 0, 300, 0, 0, 300), kA), 0.0, 1e-10);
  EXPECT_NEAR(eccentricity_inclination_separation(roe_of(0, 0, 300, 0, 300 * std::sqrt(0.5), 300 * std::sqrt(0.5)), kA),
              162.35883,
              5e-6);  // printed digits
  EXPECT_NEAR(eccentricity_inclination_separation(roe_of(0, 0, 3, 1, -1, 2), kA), 0.25877718, 5e-9);
  EXPECT_EQ(eccentricity_inclination_separation(Vector6::Zero(), kA), 0.0);
}

TEST(EccentricityInclinationSeparation, IsTheLeastDistanceInTheRnPlane) {
  std::mt19937_64 generator(6);
  std::uniform_real_distribution<double> unit(-300.0, 300.0);
  for (int k = 0; k < 100; ++k) {
    const double dex = unit(generator), dey = unit(generator), dix = unit(generator), diy = unit(generator);
    accuracy::Smallest least;
    for (int j = 0; j < 100000; ++j) {
      const double u = j * 2e-5 * math::kPi;
      least.add(std::hypot(dex * std::cos(u) + dey * std::sin(u), dix * std::sin(u) - diy * std::cos(u)));
    }
    // Sampled 6e-5 rad apart, 3e-5 from the minimum: at most 420 m times that where the ellipse is flat.
    EXPECT_NEAR(eccentricity_inclination_separation(roe_of(0, 0, dex, dey, dix, diy), kA), least, 0.015);
  }
}

TEST(Drift, OfTheWaypointsKeepsTheirSeparation) {
  // Least RN distance over a revolution in the linear map with fixed ROE, m (sampled independently): with a da of -87 m
  // the ellipse of waypoint 1 is shifted towards the servicer. dlambda = 0 here: it bends the orbit of waypoint 1 down
  // by 177 m. Over the revolution J2 turns the e-vector by 0.0037 and the i-vector by up to 0.0081 rad the other way;
  // equal vectors lose half of the angle between them (0.6 %), unequal ones less.
  struct Row {
    std::size_t waypoint;
    double least, tolerance;
  };
  for (const Row& row : {Row{1, 913.0, 0.5}, Row{8, 0.9574, 1e-3}, Row{9, 1.0, 1e-3}, Row{10, 1.0, 6e-3}}) {
    Vector6 roe = mission::kWaypoints[row.waypoint].roe();
    roe(1) = 0.0;
    const DriftSafety drift = assess_drift(mission::kServicerMean, roe, kRevolution).value();
    EXPECT_NEAR(drift.radial_normal.distance, row.least, row.tolerance) << "waypoint " << row.waypoint;
  }
}

/// Closest points by the exact map, every two seconds: both mean orbits moved on, through their osculating states.
struct Exact {
  accuracy::Smallest spatial, radial_normal;
  accuracy::Largest farthest;
};

Exact exact_drift(const Vector6& roe, double horizon) {
  const QnsElements target = orbit::qns_from_roe(mission::kServicerMean, roe);
  Exact exact;
  for (double t = 0.0; t <= horizon; t += 2.0) {
    const QnsElements chief = orbit::propagate_secular(mission::kServicerMean, t);
    const Vector6 now = orbit::roe_from_qns(chief, orbit::propagate_secular(target, t));
    const Vector3 r = orbit::relative_state_from_mean_roe(chief, now).value().position_rtn;
    exact.spatial.add(r.norm());
    exact.radial_normal.add(std::hypot(r.x(), r.z()));
    exact.farthest.add(r.norm());
  }
  return exact;
}

/// Random drifts of 3 m to 3 km. One draw a line, the last component first: in what order arguments are worked out is
/// each compiler's own.
std::vector<Vector6> random_drifts(std::uint64_t seed, int count) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Vector6> drifts;
  for (int k = 0; k < count; ++k) {
    const double size = std::pow(10.0, 2.0 + 1.5 * unit(generator));
    Vector6 u;
    for (int component = 5; component >= 0; --component) u(component) = unit(generator);
    drifts.push_back(size * roe_of(0.1 * u(0), 3.0 * u(1), u(2), u(3), u(4), u(5)));
  }
  return drifts;
}

/// `share`: of (e + J2) times the largest separation on the way.
void expect_agreement(const std::vector<Vector6>& starts, double share) {
  const double e = std::hypot(mission::kServicerMean.ex, mission::kServicerMean.ey);
  for (const Vector6& roe : starts) {
    const DriftSafety drift = assess_drift(mission::kServicerMean, roe, 2.0 * kRevolution).value();
    const Exact exact = exact_drift(roe, 2.0 * kRevolution);
    const double stated = share * (e + orbit::kJ2) * exact.farthest;
    EXPECT_NEAR(drift.spatial.distance, exact.spatial, stated) << (kA * roe).transpose();
    EXPECT_NEAR(drift.radial_normal.distance, exact.radial_normal, stated) << (kA * roe).transpose();
  }
}

TEST(Drift, AgreesWithTheExactMapWithinItsStatedError) {
  std::vector<Vector6> starts = random_drifts(7, 30);
  for (const mission::Waypoint& waypoint : mission::kWaypoints) starts.push_back(waypoint.roe());
  expect_agreement(starts, 0.6);
}

// The worst of 1,500 was 0.845.
TEST(Drift, IsSeldomFartherOffThanThat) {
  expect_agreement(random_drifts(8, 150), 0.85);
}

TEST(Drift, FindsTheMinimumBetweenItsSamples) {
  // A fly-by: 900 m ahead, closing by 3 pi a da = 1.9 km a revolution. Samples are 59 s apart; the position is searched
  // every 0.05 s here.
  const Vector6 roe = roe_of(200.0, 900.0, 0.0, 120.0, 0.0, 80.0);
  const DriftSafety drift = assess_drift(mission::kServicerMean, roe, 2.0 * kRevolution).value();
  const QnsElements target = orbit::qns_from_roe(mission::kServicerMean, roe);
  accuracy::Smallest least, least_rn;
  for (double t = 0.0; t < 2.0 * kRevolution; t += 0.05) {
    const QnsElements chief = orbit::propagate_secular(mission::kServicerMean, t);
    const Vector6 now = orbit::roe_from_qns(chief, orbit::propagate_secular(target, t));
    const Vector6 x = orbit::rtn_from_roe_linear(chief, now) / kA;
    const double radius = 1.0 + x(0);
    const Vector3 r = kA * Vector3(radius * std::cos(x(2)) * std::cos(x(1)) - 1.0,
                                   radius * std::cos(x(2)) * std::sin(x(1)), radius * std::sin(x(2)));
    least.add(r.norm());
    least_rn.add(std::hypot(r.x(), r.z()));
  }
  // The parabola through samples 3.6 deg apart leaves (0.063 rad)^4/64 = 2.5e-7 of the orbit's size; time 0.05 s: less.
  EXPECT_NEAR(drift.spatial.distance, least, 0.05);
  EXPECT_NEAR(drift.radial_normal.distance, least_rn, 0.05);
}

TEST(Drift, SubtractsWhatIsUncertain) {
  const Vector6 roe = mission::kWaypoints[8].roe();
  const double horizon = kRevolution;
  const DriftSafety plain = assess_drift(mission::kServicerMean, roe, horizon).value();
  const DriftSafety rn = assess_drift(mission::kServicerMean, roe, horizon, {.radial_normal = 0.3}).value();
  EXPECT_NEAR(rn.radial_normal.distance, plain.radial_normal.distance - 0.3,
              1e-6);  // both refined by the same parabola
  EXPECT_LT(rn.spatial.distance, plain.spatial.distance);
  // An along-track position that is not known at all leaves the RN distance.
  const DriftSafety blind = assess_drift(mission::kServicerMean, roe, horizon, {.along_track = 1e6}).value();
  EXPECT_NEAR(blind.spatial.distance, plain.radial_normal.distance, 1e-9);
  // So does one whose error grows past the separation in time.
  const DriftSafety growing = assess_drift(mission::kServicerMean, roe, horizon, {.along_track_rate = 1.0}).value();
  EXPECT_LT(growing.spatial.distance, plain.spatial.distance);
  // Never below zero.
  const DriftSafety hopeless =
      assess_drift(mission::kServicerMean, roe, horizon, {.radial_normal = 50.0, .along_track = 50.0}).value();
  EXPECT_EQ(hopeless.spatial.distance, 0.0);
}

TEST(Drift, OfNoDurationIsThePresentDistance) {
  const Vector6 roe = mission::kWaypoints[8].roe();
  const DriftSafety drift = assess_drift(mission::kServicerMean, roe, 0.0).value();
  const Vector3 now = orbit::rtn_from_roe_linear(mission::kServicerMean, roe).head<3>();
  EXPECT_NEAR(drift.spatial.distance, now.norm(), 1e-3 * now.norm());  // curvature
  EXPECT_EQ(drift.spatial.time, 0.0);
}

TEST(Drift, RefusesWhatTheModelCannotSee) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const QnsElements servicer = mission::kServicerMean;
  const Vector6 roe = mission::kWaypoints[8].roe();
  EXPECT_EQ(assess_drift(servicer, roe, nan).status(), Status::kNotFinite);
  EXPECT_EQ(assess_drift(servicer, roe, -1.0).status(), Status::kOutOfRange);
  EXPECT_EQ(assess_drift(servicer, roe, 1e6).status(), Status::kOutOfRange);
  EXPECT_EQ(assess_drift(servicer, nan * roe, 100.0).status(), Status::kNotFinite);
  EXPECT_EQ(assess_drift(servicer, Vector6::Constant(0.6), 100.0).status(), Status::kOutOfRange);
  EXPECT_EQ(assess_drift(servicer, roe, 100.0, {.radial_normal = nan}).status(), Status::kNotFinite);
  QnsElements bad = servicer;
  bad.a = -1.0;
  EXPECT_EQ(assess_drift(bad, roe, 100.0).status(), Status::kOutOfRange);
  bad = servicer;
  bad.u = nan;
  EXPECT_EQ(assess_drift(bad, roe, 100.0).status(), Status::kNotFinite);
}

}  // namespace

// Free drifts from the paper's waypoints. The figures without a source in this file are of a separate implementation:
// J2 secular, linear map, sampled every 10 s, on the mission's orbit.

namespace {

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
