#pragma once
// The pose of the target from its keypoints in images (after Park and D'Amico 2023): an unscented filter on relative
// orbit, attitude and rate at once.
//
// State: osculating ROE of the target with respect to the servicer; its attitude as a small rotation (generalised
// Rodrigues parameters, body axes) from a reference quaternion (USQUE, Crassidis and Markley 2003); its rate; the
// differential accelerations, as in fsw/trunk/relative_orbit.h; and the correlated errors of the keypoints. A network
// has the same errors for the same view, so that a filter that assumed white errors would soon underestimate its
// covariance by a factor of ten. A share of each keypoint's own error, and a shift and stretch of all, are therefore
// Gauss-Markov states that decay as the target rotates: by 1/e in 11 to 14 deg, measured over ten tumbles of 0.3 to 1.5
// deg/s. A part of the stretch is constant: it is equivalent to another range, and only known burns separate the two.
//
// Orbit and attitude are decoupled between images, so that each is sampled alone; a measurement depends on ROE
// and attitude only, so that the other states are not sampled. Since the transform is a regression, the result is that
// of sampling all states.

#include <array>

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/estimation/layout.h"
#include "fsw/imaging/camera_model.h"
#include "fsw/navigation/adaptive_noise.h"
#include "fsw/navigation/pose_attitude.h"
#include "fsw/orbit/elements.h"
#include "fsw/pose/keypoint.h"

namespace vbar::fsw::navigation {

/// 1-sigma values of the initial state and of unmodelled effects.
struct PoseFilterSettings {
  imaging::CameraModel camera;
  pose::KeypointShape shape{};            ///< body axes from the centre of mass, m
  Matrix3 inertia = Matrix3::Identity();  ///< kg m^2; only its ratios matter

  AdaptiveNoiseSettings acceleration{.psd = 1e-13, .psd_min = 1e-14, .psd_max = 1e-11};          ///< m^2/s^3
  AdaptiveNoiseSettings angular_acceleration{.psd = 1e-11, .psd_min = 1e-13, .psd_max = 1e-10};  ///< rad^2/s^3
  double along_track_sigma = 1e-9;  ///< m/s^2, differential drag
  double along_track_time_s = 6000.0;
  double from_sun_sigma = 3e-8;  ///< m/s^2, differential radiation pressure in sunlight
  double from_sun_time_s = 86400.0;

  double correlated_share = 0.85;       ///< share of a keypoint's variance that is common to images of the same view
  double shift_sigma_px = 0.8;          ///< of all keypoints together, per axis: likewise
  double stretch_sigma = 9e-3;          ///< of the target's apparent size: likewise
  double correlation_angle = 0.21;      ///< rad: rotation of the target over which keypoint errors decorrelate
  double correlation_time_s = 120.0;    ///< s: decorrelation for a target with a small rate
  double lasting_stretch_sigma = 2e-3;  ///< of the target's apparent size, constant over all views
  double lasting_stretch_time_s = 3600.0;

  double gate = 9.21;              ///< of a keypoint's normalised innovation squared: 99 % of two degrees of freedom
  double max_noise_scale = 9.0;    ///< largest factor on the covariances of keypoints, learned and for one image
  double max_refused_share = 0.6;  ///< of the keypoints; beyond it the image is refused
  int min_keypoints = 3;
  double maneuver_sigma = 2e-6;           ///< m/s, per axis of a burn
  double maneuver_sigma_relative = 1e-3;  ///< of its size
};

/// Position and attitude of the camera at an image.
struct CameraPose {
  Matrix3 R_camera_eci = Matrix3::Identity();
  Vector3 origin_eci = Vector3::Zero();  ///< from the servicer's centre of mass, m
};

/// Edit status of a keypoint. Residuals are measured minus predicted, px.
struct KeypointUpdate {
  bool is_usable = false;  ///< of the network's, and predicted in front of the camera
  bool accepted = false;
  Vector2 prefit = Vector2::Zero();
  Vector2 postfit = Vector2::Zero();
  double nis = 0.0;  ///< of this keypoint alone
};

/// Edit status of the keypoints of an image.
struct PoseUpdate {
  bool accepted = false;
  int usable = 0;
  int used = 0;
  double nis = 0.0;          ///< of the accepted ones together: 2 * used in the mean
  double noise_scale = 1.0;  ///< factor applied to the covariances of keypoints
  std::array<KeypointUpdate, network::kKeypoints> keypoints{};

  [[nodiscard]] bool is_mostly_rejected(double share) const { return usable > 0 && usable - used > share * usable; }
};

class PoseFilter {
 public:
  struct Roe {
    static constexpr int kSize = 6;  ///< dimensionless
  };
  struct Attitude {
    static constexpr int kSize = 3;  ///< rad: R_eci_body = R_reference exp(rotation)
  };
  struct Rate {
    static constexpr int kSize = 3;  ///< rad/s, body axes
  };
  struct DifferentialAccelerations {
    static constexpr int kSize = 2;  ///< m/s^2: along track, away from the Sun
  };
  struct Common {
    static constexpr int kSize = 4;  ///< of all keypoints: shift (px, px), stretch and lasting stretch (shares)
  };
  struct KeypointError {
    static constexpr int kSize = 2 * network::kKeypoints;  ///< over its standard deviation: whitened, 1 if decorrelated
  };
  using State = estimation::Layout<Roe, Attitude, Rate, DifferentialAccelerations, Common, KeypointError>;
  using Estimate = estimation::Estimate<State::kSize>;

  PoseFilter() = default;

  /// Replaces the settings and resets. kOutOfRange for an invalid inertia or other invalid settings.
  Status configure(const PoseFilterSettings& settings);
  [[nodiscard]] const PoseFilterSettings& settings() const { return settings_; }

  /// Initialises with ROE (dimensionless), an attitude, and covariances (attitude: rotation in body axes and rate).
  void begin(const Vector6& roe, const Matrix6& roe_covariance, const AttitudeState& attitude,
             const Matrix6& attitude_covariance);
  /// Re-initialises attitude and rate; the orbit stays, the estimated keypoint errors are discarded.
  void set_attitude(const AttitudeState& attitude, const Matrix6& attitude_covariance);
  /// Inflates the covariance of the along-track position by `sigma_m`, after contradicting measurements.
  void inflate_position(double sigma_m, double semi_major_axis_m);
  void reset() { started_ = false; }
  [[nodiscard]] bool started() const { return started_; }

  /// Propagates by `dt` seconds, at most 60; `servicer`: its state before. Resets itself if the orbit is invalid.
  void advance(const orbit::CartesianState& servicer, const Vector3& sun_eci, double dt);

  /// A burn of the servicer; `servicer`: its state before.
  void add_servicer_impulse(const orbit::CartesianState& servicer, const Vector3& dv_eci);

  /// Processes the keypoints of an image; the filter must be at its time.
  const PoseUpdate& take(const pose::Keypoints& keypoints, const CameraPose& camera,
                         const orbit::CartesianState& servicer);

  /// Processes a position of the target from the servicer's centre of mass alone, m, ECI axes; no gate.
  void take_position(const Vector3& relative_eci, const Matrix3& covariance_m2, const orbit::CartesianState& servicer);

  [[nodiscard]] Vector6 roe() const { return estimate_.mean().head<6>(); }
  [[nodiscard]] Matrix6 roe_covariance() const { return estimate_.head_covariance<6>(); }
  [[nodiscard]] const AttitudeState& attitude() const { return attitude_; }
  /// Of the rotation in body axes (rad) and the rate (rad/s).
  [[nodiscard]] Matrix6 attitude_covariance() const;
  /// 1 sigma of the body axis with the largest uncertainty, rad.
  [[nodiscard]] double attitude_sigma() const;
  [[nodiscard]] const Inertia& inertia() const { return inertia_; }
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  [[nodiscard]] const PoseUpdate& last_update() const { return update_; }
  /// Factor on the covariances of keypoints, learned from the residuals of all images so far.
  [[nodiscard]] double learned_noise_scale() const { return learned_scale_ > 1.0 ? learned_scale_ : 1.0; }
  [[nodiscard]] double acceleration_psd() const { return acceleration_noise_.psd(); }
  [[nodiscard]] double angular_acceleration_psd() const { return angular_noise_.psd(); }
  /// kNotReady before begin().
  [[nodiscard]] Result<orbit::CartesianState> target(const orbit::CartesianState& servicer) const;
  /// Covariance of the target's position from the servicer, ECI axes, m^2; zero if there is none.
  [[nodiscard]] Matrix3 position_covariance(const orbit::CartesianState& servicer) const;

 private:
  static constexpr int kRows = 2 * network::kKeypoints;
  static constexpr int kMoving = Roe::kSize + Attitude::kSize + Rate::kSize + DifferentialAccelerations::kSize;
  static constexpr int kSeen = Roe::kSize + Attitude::kSize;  ///< states in a measurement other than errors
  static constexpr std::size_t kSeenPoints = 2 * kSeen + 1;
  using Rows = Eigen::Matrix<double, kRows, 1>;
  using Square = Eigen::Matrix<double, kRows, kRows>;
  using Moving = Eigen::Matrix<double, kMoving, kMoving>;

  /// Too large for the stack.
  struct Workspace {
    std::array<Rows, kSeenPoints> values;
    Rows predicted;
    Rows residual;
    Eigen::Matrix<double, kRows, State::kSize> jacobian;
    Eigen::Matrix<double, kRows, State::kSize> jacobian_covariance;
    Square noise;
    Square innovation;
    Square lower;
  };

  void advance_orbit(const orbit::CartesianState& servicer, const Vector3& sun_eci, double dt, Moving& jacobian,
                     Moving& noise, Eigen::Matrix<double, kMoving, 1>& mean);
  void advance_attitude(const orbit::CartesianState& servicer, double dt, Moving& jacobian, Moving& noise,
                        Eigen::Matrix<double, kMoving, 1>& mean);
  void decay_errors(double dt);
  void reset_error_states();
  void reset_attitude_error();

  bool predict_keypoints(const pose::Keypoints& keypoints, const CameraPose& camera,
                         const orbit::CartesianState& servicer);
  void model_errors(const pose::Keypoints& keypoints, const Vector2& centre_px);
  void expect_innovations();
  void gate_keypoints();
  bool factorise(const Square& matrix, const std::array<int, kRows>& rows, int count);
  [[nodiscard]] double joint_nis(const std::array<int, kRows>& rows, int count);
  void fold_in(const pose::Keypoints& keypoints, double raised);
  void learn_scale(int count);
  void adapt(const std::array<int, kRows>& rows, int count, const CameraPose& camera);

  PoseFilterSettings settings_;
  Inertia inertia_;
  AdaptiveNoise acceleration_noise_;
  AdaptiveNoise angular_noise_;
  bool started_ = false;
  double since_update_s_ = 0.0;
  double learned_scale_ = 1.0;
  AttitudeState attitude_;  ///< the reference, and the rate: the same as the estimate's
  Estimate estimate_;
  PoseUpdate update_;
  Workspace work_;
};

}  // namespace vbar::fsw::navigation
