#pragma once
// Source: bearings of a camera to an unresolved target among stars.

#include <array>
#include <optional>

#include "fsw/core/result.h"
#include "fsw/measurements/bearings/bearing_aiding.h"
#include "fsw/measurements/calibrated_camera.h"
#include "fsw/measurements/source.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/target_tracking/angles_only_tracking.h"
#include "fsw/vision/target_tracking/search_region.h"

namespace vbar::fsw::measurements {

// The telecommand of bearings, validated and converted to settings.

[[nodiscard]] bool is_valid(const angles_only_configuration& configuration);

/// kOutOfRange for an invalid telecommand, here and below.
Result<target_tracking::CameraSettings> camera_settings(const camera_configuration& camera,
                                                        const angles_only_configuration& angles_only);
Result<BearingSettings> bearing_settings(const angles_only_configuration& angles_only);

class BearingSource {
 public:
  /// Attitude of the servicer's body, by the stars of an image.
  struct StarAttitude {
    GpsTime time;
    Matrix3 R_eci_body = Matrix3::Identity();
  };
  static constexpr std::int32_t kUse = BearingAiding::kSource.bit;
  /// Takes the settings of the first camera that is configured for bearings. A change re-initialises the front end, not
  /// the filter.
  bool configure(const Configuration& configuration);
  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  void collect(Context& context, RecordFiler records);
  void process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] std::optional<GpsTime> pending_since(GpsTime now) const;
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }
  [[nodiscard]] GpsTime last_measurement() const { return aiding_.last_accepted(); }
  /// Whether the bearing of the last image was processed.
  [[nodiscard]] bool has_aided() const { return last_image_ && *last_image_ == aiding_.last_accepted(); }
  void watch(GpsTime now, filter::RelativeNavigationFilter& /*filter*/) { aiding_.check_age(now); }
  void explain_excess(double mean_nis, filter::RelativeNavigationFilter& filter) {
    aiding_.explain_excess(mean_nis, filter);
  }
  void stop(GpsTime now, filter::RelativeNavigationFilter& filter) {
    aiding_.stop(now, filter);
    search_ = {};
  }
  /// The pointing to the target, off it where a lost target is searched; in turn with that to the target on the orbit
  /// that the present one has replaced.
  [[nodiscard]] Pointing searched(const Pointing& to_target) const;
  /// Attitude by the image of the step, if enough of its stars were identified.
  [[nodiscard]] std::optional<StarAttitude> star_attitude() const;
  /// Telemetry of the image of the step, if there was one.
  void report(const Telemetry& telemetry) const;

 private:
  [[nodiscard]] target_tracking::ImagePriors priors_of(const Context& context, const Vector3& sun_eci,
                                                       const filter::RelativeNavigationFilter& filter);
  void note_search(const target_tracking::ImagePriors& priors, const filter::RelativeNavigationFilter& filter);
  void report_image(const Telemetry& telemetry) const;
  void report_objects(const Telemetry& telemetry) const;

  std::size_t camera_ = 0;                 ///< unit
  std::optional<TwoExposures> exposures_;  ///< if it takes images for keypoints too
  target_tracking::AnglesOnlyTracking tracking_;
  BearingAiding aiding_;
  target_tracking::SearchRegion search_;
  std::array<target_tracking::OwnBurn, filter::RelativeNavigationFilter::kMaxImpulses> burns_since_image_{};
  std::optional<Vector3> kept_direction_rtn_;  ///< to the target on the orbit that was replaced
  int images_with_kept_ = 0;
  std::optional<GpsTime> last_image_;
  bool has_image_ = false;
  BearingEditStatus edit_status_ = BearingEditStatus::kNone;
  std::int32_t images_without_stars_ = 0;
  Vector6 a_roe_m_ = Vector6::Zero();  ///< of the filter at the image, after its update, for telemetry
  Matrix6 a_roe_covariance_m2_ = Matrix6::Zero();
};

}  // namespace vbar::fsw::measurements
