#pragma once
// Result of one image: attitude of the camera, the object identified as the target, and the classes of the others.

#include <array>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/imaging/detected_object.h"
#include "fsw/navigation/bearing.h"

namespace vbar::fsw::angles_only {

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
  int target = -1;                         ///< index of the target's object
  navigation::BearingMeasurement bearing;  ///< only with kBearing
};

}  // namespace vbar::fsw::angles_only
