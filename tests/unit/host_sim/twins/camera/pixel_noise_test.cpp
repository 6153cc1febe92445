// The numbers behind the pixels: against Random123's own Philox, the exact normal quantile, and the Poisson
// distribution by its recursion in double precision.

#include "host_sim/twins/camera/pixel_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include "host_sim/engine/random_stream.h"
#include "tests/support/figures.h"

namespace vbar::twins::camera {
namespace {

TEST(PixelNoise, WordsAreThoseOfRandom123) {
  const NoiseKey key{0x0123456789ABCDEFULL, 0xFEDCBA9876543210ULL};
  ChunkWords words;
  for (const std::uint32_t chunk : {0U, 7U, 1562U}) {
    for (const NoiseKind kind : {NoiseKind::kShot, NoiseKind::kRead}) {
      draw_words(key, kind, chunk, words);
      for (std::uint32_t k = 0; k < kBlocksOfChunk; ++k) {
        const r123::Philox4x32::ctr_type counter{
            {chunk * 64 + k, 0x76543210U, 0xFEDCBA98U, static_cast<std::uint32_t>(kind)}};
        const auto expected = r123::Philox4x32()(counter, {{0x89ABCDEFU, 0x01234567U}});
        for (std::size_t w = 0; w < 4; ++w) ASSERT_EQ(words[w * 64 + k], expected[w]) << chunk << " " << k << " " << w;
      }
    }
  }
}

/// Words that stand for the whole range, evenly or towards an end.
double worst_normal_error(std::uint32_t first, std::uint32_t stride) {
  accuracy::Largest worst;
  ChunkWords words;
  ChunkFloats normal;
  std::uint32_t word = first;
  for (int chunk = 0; chunk < 400; ++chunk) {
    for (std::uint32_t& one : words) one = (word += stride);
    normal_numbers(words, normal);
    for (std::size_t k = 0; k < kChunk; ++k) {
      // The lower half counts the upper tail, the upper half the lower one.
      const double tail = (static_cast<double>(words[k] & 0x7FFFFFFFU) + 0.5) * 0x1p-32;
      const double exact = -engine::normal_quantile(tail) * (words[k] >> 31U ? -1.0 : 1.0);
      worst.add(std::abs(static_cast<double>(normal[k]) - exact));
    }
  }
  return worst;
}

TEST(PixelNoise, NormalNumbersAreTheQuantile) {
  EXPECT_LT(worst_normal_error(0, 41943), 1e-4) << "over everything";
  EXPECT_LT(worst_normal_error(0, 3), 2e-3) << "the last 3e5 words before 6.3 sigma, whose quantile is steepest";
  EXPECT_LT(worst_normal_error(0x7FFF0000U, 1), 1e-4) << "the middle";
}

TEST(PixelNoise, NormalNumbersReachSixSigmaBothWaysAndNeverJump) {
  ChunkWords words{};
  words[1] = 0x80000000U;
  words[2] = 0x7FFFFFFFU;
  words[3] = 0xFFFFFFFFU;
  ChunkFloats normal;
  normal_numbers(words, normal);
  EXPECT_NEAR(normal[0], 6.338, 1e-3) << "minus the quantile of 2^-33, by Python's statistics.NormalDist";
  EXPECT_EQ(normal[1], -normal[0]);
  EXPECT_NEAR(normal[2], 0.0F, 1e-6);
  EXPECT_NEAR(normal[3], 0.0F, 1e-6);
  float last = std::numeric_limits<float>::infinity();
  std::uint32_t word = 0;
  for (int chunk = 0; chunk < 100; ++chunk) {
    for (std::uint32_t& one : words) one = (word += 83886);
    normal_numbers(words, normal);
    for (std::size_t k = 0; k < kChunk; ++k) {
      if (words[k] >> 31U) continue;
      ASSERT_LT(normal[k], last) << words[k];
      last = normal[k];
    }
  }
}

/// What fraction of an even net of all words gives each number, up to `most`.
std::vector<double> share_of_numbers(float mean, std::size_t most) {
  constexpr std::uint32_t kStride = 1U << 12U;  // 2^20 words
  std::vector<double> share(most + 1, 0.0);
  ChunkWords words;
  ChunkFloats means, numbers;
  means.fill(mean);
  std::uint32_t word = kStride / 2;
  for (std::uint32_t chunk = 0; chunk < (1U << 20U) / kChunk; ++chunk) {
    for (std::uint32_t& one : words) {
      one = word;
      word += kStride;
    }
    poisson_numbers(words, means, numbers);
    for (const float number : numbers)
      if (number <= static_cast<float>(most)) share[static_cast<std::size_t>(number)] += 0x1p-20;
  }
  return share;
}

std::vector<double> poisson_distribution(double mean, std::size_t most) {
  std::vector<double> probability(most + 1);
  for (std::size_t k = 0; k <= most; ++k)
    probability[k] = std::exp(static_cast<double>(k) * std::log(mean) - mean - std::lgamma(static_cast<double>(k) + 1));
  return probability;
}

class PoissonNumbers : public testing::TestWithParam<float> {};

// An even net of a million words inverts the distribution function itself, so the shares are probabilities to one word
// in a million at either end of a step: there is no chance in this test.
TEST_P(PoissonNumbers, HaveTheirProbabilities) {
  const float mean = GetParam();
  const auto most = static_cast<std::size_t>(mean + 8.0F * std::sqrt(mean) + 10.0F);
  const std::vector<double> share = share_of_numbers(mean, most);
  const std::vector<double> exact = poisson_distribution(static_cast<double>(mean), most);
  // The expansion is good to 1e-4 in the distribution function where it takes over (pixel_noise.h), so to 2e-4 in a
  // difference of two of its values.
  const double tolerance = mean < kGaussianMean ? 3e-6 : 2e-4;
  for (std::size_t k = 0; k <= most; ++k) ASSERT_NEAR(share[k], exact[k], tolerance) << k;
}

TEST_P(PoissonNumbers, HaveMeanAndVarianceOfTheirMean) {
  const auto mean = static_cast<double>(GetParam());
  const auto most = static_cast<std::size_t>(mean + 8.0 * std::sqrt(mean) + 10.0);
  const std::vector<double> share = share_of_numbers(GetParam(), most);
  double first = 0.0, second = 0.0;
  for (std::size_t k = 0; k <= most; ++k) {
    first += share[k] * static_cast<double>(k);
    second += share[k] * (static_cast<double>(k) - mean) * (static_cast<double>(k) - mean);
  }
  // The net leaves out a millionth of either tail.
  EXPECT_NEAR(first, mean, 1e-4 * mean + 1e-5);
  EXPECT_NEAR(second, mean, 1e-3 * mean + 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Means, PoissonNumbers,
                         testing::Values(0.003F, 0.1F, 0.7F, 1.0F, 3.3F, 8.0F, 11.99F, 12.0F, 20.0F, 55.0F, 300.0F));

TEST(PixelNoise, PoissonNumbersOfRandomWordsFitByChiSquare) {
  ChunkWords words;
  ChunkFloats means, numbers;
  means.fill(2.5F);
  std::vector<double> count(9, 0.0);  // the last for all beyond
  constexpr int kChunks = 2000;
  for (std::uint32_t chunk = 0; chunk < kChunks; ++chunk) {
    draw_words({42, 1}, NoiseKind::kShot, chunk, words);
    poisson_numbers(words, means, numbers);
    for (const float number : numbers) count[std::min<std::size_t>(static_cast<std::size_t>(number), 8)] += 1.0;
  }
  std::vector<double> expected = poisson_distribution(2.5, 7);
  double rest = 1.0;
  for (const double p : expected) rest -= p;
  expected.push_back(rest);
  double chi_square = 0.0;
  for (std::size_t k = 0; k < count.size(); ++k) {
    const double e = expected[k] * kChunks * static_cast<double>(kChunk);
    chi_square += (count[k] - e) * (count[k] - e) / e;
  }
  EXPECT_LT(chi_square, 26.1) << "one in a thousand for eight degrees of freedom";
  EXPECT_GT(chi_square, 0.86) << "and as few are below this";
}

TEST(PixelNoise, MeansOfAllSizesMayStandBesideEachOther) {
  ChunkWords words;
  draw_words({1, 2}, NoiseKind::kShot, 3, words);
  const float sizes[] = {0.0F, 0.5F, 5.0F, 11.0F, 40.0F, 1e4F, 3e7F};
  ChunkFloats mixed, numbers;
  for (std::size_t k = 0; k < kChunk; ++k) mixed[k] = sizes[k % 7];
  poisson_numbers(words, mixed, numbers);
  for (const float size : sizes) {
    ChunkFloats same, alone;
    same.fill(size);
    poisson_numbers(words, same, alone);
    for (std::size_t k = 0; k < kChunk; ++k) {
      if (mixed[k] != size) continue;
      EXPECT_EQ(numbers[k], alone[k]) << size;
    }
  }
}

TEST(PixelNoise, MeansThatAreNoneGiveNothing) {
  ChunkWords words;
  draw_words({1, 2}, NoiseKind::kShot, 3, words);
  words[0] = 0xFFFFFFFFU;
  for (const float none : {0.0F, -3.0F, std::numeric_limits<float>::quiet_NaN()}) {
    ChunkFloats means, numbers;
    means.fill(none);
    poisson_numbers(words, means, numbers);
    for (const float number : numbers) EXPECT_EQ(number, 0.0F) << none;
  }
  ChunkFloats means, numbers;
  means.fill(std::numeric_limits<float>::infinity());
  poisson_numbers(words, means, numbers);
  for (const float number : numbers) EXPECT_NEAR(number, 1e12F, 1e7F);
}

}  // namespace
}  // namespace vbar::twins::camera
