// One receiver during a run: bursts with the attitude of their epochs, losses, the record of its bytes.

#include "hil_drivers/grand/receiver_link.h"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/bursts.h"
#include "tests/unit/hil_drivers/grand/fake_receiver.h"
#include "tests/unit/hil_drivers/grand/receiver_logs.h"

namespace vbar::grand {

namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;
using ::testing::HasSubstr;
using twins::gnss::BodyTruth;
using twins::gnss::ReceiverOutput;

constexpr fsw::GpsTime kStart{fsw::duration_of_seconds(1658 * 604800LL + 345'670).ns};
constexpr Patience kPatient{milliseconds(500), milliseconds(5000), milliseconds(60000), 20};

fsw::GpsTime at(double s) {
  return kStart + fsw::nearest_duration(s);
}

BodyTruth truth_at(double s) {
  BodyTruth truth;
  truth.time = at(s);
  truth.q_body_eci = Eigen::AngleAxisd(1e-3 * s, fsw::Vector3::UnitY());
  truth.rate_body_eci = {0.0, -1e-3, 0.0};
  return truth;
}

class ReceiverLinkTest : public ::testing::Test {
 protected:
  LinkPlan plan() {
    LinkPlan link;
    link.spacecraft = "servicer";
    link.device = receiver_.device();
    link.configuration.approximate_time = kStart;
    link.configuration.approximate_position_ecef_m = {7e6, 0.0, 0.0};
    link.period = fsw::duration_of_seconds(10);
    link.give_up = fsw::duration_of_seconds(120);
    link.start_patience = kPatient;
    link.reopen_patience = {.probe = milliseconds(1000), .answer = milliseconds(2000), .attempts = 1};
    return link;
  }

  /// Calls every 0.1 s from `from_s` to `to_s`; the outputs that deliver.
  std::vector<ReceiverOutput> run(ReceiverLink& link, double from_s, double to_s) {
    std::vector<ReceiverOutput> delivered;
    for (int k = static_cast<int>(from_s * 10 + 0.5); k <= static_cast<int>(to_s * 10 + 0.5); ++k) {
      ReceiverOutput output = link.take(truth_at(0.1 * k), at(0.1 * k));
      // The receiver of this test answers in the host's time, on a loaded machine late.
      if (link.is_lost()) std::this_thread::sleep_for(pause_);
      if (!output.failure.empty()) failures_.push_back(output.failure);
      if (output.is_epoch) delivered.push_back(output);
    }
    return delivered;
  }

  FakeReceiver receiver_{{.baud = 115200, .answers = {}, .logs = {}}};
  std::vector<std::string> failures_;
  milliseconds pause_{1};
};

TEST_F(ReceiverLinkTest, DeliversABurstWithTheAttitudeOfItsEpoch) {
  ReceiverLink link(plan());
  link.open();
  run(link, 0.0, 9.0);
  const Bytes sent = burst_of(at(9.0));
  receiver_.send({sent.begin(), sent.begin() + 100});
  EXPECT_TRUE(run(link, 9.1, 9.2).empty());
  receiver_.send({sent.begin() + 100, sent.end()});
  const auto delivered = run(link, 9.3, 9.3);
  ASSERT_EQ(delivered.size(), 1U);
  // What the receiver answered during its configuration stands before the burst.
  EXPECT_TRUE(std::equal(sent.rbegin(), sent.rend(), delivered[0].bytes.rbegin()));
  ASSERT_TRUE(delivered[0].measured.has_value());
  EXPECT_EQ(delivered[0].measured->time, at(9.0));
  EXPECT_LT(delivered[0].measured->q_body_eci.angularDistance(truth_at(9.0).q_body_eci), 1e-15);
  EXPECT_NEAR(delivered[0].measured->rate_body.y(), -1e-3, 1e-15);
  EXPECT_NEAR(link.second().latency_s.value(), 0.3, 1e-9);
  EXPECT_TRUE(failures_.empty());
}

TEST_F(ReceiverLinkTest, PassesOnGarbageThatCompletesNoEpoch) {
  ReceiverLink link(plan());
  link.open();
  run(link, 0.0, 1.0);
  receiver_.send({1, 2, 3});
  const auto delivered = run(link, 1.1, 14.0);
  ASSERT_FALSE(delivered.empty());
  EXPECT_EQ(delivered.back().bytes.back(), 3);
  EXPECT_FALSE(delivered.back().measured.has_value());
}

TEST_F(ReceiverLinkTest, ComesBackAfterAHangUp) {
  ReceiverLink link(plan());
  link.open();
  run(link, 0.0, 1.0);
  receiver_.hang_up();
  run(link, 1.1, 31.0);
  EXPECT_EQ(failures_.size(), 3U);  // one a period
  EXPECT_THAT(failures_.back(), HasSubstr("receiver of servicer on " + receiver_.device()));
  EXPECT_TRUE(link.second().is_lost);
  receiver_.come_back();
  pause_ = milliseconds(30);
  run(link, 31.1, 38.0);
  EXPECT_FALSE(link.second().is_lost);
  const LinkStatistics statistics = link.statistics();
  EXPECT_EQ(statistics.losses, 1U);
  EXPECT_EQ(statistics.reconnects, 1U);
  EXPECT_NEAR(statistics.lost_s, 32.0, 3.0);  // and the time of a configuration in steps of 0.1 s
  receiver_.send(burst_of(at(39.0)));
  EXPECT_EQ(run(link, 39.0, 39.2).size(), 1U);
}

TEST_F(ReceiverLinkTest, EndsTheRunAfterALongLoss) {
  ReceiverLink link(plan());
  link.open();
  run(link, 0.0, 1.0);
  receiver_.hang_up();
  try {
    run(link, 1.1, 130.0);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("receiver of servicer"), HasSubstr("120 s"), HasSubstr("give_up_s")));
  }
}

TEST_F(ReceiverLinkTest, TakesThreeSilentEpochsForALoss) {
  ReceiverLink link(plan());
  link.open();
  run(link, 0.0, 30.0);
  EXPECT_EQ(link.statistics().losses, 0U);
  pause_ = milliseconds(30);
  run(link, 30.1, 38.0);  // the receiver still answers: found again
  EXPECT_EQ(link.statistics().losses, 1U);
  EXPECT_EQ(link.statistics().reconnects, 1U);
}

TEST_F(ReceiverLinkTest, ShiftsWeeksWhereThatIsAllowed) {
  const auto rolled = [](double s) { return at(s) + fsw::duration_of_seconds(1024LL * 604800); };
  {
    ReceiverLink link(plan());
    link.open();
    run(link, 0.0, 9.0);
    receiver_.send(burst_of(rolled(9.0)));
    EXPECT_THROW(run(link, 9.1, 9.3), std::runtime_error);
  }
  LinkPlan shifting = plan();
  shifting.week_shift = true;
  ReceiverLink link(shifting);
  link.open();
  run(link, 0.0, 9.0);
  receiver_.send(burst_of(rolled(9.0)));
  const auto delivered = run(link, 9.1, 9.1);
  ASSERT_EQ(delivered.size(), 1U);
  const Bytes expected = burst_of(at(9.0));
  EXPECT_TRUE(std::equal(expected.rbegin(), expected.rend(), delivered[0].bytes.rbegin()));
  EXPECT_EQ(delivered[0].measured->time, at(9.0));
  EXPECT_EQ(link.statistics().week_shift, -1024);
}

TEST_F(ReceiverLinkTest, KeepsEveryByteInTheRunFolder) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "link_record";
  std::filesystem::create_directories(folder);
  Bytes sent = burst_of(at(9.0));
  {
    ReceiverLink link(plan());
    link.open();
    link.keep_in(folder);
    run(link, 0.0, 9.0);
    receiver_.send(sent);
    run(link, 9.1, 9.2);
  }
  std::ifstream file(folder / "receiver_servicer.gps", std::ios::binary);
  const Bytes kept{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(std::string(kept.begin(), kept.end()), HasSubstr("<OK"));  // also what came before the folder
  ASSERT_GT(kept.size(), sent.size());
  EXPECT_TRUE(std::equal(sent.rbegin(), sent.rend(), kept.rbegin()));
}

TEST_F(ReceiverLinkTest, InRealTimeARunGoesOnWhileTheReceiverIsSearched) {
  LinkPlan plan_of_run = plan();
  plan_of_run.pace = Pace::kRealTime;
  ReceiverLink link(plan_of_run);
  link.open();
  run(link, 0.0, 1.0);
  receiver_.hang_up();
  run(link, 1.1, 2.0);
  receiver_.come_back();
  double s = 2.1;
  for (; s < 100.0 && link.statistics().reconnects == 0; s += 0.1) {
    run(link, s, s);
    std::this_thread::sleep_for(milliseconds(2));
  }
  EXPECT_EQ(link.statistics().reconnects, 1U);
}

}  // namespace

// Bursts of a receiver, cut at its TIME logs (log 101 of the OEM6 manual).

namespace {

constexpr fsw::GpsTime kEpoch{fsw::duration_of_seconds(1658 * 604800LL + 345'679).ns};

TEST(Bursts, EndWithTheirTimeLogHoweverTheyArrive) {
  const Bytes sent = burst_of(kEpoch, oem::TimeStatus::kFine, 7);
  BurstCutter cutter;
  for (std::size_t k = 0; k + 1 < sent.size(); ++k) EXPECT_TRUE(cutter.push({&sent[k], 1}).empty());
  const auto bursts = cutter.push({&sent.back(), 1});
  ASSERT_EQ(bursts.size(), 1U);
  EXPECT_EQ(bursts[0].bytes, sent);
  EXPECT_EQ(bursts[0].tag.time, kEpoch);
  EXPECT_TRUE(bursts[0].tag.is_fine());
  EXPECT_EQ(bursts[0].tracked_signals, 7);
  EXPECT_EQ(cutter.rest_size(), 0U);
}

TEST(Bursts, KeepWhatCameBetweenThem) {
  Bytes sent{'\r', '\n', '<', 'O', 'K', 0xAA, 0x44, 0x12, 0xFF};
  const Bytes first = burst_of(kEpoch), second = burst_of(kEpoch + fsw::duration_of_seconds(10));
  sent.insert(sent.end(), first.begin(), first.end());
  sent.insert(sent.end(), second.begin(), second.end());
  sent.push_back(0x42);
  BurstCutter cutter;
  const auto bursts = cutter.push(sent);
  ASSERT_EQ(bursts.size(), 2U);
  EXPECT_EQ(bursts[0].bytes.size(), first.size() + 9);
  EXPECT_EQ(bursts[1].bytes, second);
  EXPECT_EQ(cutter.take_rest(), Bytes{0x42});
}

TEST(Bursts, AreNotFineBeforeTheReceiverHasTheTime) {
  for (const auto status : {oem::TimeStatus::kUnknown, oem::TimeStatus::kApproximate, oem::TimeStatus::kCoarse}) {
    BurstCutter cutter;
    const auto bursts = cutter.push(burst_of(kEpoch, status));
    ASSERT_EQ(bursts.size(), 1U);
    EXPECT_FALSE(bursts[0].tag.is_fine());
  }
}

TEST(Bursts, WithACorruptedTimeLogAreNotCut) {
  Bytes sent = burst_of(kEpoch);
  sent[sent.size() - 10] ^= 0x01;
  BurstCutter cutter;
  EXPECT_TRUE(cutter.push(sent).empty());
  EXPECT_EQ(cutter.counters().bad_checksum, 1U);
  EXPECT_EQ(cutter.rest_size(), sent.size());
}

TEST(Bursts, ShiftedByWeeksAreWhatTheReceiverWouldHaveSent) {
  const auto later = kEpoch + fsw::Duration{1024 * 604'800'000'000'000};
  Bytes sent = burst_of(later);
  sent.insert(sent.begin(), {0x00, 0xAA, 0x44});
  shift_weeks(sent, -1024);
  EXPECT_EQ(Bytes(sent.begin() + 3, sent.end()), burst_of(kEpoch));
}

}  // namespace

// A receiver's time against the run's: rollover of the week number (IS-GPS-200, 20.3.3.3.1.1: ten bits), scenarios
// started at another time.

namespace {

using ::testing::AllOf;

constexpr std::int64_t kWeek_s = 604'800;
constexpr fsw::GpsTime kTagEpoch{fsw::duration_of_seconds(1658 * kWeek_s + 345'679).ns};
constexpr fsw::Duration kLatency{300'000'000};
constexpr fsw::Duration kMaxLatency{950'000'000};

std::string refusal(fsw::GpsTime tag, bool accepts_week_shift = false, fsw::Duration latency = kLatency,
                    fsw::Duration max_latency = kMaxLatency) {
  TagCheck check("receiver of servicer on /dev/ttyUSB0", accepts_week_shift, max_latency);
  try {
    check.check(tag, kTagEpoch + latency);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TagCheck, AcceptsTheTimeOfTheRun) {
  EXPECT_EQ(refusal(kTagEpoch), "");
  EXPECT_EQ(refusal(kTagEpoch, false, fsw::Duration{0}), "");
  EXPECT_EQ(refusal(kTagEpoch, false, fsw::Duration{900'000'000}), "");
}

TEST(TagCheck, ASlowReceiverMayHaveALargerLatency) {
  constexpr fsw::Duration kSlow{1'950'000'000};
  EXPECT_THAT(refusal(kTagEpoch, false, fsw::Duration{1'000'000'000}), HasSubstr("sensors.gnss.max_latency_s"));
  EXPECT_EQ(refusal(kTagEpoch, false, fsw::Duration{1'000'000'000}, kSlow), "");
  EXPECT_EQ(refusal(kTagEpoch, false, kSlow, kSlow), "");
  EXPECT_THAT(refusal(kTagEpoch, false, fsw::Duration{1'951'000'000}, kSlow), HasSubstr("-0.05 to 1.95 s"));
  EXPECT_THAT(refusal(kTagEpoch + fsw::duration_of_seconds(1), false, kLatency, kSlow), HasSubstr("start time"));
}

TEST(TagCheck, RefusesARolloverUnlessItMayBeShifted) {
  for (const int cycles : {-1, 1, 2}) {
    const fsw::GpsTime tag = kTagEpoch + fsw::duration_of_seconds(cycles * 1024 * kWeek_s);
    EXPECT_THAT(refusal(tag), AllOf(HasSubstr("receiver of servicer on /dev/ttyUSB0"), HasSubstr("week_shift"),
                                    HasSubstr(std::to_string(-1024 * cycles) + " weeks")));
    TagCheck check("receiver", true, kMaxLatency);
    check.check(tag, kTagEpoch + kLatency);
    EXPECT_EQ(check.weeks(), -1024 * cycles);
  }
}

TEST(TagCheck, RefusesAScenarioOffByASecond) {
  for (const std::int64_t s : {-1, 1, 15, -604800}) {
    EXPECT_THAT(refusal(kTagEpoch + fsw::duration_of_seconds(s)), HasSubstr("start time of the scenario")) << s;
    EXPECT_THAT(refusal(kTagEpoch + fsw::duration_of_seconds(s + 1024 * kWeek_s), true), HasSubstr("start time")) << s;
  }
}

TEST(TagCheck, LaterAcceptsASlowLineButNoOtherWeek) {
  TagCheck check("receiver", true, kMaxLatency);
  check.check(kTagEpoch, kTagEpoch + kLatency);
  check.check(kTagEpoch, kTagEpoch + fsw::duration_of_seconds(3));
  EXPECT_EQ(check.weeks(), 0);
  EXPECT_THROW(check.check(kTagEpoch + fsw::duration_of_seconds(1024 * kWeek_s), kTagEpoch + kLatency),
               std::runtime_error);
}

}  // namespace

}  // namespace vbar::grand
