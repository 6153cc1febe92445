#include "host_sim/report/plots/number_text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

namespace vbar::report {
namespace {

constexpr const char* kNone = "–";

}  // namespace

std::string fixed(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : kNone;
}

std::string fixed(const std::optional<double>& value, int decimals) {
  return value ? fixed(*value, decimals) : kNone;
}

std::string significant(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : kNone;
}

std::string grouped(std::uint64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0) text += ',';
    text += digits[k];
  }
  return text;
}

std::string grouped_nearest(double value) {
  constexpr double kLargest = 1e18;  // fits 64 bits
  if (!(value >= 0.0 && value <= kLargest)) return kNone;
  return grouped(static_cast<std::uint64_t>(std::llround(value)));
}

std::string duration_text(double seconds) {
  constexpr double kLongest_s = 1e15;  // its minutes fit 64 bits
  if (!(std::abs(seconds) <= kLongest_s)) return kNone;
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  const auto minutes = static_cast<std::int64_t>(std::llround(seconds / 60.0));
  if (minutes < 60) return fmt::format("{} min {} s", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
  return minutes % 60 == 0 ? fmt::format("{} h", minutes / 60) : fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

std::string measure_text(double value, std::string_view unit) {
  constexpr double kLeast = 1e-5, kThousandthsBelow = 0.1, kThousandsFrom = 1e4;
  if (!std::isfinite(value)) return kNone;
  const double size = std::abs(value);
  if (size == 0.0) return fmt::format("0 {}", unit);
  if (size < kLeast) return fmt::format("< 0.01 m{}", unit);
  const double scale = size < kThousandthsBelow ? 1e3 : size >= kThousandsFrom ? 1e-3 : 1.0;
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(size * scale))), 0, 4);
  return fmt::format("{:.{}f} {}{}", value * scale, decimals, scale > 1.0 ? "m" : scale < 1.0 ? "k" : "", unit);
}

std::vector<double> percentages(const std::vector<double>& parts) {
  const auto size = [](double part) { return part > 0.0 ? part : 0.0; };  // also of NaN
  double whole = 0.0;
  for (const double part : parts) whole += size(part);
  std::vector<double> tenths(parts.size(), 0.0);
  if (!(whole > 0.0)) return tenths;
  std::vector<std::pair<double, std::size_t>> remainders;
  double missing = 1000.0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const double exact = 1000.0 * size(parts[k]) / whole;
    tenths[k] = std::floor(exact);
    missing -= tenths[k];
    remainders.emplace_back(exact - tenths[k], k);
  }
  std::ranges::sort(remainders, std::greater{});
  for (std::size_t k = 0; k < remainders.size() && missing > 0.5; ++k, missing -= 1.0)
    tenths[remainders[k].second] += 1.0;
  for (double& share : tenths) share /= 10.0;
  return tenths;
}

}  // namespace vbar::report
