#pragma once
// Result of one image: attitude of the camera, the object identified as the target, and the classes of the others.

#include <array>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/imaging/detected_object.h"
#include "fsw/navigation/bearing.h"

namespace vbar::fsw::angles_only {

/// Why an image yielded no bearing; numbers of telemetry_image.status.
enum class SightingStatus : std::int8_t {
  kBearing = 0,       ///< a bearing was obtained
  kWrongFrame = 1,    ///< size, origin or depth of the image differ from the configured camera
  kBlank = 2,         ///< no light, or saturated
  kTooLittle = 3,     ///< most of it never arrived
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
  std::array<std::int32_t, imaging::kMaxObjects> hipparcos{};  ///< of identified stars
  int stars = 0;                                               ///< identified
  StarMethod star_method = StarMethod::kNone;
  Matrix3 R_camera_eci = Matrix3::Identity();  ///< by the stars, if there is a method
  double attitude_sigma = 0.0;                 ///< rad, of the boresight's direction
  int hypotheses = 0;
  int target = -1;                         ///< index of the object
  navigation::BearingMeasurement bearing;  ///< only with kBearing
};

}  // namespace vbar::fsw::angles_only
