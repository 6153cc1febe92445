// Which sources aided and when, by the flight computer's packets.

#include "host_sim/faults/aid_watch.h"

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_encoder.h"

namespace vbar::faults {
namespace {

constexpr std::int32_t kPair = navigation_configuration::kUseCarrierPair;
constexpr std::int32_t kKeypoints = navigation_configuration::kUseKeypoints;

constexpr fsw::GpsTime at(std::int64_t s) {
  return fsw::GpsTime{} + fsw::duration_of_seconds(1000 + s);
}

class AidWatchTest : public testing::Test {
 protected:
  template <class Message>
  void send(std::int64_t s, const Message& message) {
    const auto bytes = encoder_.encode(at(s), message);
    watch_.take(at(s), fsw::packets::parse_packet(*bytes).value());
  }
  void aid(std::int64_t s, std::int32_t source, std::int8_t state) {
    telemetry_event event{};
    event.event = telemetry_event::kEventAid;
    event.device = source;
    event.after = state;
    send(s, event);
  }
  void step(std::int64_t s, std::int64_t number) {
    telemetry_health health{};
    health.step = number;
    send(s, health);
  }

  twins::PacketEncoder encoder_{1, 0};
  AidWatch watch_;
};

TEST_F(AidWatchTest, ASourceAidsFromItsEventToTheNextOne) {
  aid(10, kPair, telemetry_event::kAidAiding);
  aid(20, kKeypoints, telemetry_event::kAidAiding);
  aid(30, kPair, telemetry_event::kAidSuspended);
  aid(50, kPair, telemetry_event::kAidStarting);
  aid(60, kPair, telemetry_event::kAidAiding);
  EXPECT_EQ(watch_.before(at(10)), 0);
  EXPECT_EQ(watch_.before(at(11)), kPair);
  EXPECT_EQ(watch_.before(at(30)), kPair + kKeypoints);
  EXPECT_EQ(watch_.before(at(31)), kKeypoints);
  EXPECT_EQ(watch_.first_with(kPair, at(25)), at(25));
  EXPECT_EQ(watch_.first_with(kPair, at(30)), at(60));
  EXPECT_EQ(watch_.first_with(kPair + kKeypoints, at(0)), at(20));
  EXPECT_EQ(watch_.first_with(0, at(7)), at(7)) << "nothing is waited for";
  aid(70, kPair, telemetry_event::kAidFailed);
  EXPECT_EQ(watch_.first_with(kPair, at(70)), std::nullopt);
}

TEST_F(AidWatchTest, AComputerThatBeginsAgainAidsWithNothing) {
  step(0, 0);
  aid(10, kPair, telemetry_event::kAidAiding);
  step(10, 1);
  EXPECT_EQ(watch_.before(at(11)), kPair);
  step(20, 0);
  EXPECT_EQ(watch_.before(at(21)), 0);
}

TEST_F(AidWatchTest, EventsOfTheFirstStepHoldInAnyOrder) {
  for (const std::int64_t s : {0, 100}) {
    step(s, 0);
    aid(s + 10, kPair + kKeypoints, telemetry_event::kAidAiding);
    step(s + 10, 1);
  }
  aid(200, kPair, telemetry_event::kAidAiding);
  step(200, 0);
  EXPECT_EQ(watch_.before(at(201)), kPair) << "before the health packet";
  step(300, 0);
  aid(300, kKeypoints, telemetry_event::kAidAiding);
  EXPECT_EQ(watch_.before(at(301)), kKeypoints) << "after it";
}

}  // namespace
}  // namespace vbar::faults
