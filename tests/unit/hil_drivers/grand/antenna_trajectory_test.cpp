// The sample of an antenna's trajectory: its derivatives are those of one curve, which finite differences of its
// positions and attitudes show; attitude and boresight agree with the body frame of the digital twin.

#include "hil_drivers/grand/trajectory/antenna_trajectory.h"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/core/gps_time.h"
#include "fsw/gnss/constants.h"
#include "hil_drivers/grand/trajectory/antenna_attitude.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "tests/support/gnss_scene.h"

namespace vbar::grand::test {

namespace {

using fsw::Matrix3;
using fsw::Vector3;
using twins::gnss::BodyTruth;
using vbar::test::kGnssStart;

/// Keplerian circular motion of the scene with its accelerations.
BodyTruth orbit_truth(double t_s) {
  BodyTruth truth = vbar::test::in_orbit(t_s);
  const double r = truth.position_eci.norm();
  truth.acceleration_eci = -fsw::gnss::kGmGps / (r * r * r) * truth.position_eci;
  truth.angular_acceleration_body = Vector3::Zero();
  return truth;
}

/// The same orbit, the body spinning with a constant angular acceleration about an axis fixed in body and space.
BodyTruth spinning_truth(double t_s) {
  constexpr double kRate = 0.02, kAcceleration = 3e-4;
  const Vector3 axis = Vector3(1.0, -2.0, 0.5).normalized();
  BodyTruth truth = orbit_truth(t_s);
  const double angle = kRate * t_s + 0.5 * kAcceleration * t_s * t_s;
  truth.q_body_eci = Eigen::Quaterniond(Eigen::AngleAxisd(-angle, axis));
  truth.rate_body_eci = (kRate + kAcceleration * t_s) * axis;
  truth.angular_acceleration_body = kAcceleration * axis;
  return truth;
}

AntennaTrajectory trajectory(double arm_m, double noise_mm) {
  twins::gnss::BodyFrameSettings settings;
  settings.antenna_in_body_m = arm_m * Vector3(0.3, -0.5, 0.8);
  settings.boresight_in_body = Vector3(0.2, 0.1, 1.0).normalized();
  settings.pco_noise_mm = noise_mm;
  return {settings, {}, kGnssStart, 7, "servicer"};
}

AntennaTrajectory ideal() {
  twins::gnss::BodyFrameSettings settings;
  settings.com_radius_mm = settings.pco_bias_mm = settings.pco_noise_mm = 0.0;
  settings.antenna_direction_arcsec = settings.attitude_knowledge_arcsec = 0.0;
  return {settings, {}, kGnssStart, 1, "servicer"};
}

/// Central difference of order four of `value` at t_s.
template <class Value>
Vector3 derivative(AntennaTrajectory& antenna, BodyTruth (*truth)(double), double t_s, double h_s, Value value) {
  const auto at = [&](double t) { return Vector3(value(antenna.at(truth(t)))); };
  return (8.0 * (at(t_s + h_s) - at(t_s - h_s)) - (at(t_s + 2 * h_s) - at(t_s - 2 * h_s))) / (12.0 * h_s);
}

struct Case {
  const char* name;
  BodyTruth (*truth)(double);
  double noise_mm;
  std::array<double, 4> times_s;
  std::array<double, 3> tolerances;  ///< of velocity, acceleration and jerk, SI
};

class Derivatives : public testing::TestWithParam<Case> {};

// Order-four differences with h = 0.5 s err by h^4/30 = 2e-3 s^4 of the fifth derivative. That of the noise's quintic
// is 720 times a step of up to 5 mm over (10 s)^5: 8e-8 m/s in the velocity, and in a body that turns at w a sixth and
// a seventh derivative of 6 w and 21 w^2 times it: 2e-8 m/s^2 and 2e-9 m/s^3 at 0.048 rad/s. An arm of 10 m that turns
// so: 10 w^5, 6e-9 m/s, and less for the others; the orbit 2e-11 m/s. Rounding of positions is 2e-9 m / h.
TEST_P(Derivatives, AreThoseOfOneCurve) {
  AntennaTrajectory antenna = trajectory(10.0, GetParam().noise_mm);
  for (const double t : GetParam().times_s) {
    const TrajectorySample sample = antenna.at(GetParam().truth(t));
    const auto of = [&](auto member) {
      return derivative(antenna, GetParam().truth, t, 0.5, [member](const TrajectorySample& s) { return s.*member; });
    };
    const auto& [velocity, acceleration, jerk] = GetParam().tolerances;
    EXPECT_LT((of(&TrajectorySample::position_ecef_m) - sample.velocity_ecef_mps).norm(), velocity) << t;
    EXPECT_LT((of(&TrajectorySample::velocity_ecef_mps) - sample.acceleration_ecef_mps2).norm(), acceleration) << t;
    EXPECT_LT((of(&TrajectorySample::acceleration_ecef_mps2) - sample.jerk_ecef_mps3).norm(), jerk) << t;
  }
}

// dR/dt = R [w x] with the rate in antenna axes, so that R^T dR/dt holds it.
TEST_P(Derivatives, AngularRateIsThatOfTheAttitudeAgainstTheLocalFrame) {
  AntennaTrajectory antenna = trajectory(1.0, GetParam().noise_mm);
  for (const double t : GetParam().times_s) {
    const TrajectorySample sample = antenna.at(GetParam().truth(t));
    const auto R_at = [&](double s) { return R_ned_antenna(antenna.at(GetParam().truth(s)).yaw_pitch_roll); };
    const double h = 0.25;
    const Matrix3 R_dot = (8.0 * (R_at(t + h) - R_at(t - h)) - (R_at(t + 2 * h) - R_at(t - 2 * h))) / (12.0 * h);
    const Matrix3 W = R_at(t).transpose() * R_dot;
    // h^4/30 of the fifth derivative, w^5 = 3e-7 at 0.048 rad/s: 3e-11; rounding 1e-15 / h.
    EXPECT_LT((Vector3(W(2, 1), W(0, 2), W(1, 0)) - sample.angular_rate).norm(), 5e-11) << t;
    const Vector3 acceleration =
        derivative(antenna, GetParam().truth, t, h, [](const TrajectorySample& s) { return s.angular_rate; });
    EXPECT_LT((acceleration - sample.angular_acceleration).norm(), 5e-11) << t;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Truths, Derivatives,
    testing::Values(Case{"Orbit", orbit_truth, 0.0, {3.0, 50.5, 1000.0, 2903.0}, {1e-8, 1e-9, 1e-9}},
                    Case{"OrbitWithNoise", orbit_truth, 1.0, {3.0, 50.5, 1000.0, 2903.0}, {1e-7, 1e-9, 1e-9}},
                    Case{"Spin", spinning_truth, 0.0, {3.0, 12.5, 50.5, 93.0}, {1e-8, 2e-9, 1e-9}},
                    Case{"SpinWithNoise", spinning_truth, 1.0, {3.0, 12.5, 50.5, 93.0}, {1e-7, 3e-8, 5e-9}}),
    [](const auto& chosen) { return chosen.param.name; });

/// The orbit over the real Earth: polar motion, precession and nutation.
BodyTruth real_earth_truth(double t_s) {
  static truth::EarthRotation earth(
      std::make_shared<const truth::EarthOrientationSeries>(
          truth::EarthOrientationSeries::load(vbar::test::data_directory() / "earth" / "eop_2009_2013.csv")),
      kGnssStart);
  BodyTruth truth = orbit_truth(t_s);
  truth.R_ecef_eci = earth.R_itrf_gcrf_at(t_s);
  return truth;
}

// Velocity, acceleration and jerk sent against differences of the positions sent, those of an antenna at the centre of
// mass without noise. Errors of the differences with h = 2 s: h^4/30 of the fifth, h^4/90 of the sixth and h^2/4 of the
// fifth derivative (1e-8 m/s^5 in this orbit), and rounding of positions, 2e-9 m over h, h^2 and h^3. The Earth's axis
// about z alone would be 1 mm/s off (0.4 arcsec of polar motion), without precession and nutation 0.04 mm/s.
TEST(AntennaTrajectory, DerivativesSentAreThoseOfThePositionsSent) {
  AntennaTrajectory antenna = ideal();
  antenna.observe_earth(kGnssStart + fsw::Duration{100'000'000}, real_earth_truth(0.1).R_ecef_eci);
  constexpr double h = 2.0;
  for (const double t : {4.0, 1400.0, 5000.0, 43000.0}) {
    std::array<Vector3, 5> r;
    for (std::size_t k = 0; k < r.size(); ++k)
      r[k] = antenna.at(real_earth_truth(t + h * (static_cast<double>(k) - 2.0))).position_ecef_m;
    const TrajectorySample sample = antenna.at(real_earth_truth(t));
    const Vector3 velocity = (8.0 * (r[3] - r[1]) - (r[4] - r[0])) / (12.0 * h);
    const Vector3 acceleration = (16.0 * (r[3] + r[1]) - (r[4] + r[0]) - 30.0 * r[2]) / (12.0 * h * h);
    const Vector3 jerk = (r[4] - 2.0 * r[3] + 2.0 * r[1] - r[0]) / (2.0 * h * h * h);
    EXPECT_LT((velocity - sample.velocity_ecef_mps).norm(), 1e-6) << t;
    EXPECT_LT((acceleration - sample.acceleration_ecef_mps2).norm(), 1e-7) << t;
    EXPECT_LT((jerk - sample.jerk_ecef_mps3).norm(), 1e-7) << t;
  }
}

// The first sample of a run has no sample before it.
TEST(AntennaTrajectory, TheFirstSampleKnowsTheEarthsAxis) {
  AntennaTrajectory antenna = ideal(), other = ideal();
  antenna.observe_earth(kGnssStart + fsw::Duration{100'000'000}, real_earth_truth(0.1).R_ecef_eci);
  const TrajectorySample first = antenna.at(real_earth_truth(0.0));
  static_cast<void>(other.at(real_earth_truth(0.1)));
  const Vector3 velocity = other.at(real_earth_truth(0.0)).velocity_ecef_mps;
  EXPECT_LT((first.velocity_ecef_mps - velocity).norm(), 1e-7);
  EXPECT_GT((first.velocity_ecef_mps - ideal().at(real_earth_truth(0.0)).velocity_ecef_mps).norm(), 1e-4);
}

TEST(AntennaTrajectory, IsThePhaseCentreOfTheDigitalTwin) {
  twins::gnss::BodyFrameSettings settings;
  settings.pco_noise_mm = 0.0;
  AntennaTrajectory antenna(settings, {}, kGnssStart, 5, "target");
  const auto errors = twins::gnss::draw_body_frame(settings, 5, "target");
  for (const double t : {0.0, 777.0}) {
    const BodyTruth truth = spinning_truth(t);
    const TrajectorySample sample = antenna.at(truth);
    const Vector3 arm = truth.q_body_eci.conjugate() * twins::gnss::antenna_from_com(settings, errors);
    // Rounding at 7e6 m.
    EXPECT_LT((sample.position_ecef_m - truth.R_ecef_eci * (truth.position_eci + arm)).norm(), 1e-8);
    const Vector3 boresight =
        truth.R_ecef_eci * (truth.q_body_eci.conjugate() * twins::gnss::true_boresight(settings, errors));
    EXPECT_LT((boresight_ecef(sample) - boresight).norm(), 1e-14);
    EXPECT_EQ(sample.time, truth.time - kGnssStart);
  }
}

// The geodetic zenith is the normal of the ellipsoid; its height grows along it.
TEST(AntennaTrajectory, AnAntennaThatPointsToTheZenithHasNoPitchAndNoRoll) {
  for (const double t : {0.0, 500.0, 1400.0}) {
    BodyTruth truth = orbit_truth(t);
    const auto at = truth::geodetic_from_itrf(truth.R_ecef_eci * truth.position_eci);
    const Vector3 zenith_eci =
        truth.R_ecef_eci.transpose() * Vector3(std::cos(at.latitude) * std::cos(at.longitude),
                                               std::cos(at.latitude) * std::sin(at.longitude), std::sin(at.latitude));
    truth.q_body_eci = Eigen::Quaterniond::FromTwoVectors(zenith_eci, Vector3::UnitZ());
    const TrajectorySample sample = ideal().at(truth);
    // The antenna is 0.3 m above the centre of mass, on the same normal.
    EXPECT_NEAR(sample.yaw_pitch_roll.y(), 0.0, 1e-14);
    EXPECT_NEAR(sample.yaw_pitch_roll.z(), 0.0, 1e-14);
  }
}

TEST(AntennaTrajectory, YawIsTheAzimuthOfTheForwardAxis) {
  // On the equator at longitude 0: east is y, north is z. The antenna's x to the east, its -z to the zenith.
  TrajectorySample sample;
  sample.position_ecef_m = {7.0e6, 0.0, 0.0};
  sample.yaw_pitch_roll = {std::numbers::pi / 2.0, 0.0, 0.0};
  EXPECT_LT((boresight_ecef(sample) - Vector3::UnitX()).norm(), 1e-15);
  EXPECT_LT((R_ned_antenna(sample.yaw_pitch_roll) * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
  // Pitched up by 30 deg the boresight leans backwards, to the west.
  sample.yaw_pitch_roll.y() = std::numbers::pi / 6.0;
  EXPECT_LT((boresight_ecef(sample) - Vector3(std::sqrt(0.75), -0.5, 0.0)).norm(), 1e-15);
  // Rolled to the right, which is the south.
  sample.yaw_pitch_roll = {std::numbers::pi / 2.0, 0.0, std::numbers::pi / 6.0};
  EXPECT_LT((boresight_ecef(sample) - Vector3(std::sqrt(0.75), 0.0, -0.5)).norm(), 1e-15);
}

TEST(AntennaTrajectory, YawPitchRollReadBack) {
  for (const double yaw : {-3.0, 0.0, 1.2})
    for (const double pitch : {-1.4, 0.0, 0.7})
      for (const double roll : {-2.5, 0.1, 3.0}) {
        const Vector3 angles(yaw, pitch, roll);
        EXPECT_LT((yaw_pitch_roll(R_ned_antenna(angles)) - angles).norm(), 1e-13);
      }
}

TEST(AntennaTrajectory, RefusesATruthWithoutAccelerationOrBeforeTheStart) {
  AntennaTrajectory antenna = ideal();
  BodyTruth truth = orbit_truth(1.0);
  truth.acceleration_eci.reset();
  EXPECT_THROW(antenna.at(truth), std::invalid_argument);
  EXPECT_THROW(antenna.at(orbit_truth(-1.0)), std::invalid_argument);
  truth = orbit_truth(1.0);
  truth.velocity_eci.y() = std::nan("");
  EXPECT_THROW(antenna.at(truth), std::invalid_argument);
}

// At the start of a run the attitude is known for less time than its differences need.
TEST(AntennaTrajectory, WithoutAnAngularAccelerationItIsZero) {
  BodyTruth truth = orbit_truth(1.0);
  const TrajectorySample with_zero = ideal().at(truth);
  truth.angular_acceleration_body.reset();
  EXPECT_EQ(ideal().at(truth).acceleration_ecef_mps2, with_zero.acceleration_ecef_mps2);
}

}  // namespace

// The noise of the phase centre: at the receiver's epochs independent normal values, between them a curve without steps
// in position, velocity and acceleration.

namespace {

constexpr fsw::GpsTime kEpoch{(std::int64_t{1'000'000} * 10 + 9) * fsw::kNanosecondsPerSecond};

PhaseCentreNoise noise(std::uint64_t seed = 3) {
  return {1e-3, {}, seed, "servicer"};
}

TEST(PhaseCentreNoise, HasTheGivenSigmaAndIsIndependentFromEpochToEpoch) {
  PhaseCentreNoise source = noise();
  constexpr int kEpochs = 20000;
  Vector3 square = Vector3::Zero();
  double product = 0.0;
  Vector3 previous = Vector3::Zero();
  for (int k = 0; k < kEpochs; ++k) {
    const Vector3 value = source.at(kEpoch + fsw::duration_of_seconds(10 * k))[0];
    square += value.cwiseAbs2();
    product += value.dot(previous);
    previous = value;
  }
  // Relative standard error of a variance from n values: sqrt(2/n) = 1 %; of a correlation over 3n products:
  // 1/sqrt(3n) = 0.4 %. Four of each.
  for (const double sum : square) EXPECT_NEAR(sum / kEpochs / 1e-6, 1.0, 0.04);
  EXPECT_NEAR(product / square.sum(), 0.0, 0.016);
}

TEST(PhaseCentreNoise, HasNoStepsAtAnEpochAndRestsThere) {
  PhaseCentreNoise source = noise();
  const fsw::Duration instant{1};
  const auto before = source.at(kEpoch - instant);
  const auto at = source.at(kEpoch);
  const auto after = source.at(kEpoch + instant);
  // A nanosecond at the largest velocity, acceleration and jerk of a step of some millimetres in 10 s.
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT((at[k] - before[k]).norm(), 1e-11) << k;
    EXPECT_LT((after[k] - at[k]).norm(), 1e-11) << k;
  }
  EXPECT_EQ(at[1].norm(), 0.0);
  EXPECT_EQ(at[2].norm(), 0.0);
  EXPECT_GT(at[0].norm(), 0.0);
}

TEST(PhaseCentreNoise, DerivativesAreThoseOfTheCurve) {
  PhaseCentreNoise source = noise();
  const fsw::Duration h{10'000'000};
  for (int epoch = 0; epoch < 3; ++epoch) {
    // Not at the epochs themselves, where the third derivative jumps.
    for (std::int64_t tenth = 1; tenth < 100; ++tenth) {
      const fsw::GpsTime t = kEpoch + fsw::duration_of_seconds(10 * epoch) + fsw::Duration{tenth * 100'000'000};
      const auto low = source.at(t - h);
      const auto high = source.at(t + h);
      const auto here = source.at(t);
      // Differences err by h^2/6 of the third derivative after the one in question, at most 5e-3 m * 720/10^4..5.
      for (int d = 0; d < 3; ++d)
        EXPECT_LT(((high[d] - low[d]) / 0.02 - here[d + 1]).norm(), 1e-8) << epoch << ' ' << tenth << ' ' << d;
    }
  }
}

// The same instants give the same values in any order, so that a run does not depend on which samples were sent.
TEST(PhaseCentreNoise, DependsOnTheTimeOnly) {
  PhaseCentreNoise forward = noise(), jumping = noise();
  std::vector<Vector3> values;
  for (std::int64_t k = 0; k < 50; ++k) values.push_back(forward.at(kEpoch + fsw::Duration{k * 700'000'000})[0]);
  for (std::int64_t k = 49; k >= 0; --k)
    EXPECT_EQ(jumping.at(kEpoch + fsw::Duration{k * 700'000'000})[0], values[static_cast<std::size_t>(k)]);
  EXPECT_NE(noise(4).at(kEpoch)[0], values[0]);
}

TEST(PhaseCentreNoise, RefusesAPeriodThatIsNotPositive) {
  EXPECT_THROW(PhaseCentreNoise(1e-3, {fsw::Duration{0}, fsw::Duration{0}}, 1, "servicer"), std::invalid_argument);
}

}  // namespace

}  // namespace vbar::grand::test
