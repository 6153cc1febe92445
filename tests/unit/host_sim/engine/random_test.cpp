#include <cmath>
#include <set>
#include <vector>

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::engine {

namespace {

struct KnownAnswer {
  std::array<std::uint64_t, 4> counter;
  std::array<std::uint64_t, 2> key;
  std::array<std::uint64_t, 4> out;
};

// Known-answer vectors of Random123 (file kat_vectors, lines "philox4x64 10"): zeros, ones, digits of pi.
TEST(RandomStream, GeneratorGivesRandom123sKnownAnswers) {
  constexpr std::uint64_t kOnes = ~std::uint64_t{0};
  const KnownAnswer answers[] = {
      {{0, 0, 0, 0}, {0, 0}, {0x16554d9eca36314cU, 0xdb20fe9d672d0fdcU, 0xd7e772cee186176bU, 0x7e68b68aec7ba23bU}},
      {{kOnes, kOnes, kOnes, kOnes},
       {kOnes, kOnes},
       {0x87b092c3013fe90bU, 0x438c3c67be8d0224U, 0x9cc7d7c69cd777b6U, 0xa09caebf594f0ba0U}},
      {{0x243f6a8885a308d3U, 0x13198a2e03707344U, 0xa4093822299f31d0U, 0x082efa98ec4e6c89U},
       {0x452821e638d01377U, 0xbe5466cf34e90c6cU},
       {0xa528f45403e61d95U, 0x38c72dbd566e9788U, 0xa5a1610e72fd18b5U, 0x57bd43b5e52b7fe6U}}};
  for (const KnownAnswer& answer : answers) {
    const r123::Philox4x64::ctr_type counter{
        {answer.counter[0], answer.counter[1], answer.counter[2], answer.counter[3]}};
    const r123::Philox4x64::key_type key{{answer.key[0], answer.key[1]}};
    const auto out = r123::Philox4x64{}(counter, key);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(out[k], answer.out[k]);
  }
}

// Test vectors of the FNV authors' reference (isthe.com/chongo/tech/comp/fnv).
TEST(RandomStream, NamesAreHashedWithFnv1a) {
  EXPECT_EQ(fnv1a_64(""), 0xcbf29ce484222325U);
  EXPECT_EQ(fnv1a_64("a"), 0xaf63dc4c8601ec8cU);
  EXPECT_EQ(fnv1a_64("foobar"), 0x85944171f73967e8U);
}

// The first numbers of a stream are the Philox block of counter 0 under the key (seed, hash of the name): the
// documented construction, computed here through the library alone.
TEST(RandomStream, IsPhiloxUnderSeedAndName) {
  RandomStream stream(42, "servicer/thruster");
  for (std::uint64_t block = 0; block < 3; ++block) {
    const auto out = r123::Philox4x64{}({{block, 0, 0, 0}}, {{42, fnv1a_64("servicer/thruster")}});
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(stream.bits(), out[k]);
  }
}

TEST(RandomStream, OtherStreamsDoNotChangeIt) {
  RandomStream alone(1, "gnss");
  std::vector<std::uint64_t> expected;
  for (int k = 0; k < 100; ++k) expected.push_back(alone.bits());

  RandomStream gnss(1, "gnss");
  RandomStream camera(1, "camera");
  for (int k = 0; k < 100; ++k) {
    for (int draws = 0; draws < k % 5; ++draws) camera.normal();
    EXPECT_EQ(gnss.bits(), expected[static_cast<std::size_t>(k)]);
  }
}

TEST(RandomStream, SeedsAndNamesAreDifferentStreams) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (const char* name : {"camera", "gnss", "thruster", "Camera"}) {
      RandomStream stream(seed, name);
      for (int k = 0; k < 8; ++k) seen.insert(stream.bits());
    }
  // 1600 draws of 64 bits: the chance of any coincidence is 1600^2 / 2^65, 7e-14.
  EXPECT_EQ(seen.size(), 50U * 4U * 8U);
}

TEST(RandomStream, ContinuesFromItsPosition) {
  RandomStream stream(3, "camera");
  for (int k = 0; k < 13; ++k) stream.uniform();
  const std::uint64_t position = stream.position();
  EXPECT_EQ(position, 13U);
  const double next = stream.normal();

  RandomStream resumed(3, "camera");
  resumed.seek(position);
  EXPECT_EQ(resumed.normal(), next);
}

TEST(RandomStream, NumberedDrawsDependOnTheNumberOnly) {
  RandomStream stream(3, "link");
  const auto before = stream.uniforms_of(7);
  for (int k = 0; k < 100; ++k) stream.bits();
  EXPECT_EQ(stream.uniforms_of(7), before);
  EXPECT_NE(stream.uniforms_of(8), before);
  // No bits shared with the sequence: its first block would otherwise be the draws of number 0.
  RandomStream fresh(3, "link");
  EXPECT_NE(fresh.uniform(), stream.uniforms_of(0)[0]);
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
  double fourth = 0.0;  // central
};

template <class Draw>
Moments moments(Draw draw, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(draw());
  Moments m;
  for (const double x : values) m.mean += x / count;
  for (const double x : values) {
    const double d2 = (x - m.mean) * (x - m.mean);
    m.variance += d2 / count;
    m.fourth += d2 * d2 / count;
  }
  return m;
}

// Sample moments of n draws scatter about the true ones with sigma_mean = sqrt(var/n) and, for the variance,
// sqrt((mu4 - var^2)/n). The bounds are 4.5 of these (chance 7e-6 each; the draws are fixed, so the test cannot
// flicker).
constexpr int kDraws = 200000;
constexpr double kSigmas = 4.5;

TEST(RandomStream, UniformHasItsMoments) {
  RandomStream stream(11, "uniform");
  const Moments m = moments([&] { return stream.uniform(-1.0, 3.0); }, kDraws);
  const double variance = 16.0 / 12.0;
  const double mu4 = 256.0 / 80.0;
  EXPECT_NEAR(m.mean, 1.0, kSigmas * std::sqrt(variance / kDraws));
  EXPECT_NEAR(m.variance, variance, kSigmas * std::sqrt((mu4 - variance * variance) / kDraws));
}

TEST(RandomStream, NormalHasItsMoments) {
  RandomStream stream(11, "normal");
  const Moments m = moments([&] { return stream.normal(); }, kDraws);
  EXPECT_NEAR(m.mean, 0.0, kSigmas * std::sqrt(1.0 / kDraws));
  EXPECT_NEAR(m.variance, 1.0, kSigmas * std::sqrt(2.0 / kDraws));
  // The eighth moment is 105, so the sample's fourth scatters with sqrt((105 - 9)/n).
  EXPECT_NEAR(m.fourth, 3.0, kSigmas * std::sqrt(96.0 / kDraws));
}

TEST(RandomStream, ExponentialHasItsMoments) {
  RandomStream stream(11, "exponential");
  const Moments m = moments([&] { return stream.exponential(); }, kDraws);
  EXPECT_NEAR(m.mean, 1.0, kSigmas * std::sqrt(1.0 / kDraws));
  EXPECT_NEAR(m.variance, 1.0, kSigmas * std::sqrt((9.0 - 1.0) / kDraws));
}

// Two streams of one seed are uncorrelated: the sample correlation of n pairs scatters with 1/sqrt(n).
TEST(RandomStream, StreamsAreUncorrelated) {
  RandomStream a(5, "camera");
  RandomStream b(5, "gnss");
  double sum = 0.0;
  for (int k = 0; k < kDraws; ++k) sum += a.normal() * b.normal();
  EXPECT_NEAR(sum / kDraws, 0.0, kSigmas / std::sqrt(static_cast<double>(kDraws)));
}

// Chi-square of 100 equal cells: mean 99, sigma sqrt(2*99) = 14; 4.5 sigma above is 162.
TEST(RandomStream, UniformFillsItsIntervalEvenly) {
  RandomStream stream(19, "cells");
  std::array<int, 100> cells{};
  for (int k = 0; k < kDraws; ++k) ++cells[static_cast<std::size_t>(stream.uniform() * 100.0)];
  double chi_square = 0.0;
  for (const int count : cells) chi_square += (count - kDraws / 100.0) * (count - kDraws / 100.0) / (kDraws / 100.0);
  EXPECT_LT(chi_square, 162.0);
}

}  // namespace

namespace {

TEST(Distributions, UnitIntervalIsOpenAndSymmetric) {
  EXPECT_EQ(open_unit_interval(0), 0x1p-53);
  EXPECT_EQ(open_unit_interval(~std::uint64_t{0}), 1.0 - 0x1p-53);
  const std::uint64_t bits = 0x123456789abcdef0U;
  EXPECT_EQ(open_unit_interval(bits) + open_unit_interval(~bits), 1.0);
}

// Values printed with the algorithm (Wichura 1988, p. 483): quantiles at 0.25, 0.001 and 1e-20, ten digits there; the
// bound is half a unit of the last printed digit.
TEST(Distributions, NormalQuantileGivesThePublishedCheckValues) {
  EXPECT_NEAR(normal_quantile(0.25), -0.6744897501960817, 5e-17 + 2e-16);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232306167814, 2e-15);
  EXPECT_NEAR(normal_quantile(1e-20), -9.262340089798408, 5e-15);
  EXPECT_EQ(normal_quantile(0.5), 0.0);
}

// The C library's erfc is an independent road back from x to p. p carries a relative rounding error of about eps (1 +
// x^2) through erfc's own argument; 20 of these leave room for erfc's last bits.
TEST(Distributions, NormalQuantileInvertsTheDistributionFunction) {
  for (double x = -8.0; x <= 0.0; x += 0.01) {
    const double p = 0.5 * std::erfc(-x / std::sqrt(2.0));
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * 3.14159265358979323846);
    EXPECT_NEAR(normal_quantile(p), x, 20.0 * 2.2e-16 * (1.0 + x * x) * p / density + 1e-15) << x;
  }
}

TEST(Distributions, NormalQuantileIsAntisymmetricAndRefusesWhatIsNoProbability) {
  for (const double p : {0.001, 0.07, 0.075, 0.2, 0.4})  // both sides of the switch at 0.075
    EXPECT_NEAR(normal_quantile(p) + normal_quantile(1.0 - p), 0.0,
                1e-13);  // 1 - p rounds: eps p/density(0.001) < 1e-13
  for (const double p : {0.0, 1.0, -0.1, 1.1, std::nan("")}) EXPECT_TRUE(std::isnan(normal_quantile(p)));
}

// A standard normal cut off at [a, b] has the distribution function (Phi(x) - Phi(a)) / (Phi(b) - Phi(a)).
TEST(Distributions, TruncatedNormalFollowsItsDistributionFunction) {
  const double intervals[][2] = {{-1.0, 2.0}, {-8.0, -1.0}, {0.5, 3.0}, {5.0, 6.0}, {-40.0, 40.0}};
  for (const auto& [low, high] : intervals) {
    for (const double p : {0.001, 0.1, 0.5, 0.9, 0.999}) {
      const double x = truncated_normal_quantile(p, low, high);
      EXPECT_GE(x, low);
      EXPECT_LE(x, high);
      // Upper tails from above: 1 - Phi is Phi(-x), without cancellation.
      const double above = normal_distribution(-x) - normal_distribution(-high);
      const double all = normal_distribution(-low) - normal_distribution(-high);
      EXPECT_NEAR(above / all, 1.0 - p, 1e-11) << low << ' ' << high << ' ' << p;  // eps * 1/density in the far tail
    }
  }
}

TEST(Distributions, TruncatedNormalStaysInsideWhereNoProbabilityIsLeft) {
  EXPECT_EQ(truncated_normal_quantile(0.5, 60.0, 61.0), 60.0);
  EXPECT_EQ(truncated_normal_quantile(0.5, -61.0, -60.0), -60.0);
  // p so close to 1 that the sum rounds to 1: a large finite number, not an infinity.
  const double x = truncated_normal_quantile(1.0 - 0x1p-53, 0.0, 100.0);
  EXPECT_GT(x, 8.0);
  EXPECT_LT(x, 9.0);
}

TEST(Distributions, ExponentialIsItsInverse) {
  EXPECT_DOUBLE_EQ(exponential_upper_quantile(std::exp(-2.0)), 2.0);
  EXPECT_NEAR(exponential_upper_quantile(open_unit_interval(0)), 53.0 * std::log(2.0), 1e-13);
}

}  // namespace

namespace {

using fsw::duration_of_seconds;
using fsw::GpsTime;

// Autocorrelation of 0.7^2 exp(-dt / 60) at 0, 10, 60 and 600 s, over independent processes; the sample covariance of a
// Gaussian pair scatters with sqrt((1 + r^2) / n) of the variance.
TEST(GaussMarkov, HasItsAutocorrelation) {
  constexpr int kProcesses = 20000;
  constexpr double kSigma = 0.7, kTime_s = 60.0;
  constexpr int kLags_s[] = {0, 10, 60, 600};
  double sums[4] = {};
  for (int k = 0; k < kProcesses; ++k) {
    GaussMarkov process(kSigma, kTime_s, RandomStream(static_cast<std::uint64_t>(k), "process"));
    const double first = process.at(GpsTime{});
    for (std::size_t n = 0; n < 4; ++n) sums[n] += first * process.at(GpsTime{} + duration_of_seconds(kLags_s[n]));
  }
  for (std::size_t n = 0; n < 4; ++n) {
    const double correlation = std::exp(-kLags_s[n] / kTime_s);
    EXPECT_NEAR(sums[n] / kProcesses / (kSigma * kSigma), correlation,
                kSigmas * std::sqrt((1.0 + correlation * correlation) / kProcesses))
        << kLags_s[n] << " s";
  }
}

// The mean square increment over a short time is 2 sigma^2 (1 - exp(-dt / T)): 2 sigma^2 dt / T to 0.01 %.
TEST(GaussMarkov, ShortStepsKeepTheirIncrement) {
  constexpr int kSteps = 100000;
  GaussMarkov process(1.0, 1e5, RandomStream(3, "steps"));
  double before = process.at(GpsTime{});
  double sum = 0.0;
  for (int k = 1; k <= kSteps; ++k) {
    const double now = process.at(GpsTime{} + duration_of_seconds(10 * k));
    sum += (now - before) * (now - before);
    before = now;
  }
  EXPECT_NEAR(sum / kSteps / 2e-4, 1.0, kSigmas * std::sqrt(2.0 / kSteps) + 1e-4);
}

TEST(GaussMarkov, RepeatsAValueAndIsZeroWithoutSigma) {
  GaussMarkov process(2.0, 10.0, RandomStream(1, "repeated"));
  const double first = process.at(GpsTime{1000});
  EXPECT_EQ(first, 2.0 * RandomStream(1, "repeated").normal());  // stationary from the start
  EXPECT_EQ(process.at(GpsTime{1000}), first);
  EXPECT_EQ(process.at(GpsTime{500}), first);
  EXPECT_NE(process.at(GpsTime{1000} + duration_of_seconds(1)), first);
  GaussMarkov none(0.0, 10.0, RandomStream(1, "none"));
  EXPECT_EQ(none.at(GpsTime{1000}), 0.0);
}

}  // namespace

}  // namespace vbar::engine
