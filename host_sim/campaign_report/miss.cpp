#include "host_sim/campaign_report/miss.h"

#include <algorithm>
#include <cmath>

namespace vbar::campaign_report {

std::vector<VectorError> vector_errors(const Campaign& campaign) {
  constexpr std::string_view kFirst = "error_r_m", kAxis = "_r_m";
  std::vector<VectorError> found;
  for (const Figure& radial : campaign.figures) {
    if (!radial.key.ends_with(kFirst)) continue;
    VectorError error{radial.key.substr(0, radial.key.size() - kAxis.size()), {}};
    const Figure* const along = campaign.figure(error.key + "_t_m");
    const Figure* const normal = campaign.figure(error.key + "_n_m");
    if (along == nullptr || normal == nullptr) continue;
    for (std::size_t k = 0; k < campaign.cases.size(); ++k) {
      const std::array<double, 3> rtn{radial.values[k], along->values[k], normal->values[k]};
      const bool is_whole = std::ranges::all_of(rtn, [](double v) { return std::isfinite(v); });
      if (campaign.cases[k].is_complete() && is_whole) error.errors_rtn_m.push_back(rtn);
    }
    if (error.errors_rtn_m.size() >= 2) found.push_back(std::move(error));
  }
  return found;
}

PlaneMiss miss_in(const Plane& plane, const VectorError& error, double confidence) {
  const auto count = static_cast<double>(error.errors_rtn_m.size());
  PlaneMiss miss;
  std::vector<double> radii;
  for (const auto& rtn : error.errors_rtn_m) {
    radii.push_back(std::hypot(rtn[plane.first], rtn[plane.second]));
    miss.mean_m[0] += rtn[plane.first] / count;
    miss.mean_m[1] += rtn[plane.second] / count;
  }
  std::ranges::sort(radii);
  miss.cep_m = percentile(radii, 0.5, confidence);
  miss.r95_m = percentile(radii, 0.95, confidence);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const auto& rtn : error.errors_rtn_m) {
    const double x = rtn[plane.first] - miss.mean_m[0], y = rtn[plane.second] - miss.mean_m[1];
    xx += x * x / (count - 1.0);
    xy += x * y / (count - 1.0);
    yy += y * y / (count - 1.0);
  }
  // Eigenvalues of a symmetric 2x2 matrix.
  const double half_sum = 0.5 * (xx + yy), radius = std::hypot(0.5 * (xx - yy), xy);
  miss.sigma_m = {std::sqrt(half_sum + radius), std::sqrt(std::max(0.0, half_sum - radius))};
  miss.angle_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return miss;
}

}  // namespace vbar::campaign_report
