#include "host_sim/twins/ideal_thruster.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace vbar::twins {
namespace {

using fsw::GpsTime;
using fsw::Vector3;

constexpr GpsTime kNow{1'000'000'000'000'000'000};
constexpr GpsTime kBurn = kNow + fsw::duration_of_seconds(30);

vbar::maneuver_command command(std::int32_t id, const Vector3& dv_rtn) {
  vbar::maneuver_command message{};
  message.maneuver_id = id;
  for (int k = 0; k < 3; ++k) message.dv_rtn[k] = dv_rtn(k);
  return message;
}

IdealThruster thruster(double magnitude_error, double pointing_error_rad, std::uint64_t seed = 1) {
  return {{1, 2, magnitude_error, pointing_error_rad}, engine::RandomStream(seed, "servicer/thruster")};
}

Vector3 executed(const Execution& execution) {
  return Eigen::Map<const Vector3>(execution.maneuver.dv_rtn);
}

const Vector3 kDv(0.1, -0.2, 0.05);

TEST(IdealThruster, ExecutesTheCommandBitForBit) {
  IdealThruster ideal = thruster(0.0, 0.0);
  const Execution execution = ideal.execute(command(7, kDv), kBurn, kNow);
  EXPECT_EQ(execution.time, kBurn);
  EXPECT_EQ(execution.maneuver.maneuver_id, 7);
  EXPECT_EQ(execution.maneuver.accepted, 1);
  EXPECT_EQ(executed(execution), kDv);
  EXPECT_TRUE(execution.notes.empty());

  const auto view = fsw::packets::parse_packet(execution.packet);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view.value().header.time, kBurn);
  EXPECT_EQ(view.value().header.spacecraft, 1);
  EXPECT_EQ(view.value().header.unit, 2);
  const auto message = fsw::packets::decode<vbar::executed_maneuver>(view.value());
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(message.value().maneuver_id, 7);
  EXPECT_EQ(message.value().accepted, 1);
  EXPECT_EQ(message.value().dv_rtn[1], -0.2);
}

TEST(IdealThruster, RefusesABurnInThePast) {
  IdealThruster ideal = thruster(0.0, 0.0);
  const Execution late = ideal.execute(command(1, kDv), kNow - fsw::Duration{1}, kNow);
  EXPECT_EQ(late.maneuver.accepted, 0);
  EXPECT_EQ(executed(late), Vector3::Zero());
  const auto view = fsw::packets::parse_packet(late.packet);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(fsw::packets::decode<vbar::executed_maneuver>(view.value()).value().accepted, 0);
  EXPECT_EQ(ideal.execute(command(2, kDv), kNow, kNow).maneuver.accepted, 1) << "the present is not the past";
}

TEST(IdealThruster, NumbersItsPackets) {
  IdealThruster ideal = thruster(0.0, 0.0);
  for (std::uint16_t k = 0; k < 3; ++k) {
    const Execution execution = ideal.execute(command(k, kDv), kBurn, kNow);
    EXPECT_EQ(fsw::packets::parse_packet(execution.packet).value().header.sequence_count, k);
  }
}

TEST(IdealThruster, RefusesToMakeAPacketOfNaN) {
  IdealThruster ideal = thruster(0.0, 0.0);
  const Vector3 bad(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  EXPECT_THROW(ideal.execute(command(1, bad), kBurn, kNow), std::runtime_error);
}

TEST(IdealThruster, ZeroImpulseStaysZeroWithErrors) {
  EXPECT_EQ(executed(thruster(0.1, 0.1).execute(command(1, Vector3::Zero()), kBurn, kNow)), Vector3::Zero());
}

constexpr int kBurns = 20000;

// With a magnitude error alone the impulse keeps its direction; its relative error has mean 0 and the stated sigma.
// Sample mean and variance of n normal draws scatter with sigma/sqrt(n) and sigma^2 sqrt(2/n); the bounds are 4.5 of
// these.
TEST(IdealThruster, MagnitudeErrorHasItsSigma) {
  IdealThruster noisy = thruster(0.02, 0.0);
  double mean = 0.0;
  double square = 0.0;
  for (int k = 0; k < kBurns; ++k) {
    const Vector3 dv = executed(noisy.execute(command(k, kDv), kBurn, kNow));
    EXPECT_LT(dv.cross(kDv).norm() / (dv.norm() * kDv.norm()), 1e-15);
    const double error = dv.norm() / kDv.norm() - 1.0;
    mean += error / kBurns;
    square += error * error / kBurns;
  }
  EXPECT_NEAR(mean, 0.0, 4.5 * 0.02 / std::sqrt(kBurns));
  EXPECT_NEAR(square, 0.02 * 0.02, 4.5 * 0.02 * 0.02 * std::sqrt(2.0 / kBurns));
}

// With a pointing error alone the magnitude stays; the angle is the length of two normal components, so its square has
// mean 2 sigma^2 and standard deviation 2 sigma^2, and no direction across the impulse is preferred.
TEST(IdealThruster, PointingErrorTiltsEvenlyAboutTheImpulse) {
  constexpr double kSigma = 0.01;
  IdealThruster noisy = thruster(0.0, kSigma);
  double square = 0.0;
  Vector3 mean_tilt = Vector3::Zero();
  for (int k = 0; k < kBurns; ++k) {
    const Execution execution = noisy.execute(command(k, kDv), kBurn, kNow);
    const Vector3 dv = executed(execution);
    EXPECT_NEAR(dv.norm(), kDv.norm(), 1e-15);
    const double angle = std::asin(dv.cross(kDv).norm() / (dv.norm() * kDv.norm()));
    ASSERT_EQ(execution.notes.size(), 2U);
    EXPECT_EQ(execution.notes[1].name, "pointing_error_rad");
    EXPECT_NEAR(execution.notes[1].value, angle, 1e-15 / kSigma) << "rounding of a cross product at small angles";
    square += angle * angle / kBurns;
    mean_tilt += (dv / kDv.norm() - std::cos(angle) * kDv.normalized()) / kBurns;
  }
  EXPECT_NEAR(square, 2.0 * kSigma * kSigma, 4.5 * 2.0 * kSigma * kSigma / std::sqrt(kBurns));
  EXPECT_LT(mean_tilt.norm(), 4.5 * std::sqrt(2.0) * kSigma / std::sqrt(kBurns));
}

TEST(IdealThruster, ErrorsBelongToTheManeuverNotToTheOrder) {
  IdealThruster forward = thruster(0.02, 0.01);
  IdealThruster backward = thruster(0.02, 0.01);
  std::vector<Vector3> first;
  for (int k = 0; k < 5; ++k) first.push_back(executed(forward.execute(command(k, kDv), kBurn, kNow)));
  for (int k = 4; k >= 0; --k)
    EXPECT_EQ(executed(backward.execute(command(k, kDv), kBurn, kNow)), first[static_cast<std::size_t>(k)]);
  EXPECT_NE(first[0], first[1]);
  EXPECT_NE(executed(thruster(0.02, 0.01, 2).execute(command(0, kDv), kBurn, kNow)), first[0]) << "another seed";
}

}  // namespace
}  // namespace vbar::twins
