#pragma once
// The pose of the target from its keypoints in images (after Park and D'Amico 2023): an unscented filter on relative
// orbit, attitude and rate at once.
//
// State: osculating ROE of the target with respect to the servicer; its attitude as a small turn (generalised Rodrigues
// parameters, body axes) from a reference quaternion (USQUE, Crassidis and Markley 2003); its rate; what pushes the two
// apart, as in roe_filter.h; and what the keypoints of neighbouring images have in common of error. A network sees the
// same view twice and errs the same way twice, so a filter that took its errors for white would soon believe itself
// ten times better than it is. So a share of each keypoint's own error, and a shift and stretch of all, are states that
// fade as the target turns: measured over ten tumbles of 0.3 to 1.5 deg/s, by 1/e in 11 to 14 deg. A part of the
// stretch stays: it is another range, and only burns of known size tell the two apart.
//
// Orbit and attitude do not act on each other between images, so each is sampled alone; a measurement depends on ROE
// and attitude only, so the rest is not sampled there. By the transform as a regression this is the filter that samples
// all.

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

/// 1-sigma figures of what the filter starts from and does not model.
struct PoseFilterSettings {
  imaging::CameraModel camera;
  pose::KeypointShape shape{};            ///< body axes from the centre of mass, m
  Matrix3 inertia = Matrix3::Identity();  ///< kg m^2; only its ratios matter

  AdaptiveNoiseSettings acceleration{.psd = 1e-13, .psd_least = 1e-14, .psd_most = 1e-11};          ///< m^2/s^3
  AdaptiveNoiseSettings angular_acceleration{.psd = 1e-11, .psd_least = 1e-13, .psd_most = 1e-10};  ///< rad^2/s^3
  double along_track_sigma = 1e-9;  ///< m/s^2, differential drag
  double along_track_time_s = 6000.0;
  double from_sun_sigma = 3e-8;  ///< m/s^2, differential radiation pressure in sunlight
  double from_sun_time_s = 86400.0;

  double correlated_share = 0.85;       ///< of a keypoint's variance: alike in images of the same view
  double shift_sigma_px = 0.8;          ///< of all keypoints together, each axis: likewise
  double stretch_sigma = 9e-3;          ///< of the target's apparent size: likewise
  double correlated_turn = 0.21;        ///< rad: of the target, after which a view is another one
  double longest_correlated_s = 120.0;  ///< for a target that hardly turns
  double lasting_stretch_sigma = 2e-3;  ///< of the target's apparent size, in all views
  double lasting_stretch_time_s = 3600.0;

  double gate = 9.21;             ///< of a keypoint's normalised innovation squared: 99 % of two degrees of freedom
  double most_noise_scale = 9.0;  ///< what keypoints' covariances may be raised by: for good, and as much for one image
  double most_refused_share = 0.6;  ///< of the keypoints; beyond it none is believed
  int least_keypoints = 3;
  double maneuver_sigma = 2e-6;           ///< m/s, each axis of a burn
  double maneuver_sigma_relative = 1e-3;  ///< of its size
};

/// Where the camera is and how it stands at an image.
struct CameraPlace {
  Matrix3 R_camera_eci = Matrix3::Identity();
  Vector3 origin_eci = Vector3::Zero();  ///< from the servicer's centre of mass, m
};

/// What came of a keypoint. Residuals measured minus predicted, px.
struct KeypointUpdate {
  bool is_usable = false;  ///< of the network's, and predicted in front of the camera
  bool accepted = false;
  Vector2 prefit = Vector2::Zero();
  Vector2 postfit = Vector2::Zero();
  double nis = 0.0;  ///< of it alone
};

/// What came of an image's keypoints.
struct PoseUpdate {
  bool accepted = false;
  int usable = 0;
  int used = 0;
  double nis = 0.0;          ///< of the accepted ones together: 2 * used on average
  double noise_scale = 1.0;  ///< keypoints' covariances were raised by
  std::array<KeypointUpdate, network::kKeypoints> keypoints{};

  [[nodiscard]] bool is_mostly_refused(double share) const { return usable > 0 && usable - used > share * usable; }
};

class PoseFilter {
 public:
  struct Roe {
    static constexpr int kSize = 6;  ///< dimensionless
  };
  struct Attitude {
    static constexpr int kSize = 3;  ///< rad: R_eci_body = R_reference exp(turn)
  };
  struct Rate {
    static constexpr int kSize = 3;  ///< rad/s, body axes
  };
  struct Pushes {
    static constexpr int kSize = 2;  ///< m/s^2: along track, away from the Sun
  };
  struct Common {
    static constexpr int kSize = 4;  ///< of all keypoints: shift (px, px), stretch and lasting stretch (shares)
  };
  struct KeypointError {
    static constexpr int kSize = 2 * network::kKeypoints;  ///< over its standard deviation: whitened, 1 at rest
  };
  using State = estimation::Layout<Roe, Attitude, Rate, Pushes, Common, KeypointError>;
  using Estimate = estimation::Estimate<State::kSize>;

  PoseFilter() = default;

  /// Replaces the settings and ends. kOutOfRange for an inertia no body has, or other settings without sense.
  Status configure(const PoseFilterSettings& settings);
  [[nodiscard]] const PoseFilterSettings& settings() const { return settings_; }

  /// Begins with ROE (dimensionless), an attitude, and their covariances (attitude: turn in body axes and rate).
  void begin(const Vector6& roe, const Matrix6& roe_covariance, const AttitudeState& attitude,
             const Matrix6& attitude_covariance);
  /// Attitude and rate anew; the orbit stays, what was learned of keypoints' errors goes.
  void set_attitude(const AttitudeState& attitude, const Matrix6& attitude_covariance);
  /// Widens what is believed of the place along track by `sigma_m`, where something spoke against it.
  void doubt_place(double sigma_m, double semi_major_axis_m);
  void reset() { started_ = false; }
  [[nodiscard]] bool started() const { return started_; }

  /// Moves on by `dt` seconds, at most 60; `servicer`: its state before. Resets itself where no orbit is left.
  void advance(const orbit::CartesianState& servicer, const Vector3& sun_eci, double dt);

  /// The servicer, at `servicer` before it, burns.
  void add_servicer_impulse(const orbit::CartesianState& servicer, const Vector3& dv_eci);

  /// Folds an image's keypoints in; the filter must stand at its time.
  const PoseUpdate& take(const pose::Keypoints& keypoints, const CameraPlace& camera,
                         const orbit::CartesianState& servicer);

  /// Folds in a position of the target from the servicer's centre of mass alone, m, ECI axes; no gate.
  void take_position(const Vector3& relative_eci, const Matrix3& covariance_m2, const orbit::CartesianState& servicer);

  [[nodiscard]] Vector6 roe() const { return estimate_.mean().head<6>(); }
  [[nodiscard]] Matrix6 roe_covariance() const { return estimate_.head_covariance<6>(); }
  [[nodiscard]] const AttitudeState& attitude() const { return attitude_; }
  /// Of the turn in body axes (rad) and the rate (rad/s).
  [[nodiscard]] Matrix6 attitude_covariance() const;
  /// 1 sigma of the worst axis of body axes, rad.
  [[nodiscard]] double attitude_sigma() const;
  [[nodiscard]] const Inertia& inertia() const { return inertia_; }
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  [[nodiscard]] const PoseUpdate& last_update() const { return update_; }
  /// How much larger keypoints' covariances are than they are told, by how all images so far fit.
  [[nodiscard]] double learned_noise_scale() const { return learned_scale_ > 1.0 ? learned_scale_ : 1.0; }
  [[nodiscard]] double acceleration_psd() const { return acceleration_noise_.psd(); }
  [[nodiscard]] double angular_acceleration_psd() const { return angular_noise_.psd(); }
  /// kNotReady before begin().
  [[nodiscard]] Result<orbit::CartesianState> target(const orbit::CartesianState& servicer) const;
  /// Covariance of the target's position from the servicer, ECI axes, m^2; zero where there is none.
  [[nodiscard]] Matrix3 position_covariance(const orbit::CartesianState& servicer) const;

 private:
  static constexpr int kRows = 2 * network::kKeypoints;
  static constexpr int kMoving = Roe::kSize + Attitude::kSize + Rate::kSize + Pushes::kSize;
  static constexpr int kSeen = Roe::kSize + Attitude::kSize;  ///< what a measurement depends on beside errors
  static constexpr std::size_t kSeenPoints = 2 * kSeen + 1;
  using Rows = Eigen::Matrix<double, kRows, 1>;
  using Square = Eigen::Matrix<double, kRows, kRows>;
  using Moving = Eigen::Matrix<double, kMoving, kMoving>;

  /// Too large for the stack.
  struct Workspace {
    std::array<Rows, kSeenPoints> values;
    Rows predicted;
    Rows residual;
    Eigen::Matrix<double, kRows, State::kSize> slope;
    Eigen::Matrix<double, kRows, State::kSize> slope_covariance;
    Square noise;
    Square innovation;
    Square lower;
  };

  void advance_orbit(const orbit::CartesianState& servicer, const Vector3& sun_eci, double dt, Moving& slope,
                     Moving& noise, Eigen::Matrix<double, kMoving, 1>& mean);
  void advance_attitude(const orbit::CartesianState& servicer, double dt, Moving& slope, Moving& noise,
                        Eigen::Matrix<double, kMoving, 1>& mean);
  void fade_errors(double dt);
  void rest_errors();
  void absorb_turn();

  bool predict_keypoints(const pose::Keypoints& keypoints, const CameraPlace& camera,
                         const orbit::CartesianState& servicer);
  void model_errors(const pose::Keypoints& keypoints, const Vector2& centre_px);
  void expect_innovations();
  void gate_keypoints();
  bool factorise(const Square& matrix, const std::array<int, kRows>& rows, int count);
  [[nodiscard]] double joint_nis(const std::array<int, kRows>& rows, int count);
  void fold_in(const pose::Keypoints& keypoints, double raised);
  void learn_scale(int count);
  void adapt(const std::array<int, kRows>& rows, int count, const CameraPlace& camera);

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
