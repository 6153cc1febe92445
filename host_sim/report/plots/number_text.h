#pragma once
// Numbers as a reader wants them: a dash for none, groups of three digits, seconds as hours and minutes.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::report {

/// `decimals` digits after the point; "–" for a number that is absent or not finite.
[[nodiscard]] std::string fixed(double value, int decimals);
[[nodiscard]] std::string fixed(const std::optional<double>& value, int decimals);

/// Writes about `digits` significant digits, as shortly as possible.
[[nodiscard]] std::string significant(double value, int digits);

/// 12,345,678.
[[nodiscard]] std::string grouped(std::uint64_t value);

/// Returns the nearest whole number; a dash for a number that is not finite, or negative.
[[nodiscard]] std::string grouped_nearest(double value);

/// "41 h 15 min", "2 h 15 min", "12.3 s".
[[nodiscard]] std::string duration_text(double seconds);

/// A length or velocity of `unit` (m, m/s) to three significant digits, with thousandths or thousands of the unit where
/// that reads better. Below a hundred-thousandth: "< 0.01 mm".
[[nodiscard]] std::string measure_text(double value, std::string_view unit);

/// Shares of a whole in tenths of a percent that add up to 100.0 (largest remainders); zeros if all parts are zero.
/// Negative parts count as zero.
[[nodiscard]] std::vector<double> percentages(const std::vector<double>& parts);

}  // namespace vbar::report
