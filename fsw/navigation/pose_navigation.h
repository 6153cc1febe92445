#pragma once
// Navigation at close range with a camera that sees the target's shape, and the servicer's own GNSS receiver: keeps the
// servicer's orbit smooth, begins with poses that single images gave, and follows the target's orbit and attitude with
// a filter on its keypoints.
//
// Everything comes in order of time. A burn at an instant counts as after it.

#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/navigation/burn.h"
#include "fsw/navigation/own_orbit.h"
#include "fsw/navigation/pose_filter.h"
#include "fsw/navigation/pose_start.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/pose/pnp.h"

namespace vbar::fsw::navigation {

/// Where the target is known beforehand to be, from whatever navigated before.
struct PoseApriori {
  GpsTime time;
  Vector6 a_roe_m = Vector6::Zero();        ///< mean a * ROE
  Vector6 sigma_a_roe_m = Vector6::Zero();  ///< 1 sigma
};

struct PoseSettings {
  OwnOrbitSettings own_orbit;
  PoseFilterSettings filter;
  PoseStartSettings start;
  std::optional<PoseApriori> apriori;  ///< none: the first images say it all
  orbit::EarthOrientation earth;
  Vector3 camera_position_camera_m = Vector3::Zero();  ///< from the servicer's centre of mass, camera axes
  /// Beside what `start` asks: poses of fewer keypoints count there only if they are so sure of their attitude, rad.
  int start_inliers = 8;
  double start_attitude_sigma = 0.05;
  double pose_range_share = 0.1;  ///< 1 sigma of a single pose's distance: one with a wrong attitude is so far off
  /// 1 sigma, rad: an attitude more in doubt is not mended by keypoints but taken anew.
  double widest_attitude = 0.35;
  double position_gate = 25.0;  ///< of the normalised distance squared of a single image's position from the filter's
};

struct PoseCounters {
  std::int32_t images_used = 0;  ///< their keypoints
  std::int32_t images_refused = 0;
  std::int32_t keypoints_used = 0;
  std::int32_t keypoints_refused = 0;
  std::int32_t positions_used = 0;   ///< of single images, while the attitude was in doubt
  std::int32_t attitudes_reset = 0;  ///< taken anew from single images
  std::int32_t restarts = 0;         ///< of the whole filter, after it had begun
};

/// What is known at an image's time, or between images.
struct PoseEpoch {
  GpsTime time;
  std::optional<orbit::CartesianState> servicer_gnss;  ///< a metre or two, of the time
  Vector3 sun_eci = Vector3::Zero();                   ///< unit vector
  std::optional<Matrix3> R_camera_eci;                 ///< at the image
  const pose::Keypoints* keypoints = nullptr;          ///< none: no image, or none that shows the target
  std::optional<pose::PnpSolution> pnp;                ///< of the same keypoints
};

/// What became of its image.
enum class PoseFate : std::uint8_t {
  kNone,      ///< nothing to use
  kRefused,   ///< does not fit
  kFilter,    ///< keypoints folded in
  kPosition,  ///< only its position: the attitude is in doubt
  kStart,     ///< kept for a start
};

class PoseNavigation {
 public:
  PoseNavigation() = default;

  /// Replaces the settings and starts anew. As PoseFilter::configure().
  Status configure(const PoseSettings& settings);

  /// Moves to an epoch and folds in what it brings. `burns`: the servicer's from the last epoch on, in order of time.
  /// An epoch before the last is ignored; one at the same time is not.
  PoseFate update(const PoseEpoch& epoch, std::span<const Burn> burns);

  /// The target is not where it is expected to be: what is known of it is given up, and the filter starts anew.
  void lose_target();

  /// Whether the filter runs.
  [[nodiscard]] bool valid() const { return own_orbit_.started() && filter_.started(); }
  /// Whether its attitude is known, too: not after a long time in the dark.
  [[nodiscard]] bool has_attitude() const { return valid() && filter_.attitude_sigma() <= settings_.widest_attitude; }
  [[nodiscard]] GpsTime epoch() const { return epoch_; }
  [[nodiscard]] GpsTime last_measurement() const { return last_measurement_; }  ///< folded in
  [[nodiscard]] orbit::CartesianState servicer() const { return own_orbit_.state(); }
  /// kNotReady unless valid().
  [[nodiscard]] Result<orbit::CartesianState> target() const;

  /// Osculating a * ROE, m, and its covariance, m^2; a: the servicer's. Zero unless valid().
  [[nodiscard]] Vector6 a_roe_m() const;
  [[nodiscard]] Matrix6 a_roe_covariance_m2() const;
  /// Covariance of the target's state in the servicer's RTN (velocity as seen in the turning frame), m and m/s.
  [[nodiscard]] Matrix6 covariance_rtn() const;

  /// Of the target. Only with valid(); attitude_covariance(): turn in body axes (rad) and rate (rad/s).
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
  PoseFate begin();
  void begin_apriori();
  PoseFate take_keypoints(const PoseEpoch& epoch, const CameraPlace& camera);
  PoseFate take_position_only(const PoseEpoch& epoch, const CameraPlace& camera);
  bool renew_attitude();
  void doubt_place();
  [[nodiscard]] bool is_fit_for_start(const PoseEpoch& epoch) const;
  [[nodiscard]] bool is_far_from_filter(const PoseSample& sample) const;
  [[nodiscard]] PoseSample sample_of(const PoseEpoch& epoch, const CameraPlace& camera) const;
  void count_refusal(bool is_position_far);
  void restart();

  PoseSettings settings_;
  GpsTime epoch_;
  OwnOrbit own_orbit_;
  PoseFilter filter_;
  PoseStart start_;
  GpsTime last_measurement_;
  bool has_sample_ = false;  ///< of the image at hand, for a start
  int refused_in_a_row_ = 0;
  int far_in_a_row_ = 0;
  PoseUpdate last_update_;
  PoseCounters counters_;
};

}  // namespace vbar::fsw::navigation
