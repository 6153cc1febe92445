#include "host_sim/engine/random_stream.h"

#include <cmath>
#include <set>
#include <vector>

#include <Random123/philox.h>
#include <gtest/gtest.h>

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
}  // namespace vbar::engine
