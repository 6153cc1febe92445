#pragma once
// Fixed arguments and a digest of results, for comparing two builds of the same mathematics.

#include <bit>
#include <cstdint>

namespace vbar::same_bits {

/// FNV-1a, 64 bits, over the bytes of doubles, least significant byte first on every machine.
class Digest {
 public:
  void add(double value) {
    // Sign and payload of a NaN are the processor's own; the sweeps hold none, but an infinity minus itself would show
    // up.
    std::uint64_t bits = value != value ? 0x7FF8000000000000U : std::bit_cast<std::uint64_t>(value);
    for (int k = 0; k < 8; ++k, bits >>= 8U) hash_ = (hash_ ^ (bits & 0xFFU)) * 0x100000001B3U;
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325U;
};

/// Pseudo-random doubles from integers (SplitMix64, Steele, Lea and Flood 2014), the same on every machine.
class Arguments {
 public:
  explicit Arguments(std::uint64_t seed) : state_(seed) {}

  /// Uniform in [low, high].
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(next() >> 11U) * 0x1p-53);
  }

  /// Either sign, magnitude log-uniform over powers of two from 2^low to 2^high.
  double magnitude(int low, int high) {
    const std::uint64_t bits = next();
    const auto span = static_cast<std::uint64_t>(high - low + 1);
    const auto exponent = static_cast<std::uint64_t>(low + static_cast<int>((bits >> 53U) % span) + 1023);
    return std::bit_cast<double>((bits & 0x000FFFFFFFFFFFFFU) | ((next() & 1U) << 63U) | (exponent << 52U));
  }

 private:
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_;
};

}  // namespace vbar::same_bits
