#include "host_sim/engine/link_model.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::engine {
namespace {

using fsw::GpsTime;
using fsw::Status;

constexpr GpsTime kNow{1'000'000'000'000'000'000};

LinkModel link_with(const LatencyDistribution& latency, double loss, std::uint64_t seed = 1) {
  const LinkSettings settings{latency, loss};
  EXPECT_EQ(check_link_settings(settings), Status::kOk);
  return {settings, RandomStream(seed, "link/board")};
}

std::vector<double> latencies_s(LinkModel link, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(fsw::seconds(link.send(kNow).delivery - kNow));
  return values;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

constexpr int kPackets = 40000;

TEST(LinkModel, ConstantLatencyIsExactToTheNanosecond) {
  LinkModel link = link_with({LatencyKind::kConstant, 0.123456789, 0.0, 0.0, 0.0}, 0.0);
  for (int k = 0; k < 5; ++k) {
    const Transfer transfer = link.send(kNow);
    EXPECT_FALSE(transfer.lost);
    EXPECT_EQ((transfer.delivery - kNow).ns, 123456789);
  }
}

// Bounds on means: 4.5 standard deviations of the mean of kPackets draws.
TEST(LinkModel, UniformLatencyStaysInsideAndHasItsMean) {
  const auto values = latencies_s(link_with({LatencyKind::kUniform, 0.0, 0.0, 0.2, 0.6}, 0.0), kPackets);
  for (const double value : values) {
    EXPECT_GE(value, 0.2);
    EXPECT_LE(value, 0.6);
  }
  EXPECT_NEAR(mean(values), 0.4, 4.5 * 0.4 / std::sqrt(12.0 * kPackets));
}

TEST(LinkModel, NormalLatencyIsTruncatedNotFolded) {
  // Symmetric limits keep the mean; at 1 sigma they cut 32 %, which would pile up at the limits if values were clamped.
  const auto values = latencies_s(link_with({LatencyKind::kNormal, 0.5, 0.1, 0.4, 0.6}, 0.0), kPackets);
  int at_limits = 0;
  for (const double value : values) {
    EXPECT_GE(value, 0.4);
    EXPECT_LE(value, 0.6);
    if (value < 0.4 + 1e-6 || value > 0.6 - 1e-6) ++at_limits;
  }
  EXPECT_LT(at_limits, 10);  // expected: 4e4 * 2e-6 m / 0.2 s scale, below 1
  // Standard deviation of a normal cut at one sigma on both sides: 0.5397 sigma.
  EXPECT_NEAR(mean(values), 0.5, 4.5 * 0.05397 / std::sqrt(kPackets));
}

TEST(LinkModel, ExponentialLatencyStartsAtItsMinimum) {
  const auto values = latencies_s(link_with({LatencyKind::kExponential, 0.3, 0.0, 0.1, 0.0}, 0.0), kPackets);
  for (const double value : values) EXPECT_GE(value, 0.1);
  EXPECT_NEAR(mean(values), 0.3, 4.5 * 0.2 / std::sqrt(kPackets));
}

TEST(LinkModel, LosesTheStatedShare) {
  LinkModel link = link_with({}, 0.1);
  for (int k = 0; k < kPackets; ++k) static_cast<void>(link.send(kNow));
  EXPECT_EQ(link.counters().sent, static_cast<std::uint64_t>(kPackets));
  // Binomial: sigma sqrt(n p (1-p)) = 60.
  EXPECT_NEAR(static_cast<double>(link.counters().lost), 4000.0, 4.5 * 60.0);
}

TEST(LinkModel, LosesNothingAtZeroAndEverythingAtOne) {
  LinkModel perfect = link_with({}, 0.0);
  LinkModel dead = link_with({}, 1.0);
  for (int k = 0; k < 1000; ++k) {
    EXPECT_FALSE(perfect.send(kNow).lost);
    EXPECT_TRUE(dead.send(kNow).lost);
  }
}

TEST(LinkModel, LossAndLatencyAreIndependentDraws) {
  LinkModel quiet = link_with({LatencyKind::kUniform, 0.0, 0.0, 0.0, 1.0}, 0.0);
  LinkModel lossy = link_with({LatencyKind::kUniform, 0.0, 0.0, 0.0, 1.0}, 0.5);
  LinkModel constant = link_with({LatencyKind::kConstant, 0.2, 0.0, 0.0, 0.0}, 0.5);
  for (int k = 0; k < 200; ++k) {
    const Transfer with_loss = lossy.send(kNow);
    EXPECT_EQ(quiet.send(kNow).delivery, with_loss.delivery) << "losing packets must not change latencies";
    EXPECT_EQ(constant.send(kNow).lost, with_loss.lost) << "another latency must not change which are lost";
  }
}

TEST(LinkModel, IsAFunctionOfTheSeed) {
  const LatencyDistribution latency{LatencyKind::kExponential, 0.3, 0.0, 0.1, 0.0};
  EXPECT_EQ(latencies_s(link_with(latency, 0.0, 9), 50), latencies_s(link_with(latency, 0.0, 9), 50));
  EXPECT_NE(latencies_s(link_with(latency, 0.0, 9), 50), latencies_s(link_with(latency, 0.0, 10), 50));
}

TEST(LinkModel, RefusesSettingsThatAreNoDistribution) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto check = [](const LatencyDistribution& latency, double loss = 0.0) {
    return check_link_settings({latency, loss});
  };
  EXPECT_EQ(check({}, -0.1), Status::kOutOfRange);
  EXPECT_EQ(check({}, 1.1), Status::kOutOfRange);
  EXPECT_EQ(check({}, nan), Status::kNotFinite);
  EXPECT_EQ(check({LatencyKind::kConstant, -1.0, 0.0, 0.0, 0.0}), Status::kOutOfRange);
  EXPECT_EQ(check({LatencyKind::kConstant, nan, 0.0, 0.0, 0.0}), Status::kNotFinite);
  EXPECT_EQ(check({LatencyKind::kUniform, 0.0, 0.0, 0.5, 0.5}), Status::kOutOfRange);
  EXPECT_EQ(check({LatencyKind::kNormal, 0.5, 0.0, 0.1, 0.9}), Status::kOutOfRange);
  EXPECT_EQ(check({LatencyKind::kExponential, 0.1, 0.0, 0.2, 0.0}), Status::kOutOfRange);
  EXPECT_EQ(check({LatencyKind::kExponential, 1e8, 0.0, 0.0, 0.0}), Status::kOutOfRange);
}

}  // namespace
}  // namespace vbar::engine
