#include "host_sim/report/true_distance.h"

#include <cstddef>

namespace vbar::report {
namespace {

constexpr double kLongestInterpolated_s = 120.0;
constexpr int kParts = 8;

/// Cubic Hermite interpolation at `share` of the way from `a` to `b`.
double distance_between(const TruthRow& a, const TruthRow& b, double share) {
  const double dt = b.time_s - a.time_s;
  const double s = share, r = 1.0 - share;
  Triple position{};
  for (std::size_t k = 0; k < 3; ++k)
    position[k] = r * r * (1.0 + 2.0 * s) * a.relative_position_rtn[k] + r * r * s * dt * a.relative_velocity_rtn[k] +
                  s * s * (3.0 - 2.0 * s) * b.relative_position_rtn[k] - s * s * r * dt * b.relative_velocity_rtn[k];
  return magnitude(position);
}

}  // namespace

void for_each_distance(const RunRecord& record, const std::function<void(const TrueDistance&)>& visit) {
  for (std::size_t k = 0; k < record.truth.size(); ++k) {
    const TruthRow& row = record.truth[k];
    visit({row.time_s, magnitude(row.relative_position_rtn)});
    if (k + 1 == record.truth.size()) break;
    const TruthRow& next = record.truth[k + 1];
    const double dt = next.time_s - row.time_s;
    if (dt > kLongestInterpolated_s) continue;
    for (int part = 1; part < kParts; ++part) {
      const double share = static_cast<double>(part) / kParts;
      visit({row.time_s + share * dt, distance_between(row, next, share)});
    }
  }
}

std::optional<TrueDistance> min_distance(const RunRecord& record) {
  std::optional<TrueDistance> least;
  for_each_distance(record, [&](const TrueDistance& one) {
    if (!least || one.distance_m < least->distance_m) least = one;
  });
  return least;
}

}  // namespace vbar::report
