#pragma once
// The relative orbit from bearings: an unscented filter on the target's relative orbital elements.
//
// State: osculating ROE of the target with respect to the servicer; the differential accelerations, along-track and
// away from the Sun; the offset of the centre of brightness from the centre of mass; the common bias of all bearings,
// in the orbital plane and across it. The elements are used instead of a position because all but one of their
// uncertainties are constant, and because the servicer's orbit then only defines the frame: an improved estimate of it
// shifts the target along and leaves the relative orbit unchanged.
//
// Bearings alone do not observe the range; known burns, the curvature of the orbit and time do (Woffinden and
// Geller 2009; Gaias, D'Amico, Ardaens 2014). A bias of all bearings in the vertical resembles another curvature,
// so that it is estimated as a state instead of being treated as noise.

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/estimation/layout.h"
#include "fsw/navigation/adaptive_noise.h"
#include "fsw/navigation/bearing.h"
#include "fsw/navigation/propagation.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

/// 1-sigma values of the initial state and of unmodelled effects.
struct RoeFilterSettings {
  AdaptiveNoiseSettings acceleration;  ///< of all effects not described below
  double along_track_sigma = 1e-9;     ///< m/s^2, differential drag
  double along_track_time_s = 6000.0;  ///< its correlation time
  double from_sun_sigma = 3e-8;        ///< m/s^2, differential radiation pressure in sunlight
  double from_sun_time_s = 86400.0;
  double brightness_offset_m = 0.0;  ///< towards the Sun (bearing.h)
  double brightness_offset_sigma_m = 0.15;
  double brightness_offset_time_s = 20000.0;
  double bearing_bias_sigma = 1.5e-5;  ///< rad, per axis: 3 arcsec
  double bearing_bias_time_s = 43200.0;
  double resolved_share = 0.25;           ///< error of a centroid as a share of the apparent radius, 1 sigma
  double maneuver_sigma = 2e-6;           ///< m/s, per axis of a burn
  double maneuver_sigma_relative = 1e-3;  ///< of its size
  double gate = 13.8;                     ///< of the normalised innovation squared: 99.9 % of two degrees of freedom
};

/// Result of one bearing. Residuals in rad, in the rows of bearing_axes().
struct BearingUpdate {
  bool accepted = false;
  Vector2 prefit = Vector2::Zero();
  Vector2 postfit = Vector2::Zero();
  double nis = 0.0;
  Vector2 normalised = Vector2::Zero();  ///< prefit residual over its standard deviation
};

/// Predicted bearing: direction and covariance (rad^2) in the first two rows of bearing_axes() of it, of the
/// estimate alone without the noise of the camera.
struct BearingPrediction {
  Vector3 direction_eci = Vector3::Zero();
  Matrix2 covariance = Matrix2::Zero();
};

class RoeFilter {
 public:
  struct Roe {
    static constexpr int kSize = 6;  ///< dimensionless
  };
  struct DifferentialAccelerations {
    static constexpr int kSize = 2;  ///< m/s^2: along track, away from the Sun
  };
  struct BrightnessOffset {
    static constexpr int kSize = 1;  ///< m
  };
  struct BearingBias {
    static constexpr int kSize = 2;  ///< rad
  };
  using State = estimation::Layout<Roe, DifferentialAccelerations, BrightnessOffset, BearingBias>;
  using Estimate = estimation::Estimate<State::kSize>;

  explicit RoeFilter(const RoeFilterSettings& settings = {}) { configure(settings); }

  void configure(const RoeFilterSettings& settings) {
    settings_ = settings;
    noise_ = AdaptiveNoise(settings.acceleration);
    started_ = false;
  }

  /// Initialises with ROE (dimensionless) and covariance; all other states as in the settings.
  void begin(const Vector6& roe, const Matrix6& covariance);
  /// Likewise with known bearing biases (rad); covariance of the eight.
  void begin(const Vector6& roe, const Vector2& bias, const Eigen::Matrix<double, 8, 8>& covariance);
  void reset() { started_ = false; }
  [[nodiscard]] bool started() const { return started_; }

  /// Propagates by `dt` seconds; `servicer`: its state before. The filter resets itself if the orbit is invalid.
  void advance(const Propagation& propagation, const orbit::CartesianState& servicer, double dt);

  /// A burn of the servicer; `servicer`: its state before.
  void add_servicer_impulse(const orbit::CartesianState& servicer, const Vector3& dv_eci);

  /// Processes a bearing; the filter must be at its time. Refused if it exceeds the gate (settings.gate).
  BearingUpdate take(const BearingMeasurement& bearing, const orbit::CartesianState& servicer, const Vector3& sun_eci);

  /// Inflates the covariance when bearings no longer fit: as after an unknown burn of `velocity_sigma` (m/s, per axis),
  /// with a sigma of the mean longitude that is a share of itself.
  void inflate_covariance(const orbit::CartesianState& servicer, double velocity_sigma, double longitude_share);

  [[nodiscard]] Vector6 roe() const { return estimate_.mean().head<6>(); }
  [[nodiscard]] Matrix6 roe_covariance() const { return estimate_.head_covariance<6>(); }
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  /// Power spectral density of the unmodelled relative acceleration, m^2/s^3.
  [[nodiscard]] double acceleration_psd() const { return noise_.psd(); }
  /// kNotReady before begin().
  [[nodiscard]] Result<orbit::CartesianState> target(const orbit::CartesianState& servicer) const;
  /// From `origin_eci` beside the servicer's centre of mass.
  [[nodiscard]] Result<BearingPrediction> predict(const orbit::CartesianState& servicer, const Vector3& origin_eci,
                                                  const Vector3& sun_eci) const;

 private:
  static constexpr int kSampled = Roe::kSize + DifferentialAccelerations::kSize;

  /// Measurement model of a bearing about the mean: its components across the axes, and its Jacobian.
  struct Model {
    Vector2 value = Vector2::Zero();
    Eigen::Matrix<double, 2, State::kSize> jacobian;
    Matrix2 nonlinearity = Matrix2::Zero();
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
