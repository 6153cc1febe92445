#pragma once
// Random numbers by counter: a stream is named by (seed, name) and its k-th number is a pure function of (seed, name,
// k). Adding, removing or reordering streams therefore changes no other stream, and the position of a stream is one
// integer.
//
// Philox4x64-10 of Random123 (Salmon, Moraes, Dror, Shaw 2011: "Parallel random numbers: as easy as 1, 2, 3"), with the
// key (seed, 64-bit FNV-1a hash of the name): streams of two seeds never coincide, those of two names only if the
// hashes do.

#include <array>
#include <cstdint>
#include <string_view>

namespace vbar::engine {

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  /// The next 64 random bits.
  std::uint64_t bits();

  /// The next number, uniform on the open interval (0, 1).
  double uniform();
  /// Uniform on (low, high).
  double uniform(double low, double high);
  /// Standard normal; takes one number of the stream.
  double normal();
  /// Exponential with mean 1; takes one number of the stream.
  double exponential();

  /// Four uniform numbers on (0, 1) that belong to the item numbered `index` (a packet, a burn), whatever was drawn
  /// before. They share no bits with the numbers drawn in sequence.
  [[nodiscard]] std::array<double, 4> uniforms_of(std::uint64_t index) const;

  /// Returns how many numbers have been drawn in sequence; with seed and name this is the stream's whole state.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  /// Continues as if `position` numbers had been drawn.
  void seek(std::uint64_t position) { position_ = position; }

 private:
  enum class Domain : std::uint64_t { kSequence = 0, kNumbered = 1 };
  [[nodiscard]] std::array<std::uint64_t, 4> block(Domain domain, std::uint64_t index) const;

  std::array<std::uint64_t, 2> key_;
  std::uint64_t position_ = 0;
  // The block the last number came from: a cache, not state.
  std::array<std::uint64_t, 4> cached_block_{};
  std::uint64_t cached_index_ = ~std::uint64_t{0};
};

/// FNV-1a, 64 bits (Fowler, Noll, Vo): a hash whose value is the same on every computer.
constexpr std::uint64_t fnv1a_64(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) {
    hash ^= static_cast<std::uint8_t>(c);
    hash *= 0x00000100000001b3U;
  }
  return hash;
}

}  // namespace vbar::engine
