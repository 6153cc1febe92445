#pragma once
// Angles-only tracking (Kruger, D'Amico 2021): from an image to a bearing. Objects are detected, stars among them
// identified and used for the attitude, and the tracker identifies the target among the others.
//
// The commanded pointing supports star identification; the position of the target in the image is never assumed.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/components.h"
#include "fsw/vision/imaging/image.h"
#include "fsw/vision/imaging/object_detector.h"
#include "fsw/vision/stars/star_identification.h"
#include "fsw/vision/target_tracking/bearing.h"
#include "fsw/vision/target_tracking/target_tracker.h"

namespace vbar::fsw::target_tracking {

// Result of one image: attitude of the camera, the object identified as the target, and the classes of the others.

/// Reason why an image yielded no bearing; numbers of telemetry_image.status.
enum class SightingStatus : std::int8_t {
  kBearing = 0,       ///< a bearing was obtained
  kWrongFrame = 1,    ///< size, origin or depth of the image differ from the configured camera
  kBlank = 2,         ///< no light, or saturated
  kTooLittle = 3,     ///< most of the image never arrived
  kNoStars = 4,       ///< the stars in it could not be identified: no attitude
  kNoTarget = 5,      ///< the track of the target has no certain object in it
  kNotConfirmed = 6,  ///< a target candidate, not yet confirmed
  kNoOrbit = 7,       ///< no orbit of servicer or target is known yet
  kSearching = 8,     ///< no track is identified as the target
  kAmbiguous = 9,     ///< two or more tracks may be the target
};

enum class StarMethod : std::int8_t { kNone = 0, kLostInSpace = 1, kPredicted = 2 };

/// Numbers of telemetry_objects.kind.
enum class ObjectKind : std::int8_t { kUnmatched = 0, kStar = 1, kTarget = 2, kHotPixel = 3 };

struct Sighting {
  SightingStatus status = SightingStatus::kNoOrbit;
  GpsTime time;  ///< middle of the exposure
  std::int32_t image = 0;
  int tiles_missing = 0;
  double background_dn = 0.0;
  double noise_dn = 0.0;  ///< 1 sigma of a pixel
  int objects = 0;
  std::array<ObjectKind, imaging::kMaxObjects> kind{};
  std::array<std::int32_t, imaging::kMaxObjects> hipparcos{};  ///< Hipparcos numbers of identified stars
  int stars = 0;                                               ///< number of identified stars
  StarMethod star_method = StarMethod::kNone;
  Matrix3 R_camera_eci = Matrix3::Identity();  ///< attitude by the stars, if the method is not kNone
  double attitude_sigma = 0.0;                 ///< 1 sigma of the boresight's direction, rad
  int hypotheses = 0;
  int target = -1;                              ///< index of the target's object
  bool is_as_kept = false;                      ///< the target moves as the replaced orbit predicts
  target_tracking::BearingMeasurement bearing;  ///< only with kBearing
};

/// The camera as calibrated on the ground, and its expected performance.
struct CameraSettings {
  imaging::ImageFrame frame;
  imaging::CameraModel model;
  imaging::DetectorSettings detector;
  double zero_magnitude_dn = 0.0;  ///< flux of a star of magnitude 0, all its pixels
  Matrix3 R_camera_body = Matrix3::Identity();
  Vector3 position_body_m = Vector3::Zero();
  double centroid_floor_px = 0.05;
  double pointing_tolerance = 3e-3;  ///< largest error of the commanded pointing, rad
};

/// A-priori information at the time of exposure.
struct ImagePriors {
  bool is_orbit_known = false;
  orbit::CartesianState servicer;
  Vector3 velocity_over_c_eci = Vector3::Zero();      ///< velocity of the camera, barycentric, for aberration
  std::optional<Matrix3> R_camera_eci;                ///< attitude as commanded
  std::optional<target_tracking::Prediction> target;  ///< motion predicted by navigation, as seen by the camera
  std::optional<target_tracking::Prediction> kept;    ///< the same of the orbit that the present one has replaced
  bool is_search = false;                             ///< the prediction was widened: the target was lost
  double detection_probability = 0.95;                ///< that of the target: smaller if it may be in eclipse
  std::span<const target_tracking::OwnBurn> burns;    ///< since the last image, in order of time
};

/// An image with the header of its tiles.
struct TakenImage {
  GpsTime time;  ///< middle of the exposure
  std::int32_t number = 0;
  int tiles_missing = 0;
  imaging::ImageView view;
};

class AnglesOnlyTracking {
 public:
  void configure(const CameraSettings& settings);

  /// Processes an image. Images must be passed in order of time.
  const Sighting& process(const TakenImage& image, const ImagePriors& priors);

  [[nodiscard]] const Sighting& sighting() const { return sighting_; }
  [[nodiscard]] std::span<const imaging::DetectedObject> objects() const { return detector_.objects(); }
  [[nodiscard]] const CameraSettings& settings() const { return settings_; }

 private:
  SightingStatus look(const TakenImage& image, const ImagePriors& priors);
  SightingStatus find_objects(const imaging::ImageView& image);
  bool identify_stars(const ImagePriors& priors);
  void mark_stars(const stars::AttitudeFix& fix);
  std::size_t collect_candidates(const ImagePriors& priors);
  SightingStatus find_target(const TakenImage& image, const ImagePriors& priors);
  void measure_bearing(std::size_t object);
  [[nodiscard]] double sigma_of(const imaging::DetectedObject& object) const;

  CameraSettings settings_;
  imaging::ObjectDetector detector_;
  stars::StarIdentifier identifier_;
  target_tracking::TargetTracker tracker_;
  stars::Field field_;
  std::size_t count_ = 0;                                         ///< number of objects that have a direction
  std::array<stars::ObservedStar, imaging::kMaxObjects> seen_{};  ///< the objects, not yet classified
  std::array<target_tracking::Candidate, imaging::kMaxObjects> candidates_{};  ///< those that are not stars
  std::array<std::size_t, imaging::kMaxObjects> object_of_candidate_{};
  Sighting sighting_;
};

}  // namespace vbar::fsw::target_tracking
