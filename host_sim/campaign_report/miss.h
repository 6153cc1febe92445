#pragma once
// Errors as vectors: circular error probable and its 95 % counterpart in a plane, and the ellipse of the covariance.
// Radii are about the aim, so that a bias counts; neither assumes a Gaussian.

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/campaign_report/percentile.h"

namespace vbar::campaign_report {

/// An error with components in RTN, of the complete cases that have it.
struct VectorError {
  std::string key;                                  ///< "waypoints.10.control_error": without axis and unit
  std::vector<std::array<double, 3>> errors_rtn_m;  ///< m
};

/// Returns the errors for which results.csv has the three components "<key>_r_m", "<key>_t_m", "<key>_n_m".
[[nodiscard]] std::vector<VectorError> vector_errors(const Campaign& campaign);

/// A plane of RTN by its axes, 0 to 2.
struct Plane {
  const char* name;
  std::size_t first, second;
};
/// Across the track, and the horizontal plane.
inline constexpr std::array kPlanes{Plane{"RN (across the track)", 0, 2}, Plane{"TN (horizontal)", 1, 2}};

struct PlaneMiss {
  Percentile cep_m, r95_m;          ///< radii that half of the cases, 95 % of them, keep to
  std::array<double, 2> mean_m{};   ///< bias
  std::array<double, 2> sigma_m{};  ///< semi-axes of the ellipse of the sample covariance, the larger first
  double angle_rad = 0.0;           ///< angle of the larger semi-axis, from the plane's first axis to its second
};

/// Returns the figures of at least two cases.
[[nodiscard]] PlaneMiss miss_in(const Plane& plane, const VectorError& error, double confidence);

}  // namespace vbar::campaign_report
