#pragma once
// Free drift of the target about the servicer, linear in the mean ROE: a thousand drifts for the cost of one exact
// propagation.
//
// Position by the near-circular map (D'Amico 2010, eq. 2.17), ROE drifting under J2 at constant rates (Koenig,
// Guffanti, D'Amico 2017). Along-track distance is not curved: at a separation of 1 km the radial position is wrong by
// 7 cm.

#include <array>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::safety {

/// Holds the difference of a drift from the estimated one.
struct DriftError {
  double a_da_m = 0.0;             ///< error of the relative semi-major axis, m
  double differential_drag = 0.0;  ///< m/s^2, acceleration of the target along its flight less the servicer's
  double acted_for = 0.0;          ///< s, time for which both have acted before the drift begins
};

/// Position of the target in the servicer's RTN is `map * a_roe`, a_roe in m.
using PositionMap = Eigen::Matrix<double, 3, 6>;

class LinearDrift {
 public:
  static constexpr int kSamplesPerRevolution = 36;
  static constexpr int kMaxRevolutions = 40;

  /// Makes a drift of no duration.
  LinearDrift() = default;

  /// Makes the drifts that begin with these mean elements of the servicer and last `horizon` s. kNotFinite; kOutOfRange
  /// for more than kMaxRevolutions or elements that are not an orbit.
  static Result<LinearDrift> make(const orbit::QnsElements& servicer_mean, double horizon);

  /// Returns the minimum distance, m, of the drift from mean ROE times a, m. The evaluation ends at the first distance
  /// below `enough_m`, which is then the result.
  [[nodiscard]] double min_distance(const Vector6& a_roe_m, const DriftError& error = {}, double enough_m = 0.0) const;

  /// Returns the number of samples of every drift, equally spaced from 0 to the horizon.
  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] double time_s(int sample) const { return sample * step_s_; }
  /// Returns the map from the ROE at the start to the position at a sample.
  [[nodiscard]] PositionMap map_at(int sample) const;

 private:
  Matrix6 rate_ = Matrix6::Zero();  ///< rate of the ROE, 1/s
  double mean_motion_ = 0.0;        ///< rad/s
  double step_s_ = 0.0;
  int samples_ = 0;
  // Cosine and sine of the argument of latitude at samples 0 ... kSamplesPerRevolution - 1, which repeat.
  std::array<double, kSamplesPerRevolution> cos_u_{};
  std::array<double, kSamplesPerRevolution> sin_u_{};
};

}  // namespace vbar::fsw::safety
