// Packets of a sensor in another process that cannot be those of a measurement are rejected and counted; the run goes
// on.

#include "hil_drivers/external/external_source.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/external/exchange.h"

namespace vbar::external {
namespace {

using testing::HasSubstr;

constexpr fsw::GpsTime kStart{1'000'000'000'000'000'000};
constexpr fsw::Duration kPeriod = fsw::duration_of_seconds(10);
constexpr std::uint8_t kSpacecraft = 1;

/// Answers each batch with ranges of these header times, which leave the sensor at its epoch.
class Program final : public pil::FlightComputer {
 public:
  explicit Program(const std::vector<fsw::GpsTime>& times) : times_(times) {}

  pil::StepResult step(std::uint32_t step, std::span<const pil::Packet> packets) override {
    const Batch batch = batch_of(packets, SpacecraftNumbers());
    Answer answer;
    answer.available = batch.time;
    answer.next_epoch = step == 0 ? batch.time : batch.time + kPeriod;
    fsw::packets::PacketHeader header;
    header.spacecraft = kSpacecraft;
    for (const fsw::GpsTime time : times_) {
      header.time = time;
      vbar::range_measurement message{};
      message.range_m = 8.0;
      if (step > 0) answer.packets.push_back(packet_of(header, message));
    }
    pil::StepResult result;
    result.packets = packets_of(std::move(answer), batch.time);
    return result;
  }
  pil::LinkStatistics statistics() const override { return {}; }
  std::string description() const override { return "ranges"; }
  void close() override {}

 private:
  const std::vector<fsw::GpsTime>& times_;
};

class ExternalSourceTest : public testing::Test {
 protected:
  [[nodiscard]] twins::Measurement measure(int epoch) {
    twins::TruthSnapshot truth;
    truth.time = kStart + fsw::duration_of_seconds(10 * epoch);
    return source_->measure(truth);
  }
  void make(testbeds::PacketPlan plan = {}) {
    plan.name = "servicer/lidar";
    plan.allowed = {fsw::packets::Apid::kRangeMeasurement};
    plan.spacecraft = kSpacecraft;
    source_ = std::make_unique<ExternalSource>(std::move(plan), 1, SpacecraftNumbers(),
                                               [this] { return std::make_unique<Program>(times_); });
    source_->start(kStart);
  }

  std::vector<fsw::GpsTime> times_;
  std::unique_ptr<ExternalSource> source_;
};

TEST_F(ExternalSourceTest, ATimeOutsideTheEpochIsRejected) {
  make();
  const fsw::GpsTime present = kStart + fsw::duration_of_seconds(20), last = kStart + kPeriod;
  static_cast<void>(measure(1));
  times_ = {present,
            last,
            present + fsw::duration_of_seconds(1000),
            last - fsw::duration_of_seconds(1000),
            fsw::GpsTime{0},
            fsw::GpsTime{std::numeric_limits<std::int64_t>::max()}};
  const twins::Measurement measurement = measure(2);
  EXPECT_EQ(measurement.packets.size(), 2U);
  EXPECT_EQ(measurement.status, twins::MeasurementStatus::kReady);
  ASSERT_EQ(measurement.notes.size(), 1U);
  EXPECT_EQ(measurement.notes[0].value, 4.0);
  EXPECT_THAT(measurement.notes[0].text, HasSubstr("a packet of GPS time 1000001020000000000 ns"));
  ASSERT_EQ(source_->statistics().size(), 1U);
  EXPECT_EQ(source_->statistics()[0].value, 4.0);
}

TEST_F(ExternalSourceTest, AValueThatTheSensorCannotHaveIsRejected) {
  testbeds::PacketPlan plan;
  plan.fault_of_value = [](const fsw::packets::PacketView& packet) {
    return packet.header.time == kStart ? std::string("a range that is refused") : std::string();
  };
  make(plan);
  times_ = {kStart, kStart + kPeriod};
  const twins::Measurement measurement = measure(1);
  EXPECT_EQ(measurement.packets.size(), 1U);
  ASSERT_EQ(measurement.notes.size(), 1U);
  EXPECT_EQ(measurement.notes[0].text, "a range that is refused");
}

TEST_F(ExternalSourceTest, PacketsBeyondThoseOfAnEpochAreRejected) {
  testbeds::PacketPlan plan;
  plan.packets_max = 3;
  make(plan);
  times_.assign(2000, kStart + kPeriod);
  const twins::Measurement measurement = measure(1);
  EXPECT_EQ(measurement.packets.size(), 3U);
  ASSERT_EQ(measurement.notes.size(), 1U);
  EXPECT_EQ(measurement.notes[0].value, 1997.0);
  EXPECT_THAT(measurement.notes[0].text, HasSubstr("more than 3 packets"));
}

TEST_F(ExternalSourceTest, OfValidPacketsNothingIsNoted) {
  make();
  times_ = {kStart + kPeriod};
  EXPECT_TRUE(measure(1).notes.empty());
  EXPECT_TRUE(source_->statistics().empty());
}

}  // namespace
}  // namespace vbar::external
