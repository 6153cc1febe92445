// The GNSS sensor around a receiver made for the test, as the driver of a testbed would be.

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/packets/packet.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/gnss/gnss_sensor.h"
#include "host_sim/twins/ideal_navigation.h"

namespace vbar::twins {

namespace {

const fsw::GpsTime kStart = fsw::GpsTime{} + fsw::duration_of_seconds(1'000'000'000);

class Receiver final : public gnss::ReceiverBytes {
 public:
  void start(fsw::GpsTime first_epoch) override { started = first_epoch; }
  void stop(StopReason reason) override { stopped = reason; }
  TruthDetail truth_detail() const override { return TruthDetail::kAccelerations; }
  std::vector<Note> statistics() const override { return {{"late_samples", 3.0}}; }
  gnss::ReceiverOutput output_at(const gnss::BodyTruth& truth) override {
    last = truth;
    return output;
  }
  gnss::ReceiverOutput output;
  gnss::BodyTruth last;
  std::optional<fsw::GpsTime> started;
  std::optional<StopReason> stopped;
};

TruthSnapshot snapshot(fsw::GpsTime time) {
  TruthSnapshot truth;
  truth.time = time;
  SpacecraftTruth& one = truth.spacecraft.emplace_back();
  one.name = "servicer";
  one.orbit = {{7078e3, 0.0, 0.0}, {0.0, 7500.0, 0.0}};
  one.attitude = truth::AttitudeState{};
  one.acceleration_eci = fsw::Vector3(-8.0, 0.0, 0.0);
  return truth;
}

class GnssSensorTest : public testing::Test {
 protected:
  GnssSensorTest() {
    auto receiver = std::make_unique<Receiver>();
    receiver_ = receiver.get();
    sensor_ = std::make_unique<GnssSensor>(GnssSensor::Settings{"servicer", 1, kStart, fsw::Duration{100'000'000}},
                                           std::move(receiver), nullptr);
  }
  Receiver* receiver_ = nullptr;
  std::unique_ptr<GnssSensor> sensor_;
};

TEST_F(GnssSensorTest, PassesOnWhatTheReceiverGaveWhenItWasComplete) {
  receiver_->output.bytes.assign(3000, 0xAA);
  receiver_->output.delay = fsw::Duration{240'000'000};
  receiver_->output.notes = {{"edge_s", 1e-6}};
  const Measurement measurement = sensor_->measure(snapshot(kStart));
  EXPECT_EQ(measurement.status, MeasurementStatus::kReady);
  EXPECT_EQ(measurement.available, kStart + receiver_->output.delay);
  ASSERT_EQ(measurement.packets.size(), 4U) << "three pieces of bytes and the attitude";
  EXPECT_EQ(fsw::packets::parse_packet(measurement.packets[3]).value().header.apid, fsw::packets::Apid::kAttitude);
  ASSERT_EQ(measurement.notes.size(), 1U);
  EXPECT_EQ(receiver_->last.acceleration_eci.value(), fsw::Vector3(-8.0, 0.0, 0.0));
}

// A device delivers an epoch some tenths of a second after it: the attitude is that of the epoch.
TEST_F(GnssSensorTest, AttitudeIsThatOfTheEpochThatWasMeasured) {
  const Eigen::Quaterniond q_then(Eigen::AngleAxisd(0.1, fsw::Vector3::UnitX()));
  receiver_->output.bytes = {1};
  receiver_->output.measured =
      gnss::EpochAttitude{kStart - fsw::Duration{300'000'000}, q_then, fsw::Vector3(0.0, 0.0, 1e-3)};
  const Measurement measurement = sensor_->measure(snapshot(kStart));
  ASSERT_EQ(measurement.packets.size(), 2U);
  EXPECT_EQ(fsw::packets::parse_packet(measurement.packets[0]).value().header.time, kStart);
  const auto packet = fsw::packets::parse_packet(measurement.packets[1]).value();
  EXPECT_EQ(packet.header.time, kStart - fsw::Duration{300'000'000});
  const attitude message = fsw::packets::decode<attitude>(packet).value();
  EXPECT_EQ(message.q_eci_body[0], q_then.w());
  EXPECT_EQ(message.q_eci_body[1], -q_then.x());  // to ECI from body: the inverse
  EXPECT_EQ(message.rate_body[2], 1e-3);
}

TEST_F(GnssSensorTest, BytesThatReachTheFlightComputerOnTheirOwnLineAreNotSent) {
  receiver_->output.bytes = {1, 2, 3};
  receiver_->output.bytes_bypass_host = true;
  const Measurement measurement = sensor_->measure(snapshot(kStart));
  ASSERT_EQ(measurement.packets.size(), 1U);
  EXPECT_EQ(fsw::packets::parse_packet(measurement.packets[0]).value().header.apid, fsw::packets::Apid::kAttitude);
}

TEST_F(GnssSensorTest, SampleBetweenEpochsDeliversNothing) {
  receiver_->output.is_epoch = false;
  const Measurement measurement = sensor_->measure(snapshot(kStart));
  EXPECT_EQ(measurement.status, MeasurementStatus::kReady);
  EXPECT_TRUE(measurement.packets.empty());
}

TEST(GnssSensor, CallsAReceiverWhoseDataAreSentLaterFromTheStart) {
  auto receiver = std::make_unique<Receiver>();
  Receiver& called = *receiver;
  const fsw::Duration period{100'000'000};
  GnssSensor sensor({"servicer", 1, kStart, period, kStart + period}, std::move(receiver), nullptr);
  called.output.bytes = {1, 2, 3};
  EXPECT_EQ(sensor.next_epoch(kStart), kStart);
  EXPECT_TRUE(sensor.measure(snapshot(kStart)).packets.empty());
  EXPECT_EQ(called.last.time, kStart);
  EXPECT_EQ(sensor.measure(snapshot(kStart + period)).packets.size(), 2U) << "bytes and attitude";
}

TEST_F(GnssSensorTest, ReceiverThatGaveNothingFailsTheEpoch) {
  receiver_->output.failure = "/dev/ttyUSB1 hung up";
  const Measurement measurement = sensor_->measure(snapshot(kStart));
  EXPECT_EQ(measurement.status, MeasurementStatus::kFailed);
  EXPECT_EQ(measurement.reason, "GNSS: /dev/ttyUSB1 hung up");
}

TEST_F(GnssSensorTest, ReceiverLivesWithTheSensor) {
  sensor_->start(kStart);
  sensor_->stop(StopReason::kFailed);
  EXPECT_EQ(receiver_->started, kStart);
  EXPECT_EQ(receiver_->stopped, StopReason::kFailed);
  EXPECT_EQ(sensor_->truth_detail(), TruthDetail::kAccelerations);
  EXPECT_EQ(sensor_->statistics().at(0).name, "late_samples");
}

}  // namespace

namespace {

using fsw::GpsTime;

constexpr GpsTime kFirstEpoch{1'000'000'000'000'000'000};

IdealNavigation::Settings settings() {
  return {"servicer", 1, 3, "target", kFirstEpoch, fsw::duration_of_seconds(60)};
}

TruthSnapshot truth_at(GpsTime time) {
  TruthSnapshot truth;
  truth.time = time;
  truth.spacecraft.push_back({"target", {{7.0e6, 1.0, 2.0}, {3.0, 7.5e3, 4.0}}, {}});
  truth.spacecraft.push_back({"servicer", {{7.1e6, -1.0, -2.0}, {-3.0, 7.4e3, -4.0}}, {}});
  return truth;
}

TEST(IdealNavigation, SendsTheTrueStatesOfTheNamedSpacecraft) {
  IdealNavigation sensor(settings());
  const Measurement measurement = sensor.measure(truth_at(kFirstEpoch));
  ASSERT_EQ(measurement.status, MeasurementStatus::kReady);
  EXPECT_EQ(measurement.available, kFirstEpoch);
  EXPECT_FALSE(measurement.bypasses_link);
  ASSERT_EQ(measurement.packets.size(), 1U);

  const auto view = fsw::packets::parse_packet(measurement.packets[0]);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view.value().header.apid, fsw::packets::Apid::kIdealNavigation);
  EXPECT_EQ(view.value().header.time, kFirstEpoch);
  EXPECT_EQ(view.value().header.spacecraft, 1);
  EXPECT_EQ(view.value().header.unit, 3);
  const auto message = fsw::packets::decode<vbar::ideal_navigation>(view.value());
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(message.value().servicer_position_eci[0], 7.1e6);
  EXPECT_EQ(message.value().servicer_velocity_eci[2], -4.0);
  EXPECT_EQ(message.value().target_position_eci[1], 1.0);
  EXPECT_EQ(message.value().target_velocity_eci[1], 7.5e3);
}

TEST(IdealNavigation, NumbersItsPacketsModulo14Bits) {
  IdealNavigation sensor(settings());
  for (int k = 0; k <= 0x4000; ++k) {
    const Measurement measurement = sensor.measure(truth_at(kFirstEpoch + fsw::duration_of_seconds(60 * k)));
    const auto view = fsw::packets::parse_packet(measurement.packets.at(0));
    ASSERT_TRUE(view.ok());
    ASSERT_EQ(view.value().header.sequence_count, k & 0x3FFF);
  }
}

TEST(IdealNavigation, MeasuresEveryPeriodFromItsStart) {
  const IdealNavigation sensor(settings());
  const auto at = [](std::int64_t ns) { return kFirstEpoch + fsw::Duration{ns}; };
  constexpr std::int64_t kPeriod = 60'000'000'000;
  EXPECT_EQ(sensor.next_epoch(at(-5)), at(0));
  EXPECT_EQ(sensor.next_epoch(at(0)), at(0)) << "at or after";
  EXPECT_EQ(sensor.next_epoch(at(1)), at(kPeriod));
  EXPECT_EQ(sensor.next_epoch(at(kPeriod)), at(kPeriod));
  EXPECT_EQ(sensor.next_epoch(at(7 * kPeriod - 1)), at(7 * kPeriod));
}

TEST(IdealNavigation, FailsWithAReason) {
  IdealNavigation sensor(settings());
  TruthSnapshot alone = truth_at(kFirstEpoch);
  alone.spacecraft.erase(alone.spacecraft.begin());
  Measurement measurement = sensor.measure(alone);
  EXPECT_EQ(measurement.status, MeasurementStatus::kFailed);
  EXPECT_EQ(measurement.reason, "ideal navigation: no spacecraft \"target\"");
  EXPECT_TRUE(measurement.packets.empty());

  TruthSnapshot broken = truth_at(kFirstEpoch);
  broken.spacecraft[0].orbit.position_eci(1) = std::numeric_limits<double>::quiet_NaN();
  measurement = sensor.measure(broken);
  EXPECT_EQ(measurement.status, MeasurementStatus::kFailed);
  EXPECT_TRUE(measurement.packets.empty()) << "no NaN reaches a packet";

  // The failures have left no gap in the sequence.
  const Measurement good = sensor.measure(truth_at(kFirstEpoch));
  EXPECT_EQ(fsw::packets::parse_packet(good.packets.at(0)).value().header.sequence_count, 0);
}

}  // namespace

namespace {

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
  return {{1, 2, {magnitude_error, pointing_error_rad}}, engine::RandomStream(seed, "servicer/thruster")};
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
