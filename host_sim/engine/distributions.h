#pragma once
// Random numbers from uniform ones by inversion of the distribution function: one in, one out, no rejection, so that
// a draw always consumes the same number of random numbers. The standard library's distributions are not used: each
// vendor's differ.

#include <cstdint>

namespace vbar::engine {

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

}  // namespace vbar::engine
