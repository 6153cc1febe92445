// Statistics of the imperfections against their definition: normal constants and a first-order Gauss-Markov process.

#include "hil_drivers/grand/bench/generator/box_errors.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/figures.h"

namespace vbar::grand::bench {
namespace {

using twins::gnss::Signal;
using twins::gnss::System;

TEST(ChannelErrors, AlignmentsHaveTheirSigmaAndAreConstantsOfTheChannel) {
  double carrier = 0.0, code = 0.0;
  constexpr int kChannels = 400;
  for (int k = 0; k < kChannels; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    const ChannelErrors errors({}, seed, "servicer", {System::kGps, 7}, Signal::kGpsL1);
    const ChannelErrors again({}, seed, "servicer", {System::kGps, 7}, Signal::kGpsL1);
    const ChannelErrors other({}, seed, "target", {System::kGps, 7}, Signal::kGpsL1);
    EXPECT_EQ(errors.carrier_alignment_m(), again.carrier_alignment_m());
    EXPECT_NE(errors.carrier_alignment_m(), other.carrier_alignment_m());
    carrier += std::pow(errors.carrier_alignment_m(), 2);
    code += std::pow(errors.code_alignment_m(), 2);
  }
  // Standard error of a sigma from 400 draws: 3.5 %; three of them.
  EXPECT_NEAR(std::sqrt(carrier / kChannels), 0.27e-3, 0.11 * 0.27e-3);
  EXPECT_NEAR(std::sqrt(code / kChannels), 20e-3, 0.11 * 20e-3);
}

TEST(ChannelErrors, WanderHasItsSigmaAndCorrelationTime) {
  double variance = 0.0, covariance_60s = 0.0;
  accuracy::Largest largest_step;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    ChannelErrors errors({}, seed, "servicer", {System::kGps, 7}, Signal::kGpsL1);
    std::vector<double> phase_mm;
    for (int k = 0; k < 36000; ++k) {
      const auto wander = errors.wander(k);
      if (k > 0) {
        EXPECT_EQ(wander.begin_m * 1e3, phase_mm.back());
      } else {
        phase_mm.push_back(wander.begin_m * 1e3);
      }
      largest_step.add(std::abs(wander.end_m - wander.begin_m) * 1e3);
      phase_mm.push_back(wander.end_m * 1e3);
    }
    for (std::size_t k = 0; k + 600 < phase_mm.size(); k += 10, ++count) {
      variance += phase_mm[k] * phase_mm[k];
      covariance_60s += phase_mm[k] * phase_mm[k + 600];
    }
  }
  // 40 h in time constants of 60 s: 2400 / 2 independent values; standard error of the variance 4 %.
  EXPECT_NEAR(variance / count, 0.25, 0.03);
  EXPECT_NEAR(covariance_60s / count, 0.25 * std::exp(-1.0), 0.03);
  // Innovation of one block: 0.5 mm sqrt(2 * 0.1 / 60) = 0.029 mm; 1.4 million of them stay below 6 sigma.
  EXPECT_LT(largest_step, 6.0 * 0.0289);
}

// A satellite that was away: correlation decays over the blocks left out.
TEST(ChannelErrors, WanderRunsOnOverOmittedBlocks) {
  double product = 0.0;
  constexpr int kSeeds = 4000;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    ChannelErrors errors({}, seed, "target", {System::kGalileo, 3}, Signal::kGalileoE1);
    const double before = errors.wander(0).end_m;
    product += before * errors.wander(301).begin_m;
  }
  // 30 s later: exp(-1/2); standard error 1.6 % of the variance.
  EXPECT_NEAR(product / kSeeds, 0.25e-6 * std::exp(-0.5), 0.05 * 0.25e-6);
}

TEST(ChannelErrors, ZeroSigmaIsAnIdealBox) {
  ChannelErrors errors({0.0, 0.0, 0.0, 60.0}, 1, "target", {System::kGalileo, 3}, Signal::kGalileoE1);
  EXPECT_EQ(errors.wander(5).end_m, 0.0);
  EXPECT_EQ(errors.carrier_alignment_m(), 0.0);
  EXPECT_EQ(errors.code_alignment_m(), 0.0);
}

}  // namespace
}  // namespace vbar::grand::bench
