// The GNSS sensor around a receiver made for the test, as the driver of a testbed would be.

#include "host_sim/twins/gnss_sensor.h"

#include <gtest/gtest.h>

#include "fsw/packets/packet.h"

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
}  // namespace vbar::twins
