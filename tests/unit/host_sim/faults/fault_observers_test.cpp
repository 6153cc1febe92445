// Which sources aided and when, by the flight computer's packets.

#include "host_sim/faults/fault_observers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/packet_encoder.h"
#include "tests/support/gnss_scene.h"

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

// What happens to a receiver shows in its bytes, and nothing shows that did not happen.

namespace {

using twins::Upset;

constexpr double kPeriod_s = 10.0;
constexpr int kUpsetEpoch = 24;  // all channels have tracked for long enough to be continued

/// The epochs of a receiver in orbit, `upset` before epoch kUpsetEpoch; epochs in `lost` do not arrive.
std::vector<ReceiverEpoch> flown(const std::optional<Upset>& upset, const std::set<int>& lost = {}, int epochs = 40) {
  twins::gnss::GnssReceiverSettings settings;
  settings.tracking.cycle_slips_per_hour = 0.0;
  twins::gnss::GnssReceiver receiver(settings, test::constellation(3), test::data_directory(), 3, "servicer");
  twins::PacketEncoder encoder(1, 0);
  ReceiverObserver witness;
  std::vector<ReceiverEpoch> found;
  for (int n = 0; n < epochs; ++n) {
    if (upset && n == kUpsetEpoch) {
      EXPECT_TRUE(receiver.upset(*upset));
    }
    const twins::gnss::BodyTruth truth = test::in_orbit(kPeriod_s * n);
    const std::vector<std::uint8_t> bytes = receiver.bytes_at(truth);
    if (lost.contains(n)) continue;
    for (std::size_t begin = 0; begin < bytes.size(); begin += sizeof(gnss_bytes::data)) {
      gnss_bytes message{};
      message.count = static_cast<std::int32_t>(std::min(sizeof message.data, bytes.size() - begin));
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), message.count, message.data);
      const auto packet = encoder.encode(truth.time, message);
      for (ReceiverEpoch& epoch : witness.take(fsw::packets::parse_packet(*packet).value())) found.push_back(epoch);
    }
  }
  return found;
}

/// Time since the start, s. The receiver's first epoch has no observations.
double time_s(const ReceiverEpoch& epoch) {
  return fsw::seconds(epoch.time - test::kGnssStart);
}
bool is_upset(const ReceiverEpoch& epoch) {
  return std::abs(time_s(epoch) - kPeriod_s * kUpsetEpoch) < 1e-3;
}

TEST(ReceiverObserver, SeesNothingWhereNothingHappens) {
  for (const ReceiverEpoch& epoch : flown(std::nullopt, {17, 29})) {
    EXPECT_TRUE(epoch.slips.empty());
    EXPECT_EQ(epoch.restarted, 0U);
    if (epoch.clock_jump_s) {
      EXPECT_LT(std::abs(*epoch.clock_jump_s), 1e-7);
    }
  }
}

TEST(ReceiverObserver, SeesASlipOfOneCycleInTheEpochInWhichItHappens) {
  for (const std::set<int>& lost : {std::set<int>{}, {13}}) {
    const std::vector<ReceiverEpoch> epochs = flown(Upset{Upset::Kind::kCycleSlip, 1.0, "highest"}, lost);
    int seen = 0;
    for (const ReceiverEpoch& epoch : epochs) {
      if (epoch.slips.empty()) continue;
      ++seen;
      EXPECT_TRUE(is_upset(epoch)) << time_s(epoch);
      EXPECT_EQ(epoch.slips.size(), 2U) << "L1 and L2";
      for (const auto& slip : epoch.slips) {
        EXPECT_EQ(slip.satellite, epoch.slips[0].satellite);
        EXPECT_NEAR(slip.cycles, 1.0, 0.3);
      }
      EXPECT_EQ(epoch.restarted, 0U) << "the receiver does not say so";
    }
    EXPECT_EQ(seen, 1);
  }
}

/// Each slip is seen with respect to that of another carrier, whose wavelength may differ: it need not be a whole
/// number.
TEST(ReceiverObserver, SeesSlipsOfAllByDifferentCycles) {
  const std::vector<ReceiverEpoch> epochs = flown(Upset{Upset::Kind::kCycleSlip, 4.0, "all"});
  const auto found = std::ranges::find_if(epochs, is_upset);
  ASSERT_NE(found, epochs.end());
  const ReceiverEpoch& then = *found;
  EXPECT_GT(2 * then.slips.size(), then.carriers);
  std::set<double> sizes;
  for (const auto& slip : then.slips) {
    sizes.insert(std::round(slip.cycles));
  }
  EXPECT_GT(sizes.size(), 4U);
}

TEST(ReceiverObserver, SeesAClockThatJumps) {
  const std::vector<ReceiverEpoch> epochs = flown(Upset{Upset::Kind::kClockJump, 5e-6, {}});
  for (std::size_t n = 1; n < epochs.size(); ++n) {
    ASSERT_TRUE(epochs[n].clock_jump_s.has_value()) << n;
    EXPECT_NEAR(*epochs[n].clock_jump_s, is_upset(epochs[n]) ? 5e-6 : 0.0, 1e-7) << n;
    EXPECT_EQ(epochs[n].restarted, 0U);
  }
}

TEST(ReceiverObserver, SeesAReceiverThatBeginsAgain) {
  const std::vector<ReceiverEpoch> epochs = flown(Upset{Upset::Kind::kReset, 0.0, {}});
  bool is_seen = false;
  for (const ReceiverEpoch& epoch : epochs) {
    const double t_s = time_s(epoch);
    if (t_s < kPeriod_s * kUpsetEpoch - 1.0) {
      EXPECT_EQ(epoch.restarted, 0U);
    }
    if (epoch.known > 0 && epoch.restarted == epoch.known) {
      is_seen = true;
      EXPECT_LE(t_s, kPeriod_s * (kUpsetEpoch + 1) + 1.0);
      EXPECT_GT(epoch.carriers, 10U);
    }
  }
  EXPECT_TRUE(is_seen);
}

// Ambiguities and clock are those of another start; what came before is not touched.
TEST(ReceiverReset, DrawsItsClockAnewAndChangesNothingBefore) {
  twins::gnss::GnssReceiver reset({}, test::constellation(3), test::data_directory(), 3, "servicer");
  twins::gnss::GnssReceiver other({}, test::constellation(3), test::data_directory(), 3, "servicer");
  for (int n = 0; n < kUpsetEpoch; ++n)
    EXPECT_EQ(reset.bytes_at(test::in_orbit(kPeriod_s * n)), other.bytes_at(test::in_orbit(kPeriod_s * n)));
  EXPECT_TRUE(reset.upset({Upset::Kind::kReset, 0.0, {}}));
  static_cast<void>(reset.bytes_at(test::in_orbit(kPeriod_s * kUpsetEpoch)));
  static_cast<void>(other.bytes_at(test::in_orbit(kPeriod_s * kUpsetEpoch)));
  EXPECT_GT(std::abs(reset.truth().clock_offset_s - other.truth().clock_offset_s), 1e-6);
}

}  // namespace

}  // namespace vbar::faults
