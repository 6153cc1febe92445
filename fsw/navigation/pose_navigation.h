#pragma once
// Navigation at close range with a camera that resolves the target, and the servicer's own GNSS receiver: estimates a
// smooth orbit of the servicer, is initialised from single-image poses, and estimates the target's orbit and attitude
// by a filter on its keypoints.
//
// Epochs must be passed in order of time. A measurement at the time of a burn counts as after it.

#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/navigation/burn.h"
#include "fsw/navigation/own_orbit.h"
#include "fsw/navigation/pose_filter.h"
#include "fsw/navigation/pose_initialiser.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/pose/pnp.h"

namespace vbar::fsw::navigation {

/// A-priori relative orbit of the target, from preceding navigation.
struct PoseApriori {
  GpsTime time;
  Vector6 a_roe_m = Vector6::Zero();        ///< mean a * ROE
  Vector6 sigma_a_roe_m = Vector6::Zero();  ///< 1 sigma
};

struct PoseSettings {
  OwnOrbitSettings own_orbit;
  PoseFilterSettings filter;
  PoseInitialiserSettings start;
  std::optional<PoseApriori> apriori;  ///< empty: initialisation from images alone
  orbit::EarthOrientation earth;
  Vector3 camera_position_camera_m = Vector3::Zero();  ///< from the servicer's centre of mass, camera axes
  /// In addition to `start`: poses of fewer keypoints are used there only if their attitude is this accurate, rad.
  int start_inliers = 8;
  double start_attitude_sigma = 0.05;
  double pose_range_share = 0.1;  ///< 1 sigma of the range of a single-image pose, as for a wrong attitude
  /// 1 sigma, rad: an attitude less certain than this is not updated by keypoints but re-initialised.
  double widest_attitude = 0.35;
  double position_gate = 25.0;  ///< gate of the normalised squared distance of a single-image position
};

struct PoseCounters {
  std::int32_t images_used = 0;  ///< their keypoints
  std::int32_t images_refused = 0;
  std::int32_t keypoints_used = 0;
  std::int32_t keypoints_refused = 0;
  std::int32_t positions_used = 0;   ///< of single images, while the attitude was not confirmed
  std::int32_t attitudes_reset = 0;  ///< re-initialised from single images
  std::int32_t restarts = 0;         ///< of the complete filter, after initialisation
};

/// Inputs at the time of an image, or between images.
struct PoseEpoch {
  GpsTime time;
  std::optional<orbit::CartesianState> servicer_gnss;  ///< accurate to a metre or two, at the time
  Vector3 sun_eci = Vector3::Zero();                   ///< unit vector
  std::optional<Matrix3> R_camera_eci;                 ///< at the image
  const pose::Keypoints* keypoints = nullptr;          ///< null: no image, or no target detected in it
  std::optional<pose::PnpSolution> pnp;                ///< of the same keypoints
};

/// Edit status of the image.
enum class PoseEditStatus : std::uint8_t {
  kNone,      ///< no usable input
  kRefused,   ///< rejected by the gate
  kFilter,    ///< keypoints processed
  kPosition,  ///< only its position: the attitude is not confirmed
  kStart,     ///< kept for initialisation
};

class PoseNavigation {
 public:
  PoseNavigation() = default;

  /// Replaces the settings and restarts. As PoseFilter::configure().
  Status configure(const PoseSettings& settings);

  /// Propagates to an epoch and processes its inputs. `burns`: the servicer's from the last epoch on, in order of time.
  /// An epoch before the last is ignored; one at the same time is not.
  PoseEditStatus update(const PoseEpoch& epoch, std::span<const Burn> burns);

  /// The target is not at its expected position: the estimate is discarded, and the filter restarts.
  void lose_target();

  /// Whether the filter runs.
  [[nodiscard]] bool valid() const { return own_orbit_.started() && filter_.started(); }
  /// Whether its attitude is known as well: not after a long eclipse.
  [[nodiscard]] bool has_attitude() const { return valid() && filter_.attitude_sigma() <= settings_.widest_attitude; }
  [[nodiscard]] GpsTime epoch() const { return epoch_; }
  [[nodiscard]] GpsTime last_measurement() const { return last_measurement_; }  ///< processed
  [[nodiscard]] orbit::CartesianState servicer() const { return own_orbit_.state(); }
  /// kNotReady unless valid().
  [[nodiscard]] Result<orbit::CartesianState> target() const;

  /// Osculating a * ROE, m, and its covariance, m^2; a: the servicer's. Zero unless valid().
  [[nodiscard]] Vector6 a_roe_m() const;
  [[nodiscard]] Matrix6 a_roe_covariance_m2() const;
  /// Covariance of the target's state in the servicer's RTN (velocity as seen in the rotating frame), m and m/s.
  [[nodiscard]] Matrix6 covariance_rtn() const;

  /// Of the target. Only with valid(); attitude_covariance(): rotation in body axes (rad) and rate (rad/s).
  [[nodiscard]] Matrix3 R_eci_body() const { return filter_.attitude().q_eci_body.toRotationMatrix(); }
  [[nodiscard]] Vector3 rate_body() const { return filter_.attitude().rate_body; }
  [[nodiscard]] Matrix6 attitude_covariance() const { return filter_.attitude_covariance(); }

  /// Of the last epoch; empty if it had no keypoints for the filter.
  [[nodiscard]] const PoseUpdate& last_update() const { return last_update_; }
  [[nodiscard]] const PoseFilter& filter() const { return filter_; }
  [[nodiscard]] const PoseCounters& counters() const { return counters_; }
  [[nodiscard]] const PoseSettings& settings() const { return settings_; }

 private:
  void advance(GpsTime time, const Vector3& sun_eci, std::span<const Burn> burns);
  PoseEditStatus begin();
  void begin_apriori();
  PoseEditStatus take_keypoints(const PoseEpoch& epoch, const CameraPose& camera);
  PoseEditStatus take_position_only(const PoseEpoch& epoch, const CameraPose& camera);
  bool renew_attitude();
  void inflate_position();
  [[nodiscard]] bool is_fit_for_start(const PoseEpoch& epoch) const;
  [[nodiscard]] bool is_far_from_filter(const PoseSample& sample) const;
  [[nodiscard]] PoseSample sample_of(const PoseEpoch& epoch, const CameraPose& camera) const;
  void count_refusal(bool is_position_far);
  void restart();

  PoseSettings settings_;
  GpsTime epoch_;
  OwnOrbit own_orbit_;
  PoseFilter filter_;
  PoseInitialiser start_;
  GpsTime last_measurement_;
  bool has_sample_ = false;  ///< of the current image, for initialisation
  int refused_in_a_row_ = 0;
  int far_in_a_row_ = 0;
  PoseUpdate last_update_;
  PoseCounters counters_;
};

}  // namespace vbar::fsw::navigation
