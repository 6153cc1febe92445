#pragma once
// Numbers as a reader wants them: a dash for none, groups of three digits, seconds as hours and minutes.

#include <cstdint>
#include <optional>
#include <string>

namespace vbar::report {

/// `decimals` digits after the point; "–" for a number that is absent or not finite.
[[nodiscard]] std::string fixed(double value, int decimals);
[[nodiscard]] std::string fixed(const std::optional<double>& value, int decimals);

/// About `digits` significant digits, as shortly as that can be.
[[nodiscard]] std::string significant(double value, int digits);

/// 12,345,678.
[[nodiscard]] std::string grouped(std::uint64_t value);

/// The same for the nearest whole number; a dash for one that is not finite or negative.
[[nodiscard]] std::string grouped_nearest(double value);

/// "41 h 15 min", "2 h 15 min", "12.3 s".
[[nodiscard]] std::string duration_text(double seconds);

/// A velocity in m/s, or mm/s where that reads better, with its unit.
[[nodiscard]] std::string velocity_text(double mps);

}  // namespace vbar::report
