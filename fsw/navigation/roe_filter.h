#pragma once
// The relative orbit from bearings: an unscented filter on the target's relative orbital elements.
//
// State: osculating ROE of the target with respect to the servicer; what pushes the two apart, along track and away
// from the Sun; how far the centre of brightness stands from the centre of mass; and what all bearings have in common
// of error, in the orbital plane and across it. The elements, not a position, because in them all but one of the
// uncertainties stand still, and because the servicer's orbit then only carries the frame: a better estimate of it
// moves the target along and leaves the relative orbit alone.
//
// Bearings alone do not tell the range; what does is a known burn, the curvature of the orbit and time (Woffinden and
// Geller 2009; Gaias, D'Amico, Ardaens 2014). An error of all bearings in the vertical looks like another curvature,
// so it is estimated with the rest and not left to the noise.

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/estimation/layout.h"
#include "fsw/navigation/adaptive_noise.h"
#include "fsw/navigation/bearing.h"
#include "fsw/navigation/propagation.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

/// 1-sigma figures of what the filter starts from and does not model.
struct RoeFilterSettings {
  AdaptiveNoiseSettings acceleration;  ///< what nothing below describes
  double along_track_sigma = 1e-9;     ///< m/s^2, differential drag
  double along_track_time_s = 6000.0;  ///< its correlation time
  double from_sun_sigma = 3e-8;        ///< m/s^2, differential radiation pressure in sunlight
  double from_sun_time_s = 86400.0;
  double brightness_offset_m = 0.0;  ///< towards the Sun (bearing.h)
  double brightness_offset_sigma_m = 0.15;
  double brightness_offset_time_s = 20000.0;
  double bearing_bias_sigma = 1.5e-5;  ///< rad, each axis: 3 arcsec
  double bearing_bias_time_s = 43200.0;
  double resolved_share = 0.25;           ///< of the apparent radius that a centroid may be off, 1 sigma
  double maneuver_sigma = 2e-6;           ///< m/s, each axis of a burn
  double maneuver_sigma_relative = 1e-3;  ///< of its size
  double gate = 13.8;                     ///< of the normalised innovation squared: 99.9 % of two degrees of freedom
};

/// What came of one bearing. Residuals in rad, in the rows of bearing_axes().
struct BearingUpdate {
  bool accepted = false;
  Vector2 prefit = Vector2::Zero();
  Vector2 postfit = Vector2::Zero();
  double nis = 0.0;
  Vector2 normalised = Vector2::Zero();  ///< prefit over its expected standard deviation
};

/// Where a bearing is expected: direction and covariance (rad^2) in the first two rows of bearing_axes() of it, of the
/// estimate alone without a camera's noise.
struct BearingPrediction {
  Vector3 direction_eci = Vector3::Zero();
  Matrix2 covariance = Matrix2::Zero();
};

class RoeFilter {
 public:
  struct Roe {
    static constexpr int kSize = 6;  ///< dimensionless
  };
  struct Pushes {
    static constexpr int kSize = 2;  ///< m/s^2: along track, away from the Sun
  };
  struct BrightnessOffset {
    static constexpr int kSize = 1;  ///< m
  };
  struct BearingBias {
    static constexpr int kSize = 2;  ///< rad
  };
  using State = estimation::Layout<Roe, Pushes, BrightnessOffset, BearingBias>;
  using Estimate = estimation::Estimate<State::kSize>;

  explicit RoeFilter(const RoeFilterSettings& settings = {}) { configure(settings); }

  void configure(const RoeFilterSettings& settings) {
    settings_ = settings;
    noise_ = AdaptiveNoise(settings.acceleration);
    started_ = false;
  }

  /// Begins with ROE (dimensionless) of a covariance; all else as the settings say.
  void begin(const Vector6& roe, const Matrix6& covariance);
  /// The same with bearing biases (rad) known as well; covariance of the eight.
  void begin(const Vector6& roe, const Vector2& bias, const Eigen::Matrix<double, 8, 8>& covariance);
  void reset() { started_ = false; }
  [[nodiscard]] bool started() const { return started_; }

  /// Moves on by `dt` seconds; `servicer`: its state before. The filter resets itself where no orbit is left.
  void advance(const Propagation& propagation, const orbit::CartesianState& servicer, double dt);

  /// The servicer, at `servicer` before it, burns.
  void add_servicer_impulse(const orbit::CartesianState& servicer, const Vector3& dv_eci);

  /// Folds a bearing in; the filter must stand at its time. Refused if it does not fit (settings.gate).
  BearingUpdate take(const BearingMeasurement& bearing, const orbit::CartesianState& servicer, const Vector3& sun_eci);

  /// The bearings no longer fit: as after a burn of `velocity_sigma` (m/s, each axis) that nobody told of, and with the
  /// mean longitude in doubt by a share of itself.
  void doubt(const orbit::CartesianState& servicer, double velocity_sigma, double longitude_share);

  [[nodiscard]] Vector6 roe() const { return estimate_.mean().head<6>(); }
  [[nodiscard]] Matrix6 roe_covariance() const { return estimate_.head_covariance<6>(); }
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  /// Power spectral density of the relative acceleration that it takes for unknown, m^2/s^3.
  [[nodiscard]] double acceleration_psd() const { return noise_.psd(); }
  /// kNotReady before begin().
  [[nodiscard]] Result<orbit::CartesianState> target(const orbit::CartesianState& servicer) const;
  /// From `origin_eci` beside the servicer's centre of mass.
  [[nodiscard]] Result<BearingPrediction> predict(const orbit::CartesianState& servicer, const Vector3& origin_eci,
                                                  const Vector3& sun_eci) const;

 private:
  static constexpr int kSampled = Roe::kSize + Pushes::kSize;

  /// A bearing's model about the mean: what it shows across the axes, and its slope.
  struct Model {
    Vector2 value = Vector2::Zero();
    Eigen::Matrix<double, 2, State::kSize> slope;
    Matrix2 remainder = Matrix2::Zero();
  };
  [[nodiscard]] Result<Model> model_of(const Matrix3& axes, const Vector3& origin_eci,
                                       const orbit::CartesianState& servicer, const Vector3& sun_eci) const;
  [[nodiscard]] Estimate::Matrix process_noise(const orbit::QnsElements& servicer, double dt) const;

  void adapt(const BearingMeasurement& bearing, const BearingUpdate& update);

  RoeFilterSettings settings_;
  AdaptiveNoise noise_;
  GpsTime last_bearing_;
  bool started_ = false;
  Estimate estimate_;
};

/// The target's state from its ROE with respect to the servicer, and back.
Result<orbit::CartesianState> target_from_roe(const orbit::QnsElements& servicer, const Vector6& roe);
Result<Vector6> roe_of_target(const orbit::CartesianState& servicer, const orbit::CartesianState& target);

}  // namespace vbar::fsw::navigation
