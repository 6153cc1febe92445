#include "hil_drivers/grand/pps/edge_filter.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::grand {
namespace {

using Span = engine::WallClock::Span;
using namespace std::chrono_literals;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kFirstGps_ns = 1'000'000'000 * kSecond_ns;
constexpr Span kFirstHost = 5000s;

Edge edge_at(double host_s, std::int64_t label_s) {
  return {fsw::GpsTime{kFirstGps_ns + label_s * kSecond_ns}, kFirstHost + Span(std::llround(host_s * 1e9)),
          static_cast<std::uint32_t>(label_s)};
}

Edge unlabelled(Edge edge) {
  edge.gps.reset();
  return edge;
}

double s_of(Span span) {
  return std::chrono::duration<double>(span).count();
}

// Steady state of the Kalman-Bucy filter of a double integrator, driven by white noise of density q and observed in
// white noise of density R T (Bar-Shalom et al. 2001, section 9; Kalman and Bucy 1961): p00 = sqrt(2) q^(1/4) (R
// T)^(3/4), p01 = sqrt(q R T), p11 = sqrt(2) q^(3/4) (R T)^(1/4). It holds for gains far below 1: here 0.014.
struct SteadyState {
  double offset_s, cross, rate;
};

SteadyState steady_state(double rate_walk, double edge_sigma_s) {
  const double q = rate_walk * rate_walk;
  const double density = edge_sigma_s * edge_sigma_s * 1.0;
  const double p00 = std::sqrt(2.0) * std::pow(q, 0.25) * std::pow(density, 0.75);
  const double p11 = std::sqrt(2.0) * std::pow(q, 0.75) * std::pow(density, 0.25);
  return {std::sqrt(p00), std::sqrt(q * density), std::sqrt(p11)};
}

/// A host whose rate error begins at `rate` and walks; edges with jitter.
class Host {
 public:
  Host(unsigned seed, double rate, double rate_walk, double jitter_s)
      : random_(seed), rate_(rate), rate_walk_(rate_walk), jitter_s_(jitter_s) {}

  /// The next edge. The edges' time runs at 1 + rate against the host's.
  Edge next() {
    const Edge edge = edge_at(true_host_s_ + jitter_s_ * normal_(random_), label_);
    ++label_;
    true_host_s_ += 1.0 / (1.0 + rate_);
    rate_ += rate_walk_ * normal_(random_);
    return edge;
  }
  /// Of the last edge, without its jitter.
  [[nodiscard]] Span edge_host() const { return kFirstHost + Span(std::llround((true_host_s_ - last_step_s()) * 1e9)); }
  [[nodiscard]] double rate() const { return rate_; }
  [[nodiscard]] std::int64_t label() const { return label_ - 1; }
  void skip() { next(); }

 private:
  [[nodiscard]] double last_step_s() const { return 1.0 / (1.0 + rate_); }
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double rate_, rate_walk_, jitter_s_;
  double true_host_s_ = 0.0;
  std::int64_t label_ = 0;
};

/// Error of the filter's time at the true instant of the host's last edge, s. The first edge, jitter included, is its
/// origin.
double error_s(const EdgeFilter& filter, const Host& host) {
  const std::int64_t label_ns = host.label() * kSecond_ns;
  return s_of(filter.at(host.edge_host()) - Span(label_ns));
}

TEST(EdgeFilter, CovarianceReachesTheAnalyticSteadyState) {
  EdgeFilter filter({});
  for (int k = 0; k < 5000; ++k) filter.add(edge_at(k, k));
  const SteadyState expected = steady_state(1e-8, 100e-6);
  // The discrete filter differs by the order of its gain.
  EXPECT_NEAR(filter.offset_sigma_s() / expected.offset_s, 1.0, 0.02);
  EXPECT_NEAR(filter.rate_sigma() / expected.rate, 1.0, 0.02);
  EXPECT_NEAR(expected.offset_s, 11.9e-6, 0.1e-6);
}

TEST(EdgeFilter, ErrorsHaveTheAnalyticSigma) {
  const SteadyState expected = steady_state(1e-8, 100e-6);
  double offset_squares = 0.0, rate_squares = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Host host(seed, 50e-6, 1e-8, 100e-6);
    EdgeFilter filter({});
    for (int k = 0; k < 3000; ++k) {
      filter.add(host.next());
      if (k < 1000 || k % 100 != 0) continue;
      offset_squares += std::pow(error_s(filter, host), 2);
      rate_squares += std::pow(filter.rate_error() - host.rate(), 2);
      ++count;
    }
  }
  // 800 samples 100 s apart, which the filter's time constant of (R T / q)^(1/4) = 100 s leaves about 500 independent
  // ones of: 3 % of the RMS; the gate at three sigma takes away the largest edges.
  EXPECT_NEAR(std::sqrt(offset_squares / count) / expected.offset_s, 1.0, 0.12);
  EXPECT_NEAR(std::sqrt(rate_squares / count) / expected.rate, 1.0, 0.12);
}

TEST(EdgeFilter, FindsARateErrorOf50Ppm) {
  Host host(7, 50e-6, 0.0, 100e-6);
  EdgeFilter filter({});
  int rejected = 0;
  for (int k = 0; k < 1000; ++k) rejected += filter.add(host.next()) == EdgeVerdict::kRejected ? 1 : 0;
  const SteadyState expected = steady_state(1e-8, 100e-6);
  EXPECT_NEAR(filter.rate_error(), 50e-6, 3.0 * expected.rate);
  EXPECT_LT(std::abs(error_s(filter, host)), 3.0 * expected.offset_s);
  // 0.27 % of Gaussian edges are beyond three sigma: 2.7 of 1000, with a sigma of 1.6.
  EXPECT_LE(rejected, 8);
}

TEST(EdgeFilter, HoldOverGoesOnAtTheLastRate) {
  Host host(3, 50e-6, 0.0, 100e-6);
  EdgeFilter filter({});
  for (int k = 0; k < 1000; ++k) filter.add(host.next());
  for (int k = 0; k < 30; ++k) host.skip();
  // Prediction over 30 s: p00 + 60 p01 + 900 p11 + q 30^3/3.
  const SteadyState steady = steady_state(1e-8, 100e-6);
  const double sigma_s = std::sqrt(steady.offset_s * steady.offset_s + 60.0 * steady.cross +
                                   900.0 * steady.rate * steady.rate + 1e-16 * 9000.0);
  EXPECT_LT(std::abs(error_s(filter, host)), 3.0 * sigma_s);
  EXPECT_LT(sigma_s, 20e-6);
  ASSERT_EQ(filter.add(host.next()), EdgeVerdict::kAccepted);
  EXPECT_EQ(filter.seconds_since_previous(), 31);
}

TEST(EdgeFilter, AnOutlierOf2MillisecondsLeavesNoTrace) {
  EdgeFilter with_outlier({}), with_gap({});
  for (int k = 0; k < 300; ++k) {
    with_outlier.add(edge_at(k, k));
    with_gap.add(edge_at(k, k));
  }
  EXPECT_EQ(with_outlier.add(edge_at(300.002, 300)), EdgeVerdict::kRejected);
  EXPECT_NEAR(with_outlier.host_minus_edge_s(), 0.002, 1e-6);
  for (int k = 301; k < 400; ++k) {
    EXPECT_EQ(with_outlier.add(edge_at(k, k)), EdgeVerdict::kAccepted);
    with_gap.add(edge_at(k, k));
  }
  EXPECT_NEAR(s_of(with_outlier.at(kFirstHost + 500s)), s_of(with_gap.at(kFirstHost + 500s)), 2e-9);
}

TEST(EdgeFilter, AnOutlierAsFirstEdgeIsRecoveredFrom) {
  EdgeFilter filter({});
  filter.add(edge_at(0.002, 0));
  for (int k = 1; k < 200; ++k) filter.add(edge_at(k, k));
  // The labels say where the first edge should have been.
  EXPECT_NEAR(s_of(filter.at(kFirstHost + 200s)), 200.0, 100e-6);
}

TEST(EdgeFilter, FollowsEdgesThatHaveJumpedByASecond) {
  for (const int jump_s : {1, -1}) {
    EdgeFilter filter({});
    for (int k = 0; k < 300; ++k) filter.add(edge_at(k, k));
    EXPECT_EQ(filter.add(edge_at(300, 300 + jump_s)), EdgeVerdict::kRejected);
    EXPECT_EQ(filter.add(edge_at(301, 301 + jump_s)), EdgeVerdict::kRejected);
    EXPECT_NEAR(s_of(filter.at(kFirstHost + 301s)), 301.0, 1e-6);
    EXPECT_EQ(filter.add(edge_at(302, 302 + jump_s)), EdgeVerdict::kReinitialised);
    EXPECT_NEAR(s_of(filter.at(kFirstHost + 302s)), 302.0 + jump_s, 1e-6);
    for (int k = 303; k < 320; ++k) EXPECT_EQ(filter.add(edge_at(k, k + jump_s)), EdgeVerdict::kAccepted);
  }
}

TEST(EdgeFilter, FollowsAPhaseJumpOfEdgesWithoutLabels) {
  for (const double jump_s : {0.3, 0.7}) {
    EdgeFilter filter({});
    for (int k = 0; k < 300; ++k) filter.add(unlabelled(edge_at(k, k)));
    EXPECT_EQ(filter.add(unlabelled(edge_at(300 + jump_s, 0))), EdgeVerdict::kRejected);
    EXPECT_EQ(filter.add(unlabelled(edge_at(301 + jump_s, 0))), EdgeVerdict::kRejected);
    EXPECT_EQ(filter.add(unlabelled(edge_at(302 + jump_s, 0))), EdgeVerdict::kReinitialised);
    // The nearest whole second is the most that such an edge says.
    EXPECT_NEAR(s_of(filter.at(kFirstHost + 302s) + Span(std::llround(jump_s * 1e9))), 302.0 + (jump_s > 0.5 ? 1 : 0),
                1e-6);
  }
}

TEST(EdgeFilter, TwoRejectedEdgesThatDisagreeAreNotFollowed) {
  EdgeFilter filter({});
  for (int k = 0; k < 300; ++k) filter.add(edge_at(k, k));
  for (int k = 300; k < 330; ++k)
    EXPECT_EQ(filter.add(edge_at(k + (k % 2 == 0 ? 0.002 : -0.003), k)), EdgeVerdict::kRejected);
  EXPECT_NEAR(s_of(filter.at(kFirstHost + 330s)), 330.0, 1e-6);
}

TEST(EdgeFilter, DoubledEdgesAreIgnored) {
  EdgeFilter filter({});
  for (int k = 0; k < 100; ++k) {
    filter.add(edge_at(k, k));
    EXPECT_EQ(filter.add(edge_at(k, k)), EdgeVerdict::kDoubled);
    EXPECT_EQ(filter.add(unlabelled(edge_at(k + 0.005, k))), EdgeVerdict::kDoubled);
    EXPECT_EQ(filter.add(edge_at(k - 3.0, k - 3)), EdgeVerdict::kDoubled);
  }
  EXPECT_EQ(s_of(filter.at(kFirstHost + 100s)), 100.0);
}

TEST(EdgeFilter, ScaledTimeDividesTheLabels) {
  EdgeFilterSettings settings;
  settings.speed_factor = 20.0;
  EdgeFilter filter(settings);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(filter.add(edge_at(k / 20.0, k)), EdgeVerdict::kAccepted);
  EXPECT_NEAR(s_of(filter.at(kFirstHost + 50s)), 50.0, 1e-6);
}

TEST(EdgeFilter, HostTimeIsTheInverse) {
  Host host(5, 80e-6, 0.0, 100e-6);
  EdgeFilter filter({});
  for (int k = 0; k < 100; ++k) filter.add(host.next());
  for (const Span host_time : {kFirstHost + 99s, kFirstHost + 100s + 123456789ns, kFirstHost + 160s})
    EXPECT_NEAR(s_of(filter.host_at(filter.at(host_time)) - host_time), 0.0, 2e-9);
}

}  // namespace
}  // namespace vbar::grand
