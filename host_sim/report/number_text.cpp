#include "host_sim/report/number_text.h"

#include <cmath>

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
  if (!std::isfinite(seconds)) return kNone;
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  const auto minutes = static_cast<std::int64_t>(std::llround(seconds / 60.0));
  if (minutes < 60) return fmt::format("{} min {} s", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
  return minutes % 60 == 0 ? fmt::format("{} h", minutes / 60) : fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

std::string velocity_text(double mps) {
  if (!std::isfinite(mps)) return kNone;
  return std::abs(mps) >= 0.3 ? fmt::format("{:.4f} m/s", mps) : fmt::format("{:.4f} mm/s", mps * 1e3);
}

}  // namespace vbar::report
