#include "host_sim/twins/camera/pixel_noise.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "host_sim/engine/random_stream.h"
#include "host_sim/engine/wide_loops.h"

namespace vbar::twins::camera {
namespace {

// ------------------------------------------------------------------------------------------------------ Philox4x32-10

constexpr std::uint32_t kMultiplier[2] = {0xD2511F53U, 0xCD9E8D57U};
constexpr std::uint32_t kWeyl[2] = {0x9E3779B9U, 0xBB67AE85U};
constexpr int kRounds = 10;

struct Blocks {
  std::array<std::uint32_t, kBlocksOfChunk> word[4];
};

VBAR_INLINE void philox_round(Blocks& blocks, std::uint32_t key0, std::uint32_t key1) {
  for (std::size_t k = 0; k < kBlocksOfChunk; ++k) {
    const std::uint64_t product0 = std::uint64_t{kMultiplier[0]} * blocks.word[0][k];
    const std::uint64_t product1 = std::uint64_t{kMultiplier[1]} * blocks.word[2][k];
    const std::uint32_t word1 = blocks.word[1][k], word3 = blocks.word[3][k];
    blocks.word[0][k] = static_cast<std::uint32_t>(product1 >> 32U) ^ word1 ^ key0;
    blocks.word[1][k] = static_cast<std::uint32_t>(product1);
    blocks.word[2][k] = static_cast<std::uint32_t>(product0 >> 32U) ^ word3 ^ key1;
    blocks.word[3][k] = static_cast<std::uint32_t>(product0);
  }
}

// ----------------------------------------------------------------------------------------------------- normal numbers

// The lower half of a word's range, m + 1/2 in units of 2^-32, is the probability of a tail. As a float its exponent
// and its first four bits number a segment, the other 19 bits give the position in it.
constexpr unsigned kBitsInSegment = 19;
constexpr std::uint32_t kFirstSegment = std::bit_cast<std::uint32_t>(0.5F) >> kBitsInSegment;
constexpr std::uint32_t kSegments = (std::bit_cast<std::uint32_t>(0x1p31F) >> kBitsInSegment) - kFirstSegment + 1;

struct Quadratic {
  float c0, c1, c2, unused;
};

std::array<Quadratic, kSegments> make_quadratics() {
  std::array<Quadratic, kSegments> quadratics{};
  for (std::uint32_t segment = 0; segment + 1 < kSegments; ++segment) {
    const auto edge = [&](std::uint32_t s) {
      return static_cast<double>(std::bit_cast<float>((s + kFirstSegment) << kBitsInSegment));
    };
    const double low = edge(segment), high = edge(segment + 1);
    // Through both ends, so that the whole has no jumps, and the middle.
    const double z0 = -engine::normal_quantile(low * 0x1p-32);
    const double zm = -engine::normal_quantile(0.5 * (low + high) * 0x1p-32);
    const double z1 = -engine::normal_quantile(high * 0x1p-32);
    quadratics[segment] = {static_cast<float>(z0), static_cast<float>(-3.0 * z0 + 4.0 * zm - z1),
                           static_cast<float>(2.0 * z0 - 4.0 * zm + 2.0 * z1), 0.0F};
  }
  quadratics[kSegments - 1] = {0.0F, 0.0F, 0.0F, 0.0F};  // a probability of 1/2: reached by rounding only
  return quadratics;
}

// ---------------------------------------------------------------------------------------------------- Poisson numbers

// Larger numbers at kGaussianMean have a probability of 1e-8.
constexpr int kMaxBySearch = 40;

constexpr std::array<float, kMaxBySearch + 1> kReciprocal = [] {
  std::array<float, kMaxBySearch + 1> reciprocal{};
  for (std::size_t k = 1; k < reciprocal.size(); ++k) reciprocal[k] = static_cast<float>(1.0 / static_cast<double>(k));
  return reciprocal;
}();

/// exp(-x) for 0 <= x <= 80, relative error 2e-7: a power of two, and the series of the rest, at most ln(2) / 2.
VBAR_INLINE float exp_of_minus(float x) {
  const float octaves = x * 1.44269504F;
  const auto whole = static_cast<std::int32_t>(octaves + 0.5F);
  const auto n = static_cast<float>(whole);
  const float r = (n * 0.693359375F - x) + n * -2.12194440e-4F;  // ln 2 in two parts (Cody, Waite 1980)
  float series = 1.0F / 5040.0F;
  series = series * r + 1.0F / 720.0F;
  series = series * r + 1.0F / 120.0F;
  series = series * r + 1.0F / 24.0F;
  series = series * r + 1.0F / 6.0F;
  series = series * r + 0.5F;
  series = series * r + 1.0F;
  series = series * r + 1.0F;
  return series * std::bit_cast<float>((127 - whole) << 23);
}

// Pixels that are searched together: until the last of them is found.
constexpr std::size_t kGroup = 32;

/// Number of steps of the distribution at or below the uniform number: for means below kGaussianMean, and 0 for
/// others, which are left to the expansion.
VBAR_INLINE void search_group(const std::uint32_t* words, const float* means, float* numbers) {
  float uniform[kGroup], mean[kGroup], term[kGroup], sum[kGroup];
  std::int32_t steps[kGroup];
  for (std::size_t k = 0; k < kGroup; ++k) {
    uniform[k] = static_cast<float>(static_cast<std::int32_t>(words[k] >> 8U)) * 0x1p-24F;
    const float positive = means[k] > 0.0F ? means[k] : 0.0F;
    mean[k] = positive < kGaussianMean ? positive : 0.0F;
    term[k] = exp_of_minus(mean[k]);
    sum[k] = term[k];
    steps[k] = 0;
  }
  for (std::size_t count = 1; count <= kMaxBySearch; ++count) {
    const float reciprocal = kReciprocal[count];
    std::int32_t beyond = 0;
    for (std::size_t k = 0; k < kGroup; ++k) {
      const std::int32_t is_beyond = uniform[k] >= sum[k] ? 1 : 0;
      beyond += is_beyond;
      steps[k] += is_beyond;
      term[k] *= mean[k] * reciprocal;
      sum[k] += term[k];
    }
    if (beyond == 0) break;
  }
  for (std::size_t k = 0; k < kGroup; ++k) numbers[k] = static_cast<float>(steps[k]);
}

VBAR_WIDE_LOOPS void search(const std::uint32_t* words, const float* means, float* numbers) {
  for (std::size_t k = 0; k < kChunk; k += kGroup) search_group(words + k, means + k, numbers + k);
}

/// For a mean of kGaussianMean to 1e12 and a normal number w.
VBAR_INLINE float by_expansion(float mean, float w) {
  const float root = std::sqrt(mean), w2 = w * w;
  const float first = (1.0F / 3.0F) + w2 * (1.0F / 6.0F);
  const float second = w * (-1.0F / 36.0F - w2 * (1.0F / 72.0F)) / root;
  const float third = (-8.0F / 405.0F + w2 * (7.0F / 810.0F) + w2 * w2 * (1.0F / 270.0F)) / mean;
  return mean + (root * w + (first + (second + third)));
}

/// Expands the quantiles of the means from kGaussianMean on; the other numbers stay. A compiler makes vectors of each
/// loop.
VBAR_WIDE_LOOPS void expand(const float* means, const float* normal, float* numbers) {
  ChunkFloats mean, number;
  for (std::size_t k = 0; k < kChunk; ++k) {
    const float large = means[k] >= kGaussianMean ? means[k] : kGaussianMean;
    mean[k] = large < 1e12F ? large : 1e12F;  // so that infinity has a result as well
  }
  for (std::size_t k = 0; k < kChunk; ++k) number[k] = by_expansion(mean[k], normal[k]);
  for (std::size_t k = 0; k < kChunk; ++k) number[k] = std::floor(number[k]);
  for (std::size_t k = 0; k < kChunk; ++k) {
    const float positive = number[k] > 0.0F ? number[k] : 0.0F;
    numbers[k] = means[k] >= kGaussianMean ? positive : numbers[k];
  }
}

}  // namespace

VBAR_WIDE_LOOPS void draw_words(const NoiseKey& key, NoiseKind kind, std::uint32_t chunk, ChunkWords& words) {
  Blocks blocks;
  for (std::size_t k = 0; k < kBlocksOfChunk; ++k) {
    blocks.word[0][k] = chunk * static_cast<std::uint32_t>(kBlocksOfChunk) + static_cast<std::uint32_t>(k);
    blocks.word[1][k] = static_cast<std::uint32_t>(key.exposure);
    blocks.word[2][k] = static_cast<std::uint32_t>(key.exposure >> 32U);
    blocks.word[3][k] = static_cast<std::uint32_t>(kind);
  }
  auto key0 = static_cast<std::uint32_t>(key.key), key1 = static_cast<std::uint32_t>(key.key >> 32U);
  for (int round = 0; round < kRounds; ++round) {
    philox_round(blocks, key0, key1);
    key0 += kWeyl[0];
    key1 += kWeyl[1];
  }
  for (std::size_t w = 0; w < 4; ++w)
    std::copy(blocks.word[w].begin(), blocks.word[w].end(),
              words.begin() + static_cast<std::ptrdiff_t>(w * kBlocksOfChunk));
}

void normal_numbers(const ChunkWords& words, ChunkFloats& normal) {
  static const std::array<Quadratic, kSegments> kQuadratics = make_quadratics();
  std::array<std::uint32_t, kChunk> segment;
  ChunkFloats place;
  for (std::size_t k = 0; k < kChunk; ++k) {
    const auto tail = static_cast<std::int32_t>(words[k] & 0x7FFFFFFFU);
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(tail) + 0.5F);
    segment[k] = (bits >> kBitsInSegment) - kFirstSegment;
    place[k] = static_cast<float>(static_cast<std::int32_t>(bits & ((1U << kBitsInSegment) - 1U))) * 0x1p-19F;
  }
  for (std::size_t k = 0; k < kChunk; ++k) {
    const Quadratic& q = kQuadratics[segment[k]];
    const float z = q.c0 + place[k] * (q.c1 + place[k] * q.c2);
    normal[k] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(z) ^ (words[k] & 0x80000000U));
  }
}

void poisson_numbers(const ChunkWords& words, std::span<const float, kChunk> means, std::span<float, kChunk> numbers) {
  int large = 0;
  for (std::size_t k = 0; k < kChunk; ++k) large += means[k] >= kGaussianMean ? 1 : 0;
  if (large < static_cast<int>(kChunk)) search(words.data(), means.data(), numbers.data());
  if (large == 0) return;
  ChunkFloats normal;
  normal_numbers(words, normal);
  expand(means.data(), normal.data(), numbers.data());
}

}  // namespace vbar::twins::camera
