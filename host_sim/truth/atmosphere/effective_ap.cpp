#include "host_sim/truth/atmosphere/effective_ap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vbar::truth {
namespace {

constexpr double kQuietAp = 4.0;
constexpr double kThreeHours = 10800.0;

/// From slope 1 at the quiet value to `slope` far above, with rate `rate`.
double saturated(double ap, double rate, double slope) {
  const double excess = ap - kQuietAp;
  return excess + (slope - 1.0) * (excess + (std::exp(-rate * excess) - 1.0) / rate);
}

}  // namespace

EffectiveAp::EffectiveAp(const Nrlmsise00Tables::Upper& p, const SolarIndices& indices) {
  if (indices.geomagnetic_index == GeomagneticIndex::kDaily) {
    daily_ = saturated(indices.ap_daily, p[43], p[44]);
    return;
  }
  if (p[51] == 0.0) return;  // the quantity does not respond
  remembers_ = true;
  for (std::size_t i = 0; i < history_.size(); ++i) history_[i] = saturated(indices.ap_history[i], p[24], p[25]);
  fading_ = kThreeHours * std::abs(p[51]);
  latitude_slope_ = p[138];
}

double EffectiveAp::at(double latitude_deg) const {
  if (!remembers_) return daily_;
  constexpr double kMaxDecay = 0.99999;  // the sums below divide by 1 - e
  const double e = std::min(std::exp(-fading_ / (1.0 + latitude_slope_ * (45.0 - std::abs(latitude_deg)))), kMaxDecay);
  // Weights e^k of the k-th three hours before; a mean of eight replaces eight neighbouring powers.
  const double e2 = e * e, e3 = e2 * e, e4 = e2 * e2, e8 = e4 * e4, e12 = e8 * e4;
  const double eight = (1.0 - e8) / (1.0 - e);
  const double sum = history_[0] + history_[1] * e + history_[2] * e2 + history_[3] * e3 +
                     (history_[4] * e4 + history_[5] * e12) * eight;
  const double e19 = e12 * e4 * e3;
  return sum / (1.0 + (1.0 - e19) / (1.0 - e) * std::sqrt(e));
}

}  // namespace vbar::truth
