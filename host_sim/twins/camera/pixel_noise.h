#pragma once
// Random numbers for the pixels of an image: computed in chunks, each a pure function of its position.
//
// Bits: Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011), the four words of a block shared out to four pixels. Normal
// numbers: the inverse of the distribution function by a quadratic in each of 16 segments an octave of the tail
// probability (hierarchical segments: Lee, Cheung, Villasenor, Leong 2006), so that tails are as good as the centre.
// Poisson numbers: by inversion too. One 32-bit word makes one number in either case, and nothing is ever rejected.
//
// All loops are over chunks of pixels and in single precision, so that a compiler makes vector instructions of them;
// they use no mathematical function but the square root, so the bits are the same on every processor.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::twins::camera {

inline constexpr std::size_t kChunk = 256;  ///< pixels handled together
inline constexpr std::size_t kBlocksOfChunk = kChunk / 4;

using ChunkWords = std::array<std::uint32_t, kChunk>;
using ChunkFloats = std::array<float, kChunk>;

/// The kind of noise of one exposure: shot noise and read noise share no bits.
enum class NoiseKind : std::uint32_t { kShot = 0, kRead = 1 };

struct NoiseKey {
  std::uint64_t key = 0;
  std::uint64_t exposure = 0;
};

/// Draws the words of chunk `chunk` of an image: its pixel k gets word k / 64 of the block numbered 64 * chunk + k %
/// 64, counter (block, exposure's low word, its high word, kind).
void draw_words(const NoiseKey& key, NoiseKind kind, std::uint32_t chunk, ChunkWords& words);

/// Computes standard normal numbers, up to 6.3 either way (the word's finest probability is 2^-33); error below 1e-5.
void normal_numbers(const ChunkWords& words, ChunkFloats& normal);

/// Computes Poisson numbers of the means given (0 for one that is negative or not a number). Below kGaussianMean by
/// search through the distribution function, exact to 1e-7 in probability; from there on by the expansion of the
/// quantile about the normal one (Giles 2016, algorithm 955), which is within 1e-4 in probability there and better with
/// the mean.
void poisson_numbers(const ChunkWords& words, std::span<const float, kChunk> means, std::span<float, kChunk> numbers);

inline constexpr float kGaussianMean = 12.0F;

}  // namespace vbar::twins::camera
