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
#include <optional>
#include <string_view>

#include "fsw/core/gps_time.h"

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

// Random numbers from uniform ones by inversion of the distribution function: one in, one out, no rejection, so that
// a draw always consumes the same number of random numbers. The standard library's distributions are not used: each
// vendor's differ.

/// 52 of the 64 bits as a number on the open interval (0, 1): never 0, never 1, symmetric about 1/2.
constexpr double open_unit_interval(std::uint64_t bits) {
  return (static_cast<double>(bits >> 12U) + 0.5) * 0x1p-52;
}

/// Quantile of the standard normal distribution at p in (0, 1), to about 1e-16 relative (Wichura 1988, algorithm AS
/// 241, PPND16). p outside (0, 1) yields NaN.
double normal_quantile(double p);

/// Distribution function of the standard normal distribution.
double normal_distribution(double x);

/// Quantile at p in (0, 1) of the standard normal distribution cut off below `low` and above `high`, low < high.
/// The result never leaves [low, high].
double truncated_normal_quantile(double p, double low, double high);

/// What an exponential variable of mean 1 exceeds with probability p in (0, 1); at most 36.8 for the p of
/// open_unit_interval.
double exponential_upper_quantile(double p);

// A stationary first-order Gauss-Markov process, sampled at arbitrary increasing times by its exact transition:
//   x(t + dt) = e x(t) + sigma sqrt(1 - e^2) n,  e = exp(-dt / T)
// with standard normal n; its autocorrelation is sigma^2 exp(-|dt| / T) (Gelb 1974, Applied Optimal Estimation, 3.8).

class GaussMarkov {
 public:
  /// `sigma`: standard deviation, in the unit of the value, 0: the value is always 0; `time_s`: correlation time, above
  /// 0; `stream`: each new time draws one number of it.
  GaussMarkov(double sigma, double time_s, const RandomStream& stream)
      : sigma_(sigma), time_s_(time_s), stream_(stream) {}

  /// The value at `time`; the first one is drawn from the stationary distribution. A time that is not later than the
  /// last repeats its value.
  double at(fsw::GpsTime time);

 private:
  double sigma_;
  double time_s_;
  RandomStream stream_;
  std::optional<fsw::GpsTime> last_;
  double value_ = 0.0;
};

}  // namespace vbar::engine
