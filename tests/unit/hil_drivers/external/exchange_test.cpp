// A batch and an answer reach the other end unchanged; what is not of them is refused with one sentence.

#include "hil_drivers/external/exchange.h"

#include <future>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "hil_drivers/external/external_source.h"
#include "hil_drivers/external/source_server.h"
#include "host_sim/io/byte_channel.h"
#include "pil_bridge/link_faults.h"
#include "pil_bridge/step_barrier.h"
#include "pil_bridge/transport.h"

namespace vbar::external {

namespace {

using fsw::packets::Apid;
using testing::HasSubstr;

constexpr fsw::GpsTime kTime{1234567890123456789};

SpacecraftNumbers two_spacecraft() {
  SpacecraftNumbers numbers;
  numbers.add("servicer", 1);
  numbers.add("target", 2);
  return numbers;
}

twins::SpacecraftTruth truth_of(const std::string& name, double first) {
  twins::SpacecraftTruth truth;
  truth.name = name;
  truth.orbit.position_eci = {first, first + 1.0 / 3.0, -0.0};
  truth.orbit.velocity_eci = {7500.1, -0.3, 1e-300};
  truth.acceleration_eci = fsw::Vector3(-8.1, 0.2, 0.3);
  truth.attitude.emplace();
  truth.attitude->q_body_eci = Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5 + 1e-16);
  truth.attitude->rate_body = {1e-3, 2e-3, -3e-3};
  truth.angular_acceleration_body = fsw::Vector3(1e-6, 0.0, 2e-6);
  return truth;
}

twins::Packet range_packet(double range_m, std::uint8_t unit = 0) {
  fsw::packets::PacketHeader header;
  header.time = kTime;
  header.spacecraft = 1;
  header.unit = unit;
  vbar::range_measurement message{};
  message.range_m = range_m;
  twins::Packet packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::encode(header, message, packet).value());
  return packet;
}

template <class Call>
std::string error_of(const Call& call) {
  try {
    static_cast<void>(call());
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ExternalExchange, TruthArrivesBitForBit) {
  Batch batch;
  batch.time = kTime;
  batch.truth.emplace();
  batch.truth->time = kTime;
  batch.truth->R_itrf_gcrf << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0 / 3.0;
  batch.truth->spacecraft = {truth_of("servicer", 1e7 / 3.0), truth_of("target", -7e6)};
  batch.truth->spacecraft[1].attitude.reset();
  batch.commands.push_back({range_packet(1.0), kTime + fsw::Duration{5}});

  const Batch received = batch_of(packets_of(batch, 7, two_spacecraft()), two_spacecraft());
  ASSERT_TRUE(received.truth.has_value());
  EXPECT_EQ(received.time, kTime);
  EXPECT_EQ(received.truth->time, kTime);
  EXPECT_EQ(received.truth->R_itrf_gcrf, batch.truth->R_itrf_gcrf);
  ASSERT_EQ(received.truth->spacecraft.size(), 2u);
  const twins::SpacecraftTruth& sent = batch.truth->spacecraft[0];
  const twins::SpacecraftTruth* const servicer = received.truth->find("servicer");
  ASSERT_NE(servicer, nullptr);
  EXPECT_EQ(servicer->orbit.position_eci, sent.orbit.position_eci);
  EXPECT_TRUE(std::signbit(servicer->orbit.position_eci.z()));
  EXPECT_EQ(servicer->orbit.velocity_eci, sent.orbit.velocity_eci);
  EXPECT_EQ(*servicer->acceleration_eci, *sent.acceleration_eci);
  ASSERT_TRUE(servicer->attitude.has_value());
  EXPECT_EQ(servicer->attitude->q_body_eci.coeffs(), sent.attitude->q_body_eci.coeffs());
  EXPECT_EQ(servicer->attitude->rate_body, sent.attitude->rate_body);
  EXPECT_EQ(*servicer->angular_acceleration_body, *sent.angular_acceleration_body);
  EXPECT_FALSE(received.truth->find("target")->attitude.has_value());
  ASSERT_EQ(received.commands.size(), 1u);
  EXPECT_EQ(received.commands[0].packet, batch.commands[0].packet);
  EXPECT_EQ(received.commands[0].effective, batch.commands[0].effective);
}

TEST(ExternalExchange, OpeningNamesTheSensor) {
  Batch batch;
  batch.time = kTime;
  batch.opening = Opening{"servicer/lidar", 42, 1, 3};
  const Batch received = batch_of(packets_of(batch, 0, {}), {});
  ASSERT_TRUE(received.opening.has_value());
  EXPECT_EQ(received.opening->name, "servicer/lidar");
  EXPECT_EQ(received.opening->seed, 42);
  EXPECT_EQ(received.opening->spacecraft, 1);
  EXPECT_EQ(received.opening->unit, 3);
  EXPECT_FALSE(received.truth.has_value());
  batch.opening->name = std::string(64, 'x');
  EXPECT_THAT(error_of([&] { return packets_of(batch, 0, {}); }), HasSubstr("its name has 64 characters"));
}

TEST(ExternalExchange, TruthThatIsNotFiniteIsNotSent) {
  Batch batch;
  batch.truth.emplace();
  batch.truth->spacecraft = {truth_of("servicer", std::numeric_limits<double>::quiet_NaN())};
  EXPECT_THAT(error_of([&] { return packets_of(batch, 0, two_spacecraft()); }), HasSubstr("not finite"));
  batch.truth->spacecraft = {truth_of("third", 1.0)};
  EXPECT_THAT(error_of([&] { return packets_of(batch, 0, two_spacecraft()); }),
              HasSubstr("the spacecraft \"third\" has no number"));
}

TEST(ExternalExchange, AnswerArrivesWhole) {
  Answer answer;
  answer.packets = {range_packet(1.0), range_packet(2.0)};
  answer.available = kTime + fsw::Duration{100};
  answer.next_epoch = kTime + fsw::duration_of_seconds(1);
  const Answer received = answer_of(packets_of(answer, kTime));
  EXPECT_EQ(received.packets, answer.packets);
  EXPECT_FALSE(received.is_failed);
  EXPECT_EQ(received.available, answer.available);
  EXPECT_EQ(received.next_epoch, answer.next_epoch);
  answer.next_epoch.reset();
  answer.is_failed = true;
  const Answer last = answer_of(packets_of(answer, kTime));
  EXPECT_TRUE(last.is_failed);
  EXPECT_FALSE(last.next_epoch.has_value());
}

TEST(ExternalExchange, WhatIsNoAnswerIsRefused) {
  EXPECT_THAT(error_of([] { return answer_of({}); }), HasSubstr("does not end with a source_answer"));
  EXPECT_THAT(error_of([] { return answer_of({range_packet(1.0)}); }), HasSubstr("does not end with a source_answer"));
  const auto one = packets_of(Answer{}, kTime);
  EXPECT_THAT(error_of([&] { return answer_of({one[0], one[0]}); }), HasSubstr("a second source_answer"));
  EXPECT_THAT(error_of([&] { return batch_of(one, {}); }), HasSubstr("a packet of APID 0x607 in a batch"));
  EXPECT_THAT(error_of([] { return batch_of({}, {}); }), HasSubstr("without a tick"));
  EXPECT_THAT(error_of([] {
                return batch_of(std::vector<twins::Packet>{{1, 2, 3}}, {});
              }),
              HasSubstr("3 bytes that are no packet"));
}

TEST(ExternalExchange, PacketsOfTheSensorAreChecked) {
  const std::vector<Apid> allowed{Apid::kRangeMeasurement};
  const auto good = range_packet(1.0);
  EXPECT_EQ(fault_of(good, allowed, 1, 0), "");
  EXPECT_THAT(fault_of(good, allowed, 1, 1), HasSubstr("spacecraft 1 and unit 0 in place of 1 and 1"));
  EXPECT_THAT(fault_of(good, std::vector{Apid::kGnssBytes}, 1, 0), HasSubstr("which this sensor does not have"));
  auto damaged = good;
  damaged[20] ^= 1;
  EXPECT_THAT(fault_of(damaged, allowed, 1, 0), HasSubstr("another checksum"));
  // A payload of another size in a packet that is whole.
  const auto view = fsw::packets::parse_packet(good).value();
  twins::Packet longer(fsw::packets::kMaxPacketBytes);
  std::vector<std::uint8_t> payload(view.payload.begin(), view.payload.end());
  payload.push_back(0);
  longer.resize(fsw::packets::write_packet(view.header, payload, longer).value());
  EXPECT_THAT(fault_of(longer, allowed, 1, 0), HasSubstr("another size or type"));
}

}  // namespace

// The server answers every batch of a step barrier once, whatever the line loses, corrupts, repeats or delays.

namespace {

using Packets = std::vector<BatchServer::Packet>;

pil::BarrierTiming quick() {
  pil::BarrierTiming timing;
  timing.poll_after = std::chrono::milliseconds(20);
  timing.poll_limit = std::chrono::milliseconds(80);
  timing.hello_period = std::chrono::milliseconds(10);
  return timing;
}

std::unique_ptr<pil::FrameTransport> stream(io::FileDescriptor socket) {
  return std::make_unique<pil::StreamTransport>(io::adopt_socket(std::move(socket), "test"));
}

/// Every packet of a batch three times, so that answers exceed the window.
Packets tripled(std::span<const BatchServer::Packet> batch) {
  Packets answer;
  for (int k = 0; k < 3; ++k) answer.insert(answer.end(), batch.begin(), batch.end());
  return answer;
}

Packets numbered(std::size_t count, std::uint8_t first) {
  Packets packets;
  for (std::size_t k = 0; k < count; ++k)
    packets.push_back(BatchServer::Packet(1 + k % 7, static_cast<std::uint8_t>(first + k)));
  return packets;
}

void answers_each_batch_once(const pil::LinkFaults& faults) {
  auto [ours, theirs] = io::make_socket_pair();
  auto line = stream(std::move(theirs));
  int served = 0;
  BatchServer server(*line, "tripler", [&](std::span<const BatchServer::Packet> batch) {
    ++served;
    return tripled(batch);
  });
  auto running = std::async(std::launch::async, [&] { server.run(std::chrono::seconds(20)); });
  auto transport = pil::with_frame_faults(stream(std::move(ours)), faults);
  pil::StepBarrier barrier(*transport, 77, quick(), [] {});
  EXPECT_EQ(barrier.connect(1), "tripler");
  constexpr int kSteps = 20;
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    const Packets batch = numbered(1 + 9 * step, static_cast<std::uint8_t>(step));
    EXPECT_EQ(barrier.exchange(step, batch), tripled(batch)) << step;
  }
  // A goodbye is not repeated, and this line may lose it: the closed line ends the server then.
  barrier.goodbye();
  transport.reset();
  try {
    running.get();
  } catch (const pil::LinkError&) {
    EXPECT_TRUE(faults.any_frame_fault());
  }
  EXPECT_EQ(served, kSteps);
}

TEST(BatchServer, AnswersBatchesUntilTheGoodbye) {
  answers_each_batch_once({});
}

TEST(BatchServer, AnswersOnceOverABadLine) {
  pil::LinkFaults faults;
  faults.seed = 3;
  faults.drop_frame = 0.05;
  faults.duplicate_frame = 0.05;
  faults.delay_frame = 0.05;
  answers_each_batch_once(faults);
}

TEST(BatchServer, AClosedLineAndASilentRunEndIt) {
  auto [ours, theirs] = io::make_socket_pair();
  auto line = stream(std::move(theirs));
  BatchServer server(*line, "x", tripled);
  EXPECT_THROW(server.run(std::chrono::milliseconds(20)), pil::LinkError);
  ours.reset();
  EXPECT_THROW(server.run(std::chrono::seconds(20)), pil::LinkError);
}

}  // namespace

// Packets of a sensor in another process that cannot be those of a measurement are rejected and counted; the run goes
// on.

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
