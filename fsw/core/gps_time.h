#pragma once
// The one clock: integer nanoseconds of GPS time since 1980-01-06 00:00:00. No floating-point time is stored or
// compared; seconds as double exist only as differences passed to dynamics.

#include <compare>
#include <cstdint>

namespace vbar::fsw {

inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// A span of time, ns.
struct Duration {
  std::int64_t ns = 0;
  constexpr auto operator<=>(const Duration&) const = default;
};

/// An instant, ns of GPS time since 1980-01-06.
struct GpsTime {
  std::int64_t ns = 0;
  constexpr auto operator<=>(const GpsTime&) const = default;
};

constexpr Duration operator-(GpsTime a, GpsTime b) {
  return {a.ns - b.ns};
}
constexpr GpsTime operator+(GpsTime a, Duration d) {
  return {a.ns + d.ns};
}
constexpr GpsTime operator-(GpsTime a, Duration d) {
  return {a.ns - d.ns};
}
constexpr Duration operator+(Duration a, Duration b) {
  return {a.ns + b.ns};
}

/// Returns the seconds of a span: exact to a nanosecond for spans under 104 days (2^53 ns).
constexpr double seconds(Duration d) {
  return static_cast<double>(d.ns) / 1e9;
}

/// Returns the span of an integer number of seconds.
constexpr Duration duration_of_seconds(std::int64_t s) {
  return {s * kNanosecondsPerSecond};
}

/// Returns the span nearest to `s` seconds; `s` must be finite and below 9e9 in magnitude.
constexpr Duration nearest_duration(double s) {
  const double ns = s * 1e9;
  return {static_cast<std::int64_t>(ns < 0.0 ? ns - 0.5 : ns + 0.5)};
}

}  // namespace vbar::fsw
