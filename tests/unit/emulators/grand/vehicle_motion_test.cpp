// The motion flown from samples. Expected values: an analytic circular orbit, and the definition of the join.

#include "emulators/grand/radio_field/vehicle_motion.h"

#include <limits>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/grand_orbit.h"

namespace vbar::grand::bench {
namespace {

using fsw::Duration;
using fsw::Vector3;
using vbar::test::sample_in_orbit;

constexpr Duration kJoin{165'000'000};

constexpr Duration ms(std::int64_t milliseconds) {
  return {milliseconds * 1'000'000};
}

double error_mm(const VehicleMotion& motion, double t_s, const Vector3& offset = Vector3::Zero()) {
  return 1e3 * (motion.at(fsw::nearest_duration(t_s)).position - sample_in_orbit(t_s, offset).position_ecef_m).norm();
}

TEST(VehicleMotion, FliesAnOrbitWithinATenthOfAMillimetre) {
  VehicleMotion motion(kJoin);
  double worst_mm = 0.0;
  for (int k = 0; k <= 600; ++k) {
    EXPECT_EQ(motion.receive(sample_in_orbit(0.1 * k)), Reception::kAccepted);
    for (int part = 0; part <= 10 && k > 0; ++part) {
      motion.advance(ms(100 * (k - 1) + 10 * part));
      const double error = error_mm(motion, 0.1 * (k - 1) + 0.01 * part);
      if (!(error <= worst_mm)) worst_mm = error;
    }
  }
  // Snap of the orbit 1e-5 m/s^4 over 0.1 s: 4e-8 mm; double precision at 7e6 m: 1e-6 mm.
  EXPECT_LT(worst_mm, 1e-4);
  EXPECT_EQ(motion.counters().late + motion.counters().doubled + motion.counters().snaps, 0U);
}

TEST(VehicleMotion, FirstSampleHoldsBackwards) {
  VehicleMotion motion(kJoin);
  EXPECT_FALSE(motion.is_defined());
  EXPECT_FALSE(motion.is_radiated());
  motion.receive(sample_in_orbit(0.3));
  ASSERT_TRUE(motion.is_defined());
  EXPECT_LT(error_mm(motion, 0.0), 1e-4);
}

// A sample 3 mm, 6 mm/s and 20 mm/s^2 beside the motion flown: at both ends of the join value, velocity and
// acceleration agree with the old and the new curve.
TEST(VehicleMotion, JoinMeetsValueAndTwoDerivativesAtBothEnds) {
  const Vector3 dp(0.003, -0.001, 0.002), dv(0.006, 0.0, -0.004), da(0.0, 0.02, 0.01);
  VehicleMotion motion(kJoin);
  motion.receive(sample_in_orbit(0.0));
  motion.advance(ms(100));
  const MotionState before = motion.at(ms(100));
  TrajectorySample beside = sample_in_orbit(0.1);
  beside.position_ecef_m += dp;
  beside.velocity_ecef_mps += dv;
  beside.acceleration_ecef_mps2 += da;
  EXPECT_EQ(motion.receive(beside), Reception::kAccepted);
  const MotionState after = motion.at(ms(100));
  EXPECT_LT((after.position - before.position).norm(), 1e-8);
  EXPECT_LT((after.velocity - before.velocity).norm(), 1e-9);
  EXPECT_LT((after.acceleration - before.acceleration).norm(), 1e-9);

  // At the join's end: the beside sample's own polynomial, reached from both sides.
  const double h = seconds(kJoin);
  const Vector3 jerk = beside.jerk_ecef_mps3;
  const Vector3 v_end = beside.velocity_ecef_mps + h * (beside.acceleration_ecef_mps2 + 0.5 * h * jerk);
  const Vector3 p_end = beside.position_ecef_m +
                        h * (beside.velocity_ecef_mps + h * (0.5 * beside.acceleration_ecef_mps2 + h / 6.0 * jerk));
  for (const std::int64_t side_ns : {-1, 1}) {
    const MotionState end = motion.at(ms(100) + kJoin + Duration{side_ns});
    const double s = static_cast<double>(side_ns) * 1e-9;
    EXPECT_LT((end.position - p_end - s * v_end).norm(), 1e-7);
    EXPECT_LT((end.velocity - v_end - s * beside.acceleration_ecef_mps2).norm(), 1e-7);
    EXPECT_LT((end.acceleration - beside.acceleration_ecef_mps2 - h * jerk).norm(), 1e-5);
  }
  // In between the velocity is the derivative of the position (central difference over 2 ms; third derivative of the
  // quintic up to 60 * 4 mm / (0.165 s)^3 = 50 m/s^3: error below 1e-5).
  for (int k = 2; k < 160; k += 7) {
    const std::int64_t t = 100 + k;
    const Vector3 slope = (motion.at(ms(t + 1)).position - motion.at(ms(t - 1)).position) / 2e-3;
    EXPECT_LT((slope - motion.at(ms(t)).velocity).norm(), 5e-5);
  }
}

// Samples of 10 Hz and a join of 165 ms leave 65 ms for latency and network together.
TEST(VehicleMotion, LateSampleIsUsedFromNowOnAndCounted) {
  VehicleMotion motion(kJoin);
  motion.receive(sample_in_orbit(0.0));
  motion.receive(sample_in_orbit(0.1));
  motion.advance(ms(265));
  EXPECT_EQ(motion.receive(sample_in_orbit(0.2)), Reception::kAccepted);
  motion.advance(ms(366));
  const Vector3 offset(0.0, 0.0, 0.01);
  EXPECT_EQ(motion.receive(sample_in_orbit(0.3, offset)), Reception::kLate);
  EXPECT_EQ(motion.counters().late, 1U);
  EXPECT_LT(error_mm(motion, 0.366), 1e-4);          // nothing has changed at its reception
  EXPECT_LT(error_mm(motion, 0.531, offset), 1e-4);  // joined after 165 ms
  EXPECT_GT(error_mm(motion, 0.530, Vector3::Zero()), 9.0);
}

// Skydel's published example: 15 ms between samples, latency 40 ms, join 65 ms. Every sample that arrives within 10 ms
// keeps the motion deterministic; one that is lost does not.
TEST(VehicleMotion, StateFollowsLatencyPeriodAndJoin) {
  VehicleMotion motion(ms(65));
  motion.set_advance(ms(40));
  motion.receive(sample_in_orbit(0.0));
  for (int k = 1; k <= 20; ++k) {
    motion.advance(ms(15 * k + 9));
    EXPECT_TRUE(motion.is_deterministic()) << k;
    EXPECT_EQ(motion.receive(sample_in_orbit(0.015 * k)), Reception::kAccepted);
  }
  motion.advance(ms(15 * 22 - 1));  // the sample of 315 ms is lost
  EXPECT_FALSE(motion.is_deterministic());
  EXPECT_EQ(motion.receive(sample_in_orbit(0.330)), Reception::kAccepted);
  EXPECT_TRUE(motion.is_deterministic());
  EXPECT_EQ(motion.counters().late, 0U);
  motion.advance(ms(345 + 12));
  EXPECT_EQ(motion.receive(sample_in_orbit(0.345)), Reception::kLate);
}

// What is computed does not change any more: a sample takes effect after the engine's latency.
TEST(VehicleMotion, ComputedMotionRemains) {
  VehicleMotion motion(kJoin);
  motion.set_advance(ms(40));
  motion.receive(sample_in_orbit(0.0));
  motion.advance(ms(100));
  const Vector3 offset(0.0, 0.0, 0.01);
  motion.receive(sample_in_orbit(0.1, offset));
  motion.advance(ms(140));
  EXPECT_LT(error_mm(motion, 0.14), 1e-4);
  motion.advance(ms(306));
  EXPECT_LT(error_mm(motion, 0.306, offset), 1e-4);
}

TEST(VehicleMotion, DoubledAndOldSamplesAreIgnoredAndCounted) {
  VehicleMotion motion(kJoin);
  motion.receive(sample_in_orbit(0.0));
  EXPECT_EQ(motion.receive(sample_in_orbit(0.2)), Reception::kAccepted);
  EXPECT_EQ(motion.receive(sample_in_orbit(0.2)), Reception::kDoubled);
  EXPECT_EQ(motion.receive(sample_in_orbit(0.1)), Reception::kAccepted);  // out of order, but still in time
  motion.advance(ms(250));
  EXPECT_EQ(motion.receive(sample_in_orbit(0.2)), Reception::kDoubled);
  EXPECT_EQ(motion.receive(sample_in_orbit(0.1)), Reception::kDoubled);
  EXPECT_EQ(motion.receive(sample_in_orbit(0.15)), Reception::kOutOfOrder);
  EXPECT_EQ(motion.counters().samples, 7U);
  EXPECT_EQ(motion.counters().doubled, 3U);
  EXPECT_EQ(motion.counters().out_of_order, 1U);
  EXPECT_EQ(motion.counters().late, 0U);
  EXPECT_LT(error_mm(motion, 0.25), 1e-4);
}

// 2,000 samples of 50 Hz, sent 0.2 s ahead, through a network that loses 5 %, doubles 2 % and delays by 80 to 160 ms,
// so that neighbours change places: the counters are those of the network.
TEST(VehicleMotion, CountsWhatTheNetworkDid) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::multimap<std::int64_t, int> arrivals;  // ms, number of the sample
  constexpr int kSamples = 2000;
  std::uint64_t lost = 0, doubled = 0;
  double lead_sum_s = 0.0;
  const auto arrive = [&](int k) {
    const auto at_ms = static_cast<std::int64_t>(20 * k + 80 + 80.0 * uniform(random));
    arrivals.emplace(at_ms, k);
    return at_ms;
  };
  for (int k = 0; k < kSamples; ++k) {
    const double dice = uniform(random);
    if (k > 0 && k + 1 < kSamples && dice < 0.05) {
      ++lost;
      continue;
    }
    const bool is_doubled = dice > 0.98;
    doubled += is_doubled ? 1 : 0;
    const std::int64_t one_ms = arrive(k), other_ms = is_doubled ? arrive(k) : one_ms;
    lead_sum_s += 1e-3 * static_cast<double>(20 * k + 200 - std::min(one_ms, other_ms));
  }
  VehicleMotion motion(kJoin);
  for (const auto& [at_ms, k] : arrivals) {
    motion.advance(ms(at_ms));
    motion.receive(sample_in_orbit(0.02 * k + 0.2));
  }
  const MotionCounters& counters = motion.counters();
  EXPECT_EQ(counters.missing, lost);
  EXPECT_EQ(counters.doubled, doubled);
  EXPECT_EQ(counters.samples, kSamples - lost + doubled);
  EXPECT_NEAR(counters.lead_sum_s, lead_sum_s, 1e-6);
  EXPECT_NEAR(counters.lead_sum_s / static_cast<double>(kSamples - lost), 0.08, 0.002);
  EXPECT_EQ(counters.late, 0U);
}

TEST(VehicleMotion, MotionBeyondTenMetresJumps) {
  VehicleMotion motion(kJoin);
  motion.receive(sample_in_orbit(0.0));
  motion.receive(sample_in_orbit(0.1, Vector3(9.9, 0.0, 0.0)));
  motion.advance(ms(200));
  EXPECT_FALSE(motion.take_snap());
  motion.advance(ms(400));
  motion.receive(sample_in_orbit(0.4, Vector3(-1.0, 0.0, 0.0)));  // 10.9 m from the present motion
  EXPECT_TRUE(motion.take_snap());
  EXPECT_FALSE(motion.take_snap());
  EXPECT_EQ(motion.counters().snaps, 1U);
  EXPECT_LT(error_mm(motion, 0.4, Vector3(-1.0, 0.0, 0.0)), 1e-4);
}

TEST(VehicleMotion, StateAndRadiationFollowTheAgeOfTheLastSample) {
  VehicleMotion motion(kJoin);
  motion.receive(sample_in_orbit(0.0));
  motion.advance(ms(165));
  EXPECT_TRUE(motion.is_deterministic());
  motion.advance(ms(166));
  EXPECT_FALSE(motion.is_deterministic());
  motion.advance(ms(5000));
  EXPECT_TRUE(motion.is_radiated());
  motion.advance(ms(5001));
  EXPECT_FALSE(motion.is_radiated());
  motion.receive(sample_in_orbit(5.0));
  EXPECT_TRUE(motion.is_deterministic());
}

TEST(VehicleMotion, UnusableSamplesAreRejected) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  VehicleMotion motion(kJoin);
  motion.receive(sample_in_orbit(0.0));
  TrajectorySample bad = sample_in_orbit(0.1);
  bad.jerk_ecef_mps3.y() = nan;
  EXPECT_EQ(motion.receive(bad), Reception::kRejected);
  bad = sample_in_orbit(0.1);
  bad.yaw_pitch_roll.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(motion.receive(bad), Reception::kRejected);
  bad = sample_in_orbit(0.1);
  bad.position_ecef_m.setZero();
  EXPECT_EQ(motion.receive(bad), Reception::kRejected);
  EXPECT_EQ(motion.receive(sample_in_orbit(10.1)), Reception::kRejected);
  bad = sample_in_orbit(0.0);
  bad.time = Duration{-1};
  EXPECT_EQ(motion.receive(bad), Reception::kRejected);
  EXPECT_EQ(motion.counters().rejected, 5U);
  EXPECT_EQ(motion.newest().ns, 0);
}

// Zero angles: -z of north-east-down is the geodetic zenith. Pitch by -90 deg brings the boresight (-z of the antenna)
// to the north; a rate of 1 deg/s about x for 90 s from zero brings it to the east.
TEST(VehicleMotion, BoresightFollowsTheAttitude) {
  TrajectorySample sample;
  sample.position_ecef_m = Vector3(7.0e6, 0.0, 0.0);  // on the equator: up = x, east = y, north = z
  VehicleMotion zenith(kJoin);
  zenith.receive(sample);
  EXPECT_LT((zenith.boresight_ecef({}) - Vector3::UnitX()).norm(), 1e-12);

  sample.yaw_pitch_roll.y() = -std::numbers::pi / 2.0;
  VehicleMotion pitched(kJoin);
  pitched.receive(sample);
  EXPECT_LT((pitched.boresight_ecef({}) - Vector3::UnitZ()).norm(), 1e-12);

  sample.yaw_pitch_roll.setZero();
  sample.angular_rate.x() = std::numbers::pi / 180.0;
  VehicleMotion rolling(kJoin);
  rolling.receive(sample);
  EXPECT_LT((rolling.boresight_ecef(fsw::duration_of_seconds(90)) - Vector3::UnitY()).norm(), 1e-12);
}

}  // namespace
}  // namespace vbar::grand::bench
