// One receiver during a run: bursts with the attitude of their epochs, losses, the record of its bytes.

#include "hil_drivers/grand/receiver_link.h"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/driver/receiver_logs.h"
#include "tests/unit/hil_drivers/grand/receiver_port/fake_receiver.h"

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
}  // namespace vbar::grand
