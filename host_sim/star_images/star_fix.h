#pragma once
// Attitude of a camera by one of its images, by the flight software's object detection and star identification, without
// an orbit and without a prediction.

#include <optional>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/components.h"
#include "fsw/vision/imaging/object_detector.h"
#include "host_sim/star_images/grey_image.h"

namespace vbar::star_images {

/// Objects of an image, brightest first, at most fsw::imaging::kMaxObjects.
struct ImageObjects {
  int width = 0;
  int height = 0;
  double background_dn = 0.0;
  double noise_dn = 0.0;
  std::vector<fsw::imaging::DetectedObject> objects;
};

/// Detects the objects of an image of any size in overlapping regions of the size that the flight software processes.
[[nodiscard]] ImageObjects detect_objects(const GreyImage& image, const fsw::imaging::DetectorSettings& settings);

/// A star and the object that is its image.
struct SeenStar {
  int hipparcos = 0;  ///< number in the catalogue; 0: has none
  fsw::Vector2 pixel = fsw::Vector2::Zero();
  double magnitude = 0.0;                             ///< V
  fsw::Vector3 direction_eci = fsw::Vector3::Zero();  ///< as the moving observer sees it, unit
  fsw::Vector2 residual_px = fsw::Vector2::Zero();    ///< measured less predicted by the attitude
};

struct StarFix {
  fsw::Matrix3 R_camera_eci = fsw::Matrix3::Identity();
  double sigma_rad = 0.0;       ///< of the boresight, worst axis
  double sigma_roll_rad = 0.0;  ///< about it
  double log_chance = 0.0;      ///< ln of the expected number of such agreements by chance
  std::vector<SeenStar> stars;
};

struct FixSettings {
  fsw::imaging::CameraModel camera;
  double centroid_floor_px = 0.3;  ///< error of centroid or lens beside the noise; patterns use objects to 15 arcsec
  fsw::Vector3 velocity_over_c_eci = fsw::Vector3::Zero();  ///< observer's, barycentric; zero: aberration is left out
};

/// Identifies the stars lost in space; nothing if no attitude agrees with the objects better than chance. Magnitudes
/// need no photometric calibration: the zero point is that at which the catalogue has, on a field of this size, as many
/// brighter stars as the image has objects.
[[nodiscard]] std::optional<StarFix> identify(const ImageObjects& image, const FixSettings& settings);

/// Root mean square of the distances between stars and objects, px.
[[nodiscard]] double residual_rms_px(const StarFix& fix);

// Calibration of a lens by identified stars: focal length and distortion, common to all images, and an attitude for
// each, by least squares of the stars' pixels.

struct LensCalibration {
  fsw::imaging::CameraModel camera;  ///< principal point as given: not observable beside a rotation and p1, p2
  double focal_length_sigma_px = 0.0;
  std::vector<double> distortion_sigma;  ///< of k1, k2, p1, p2
  std::vector<StarFix> fixes;            ///< attitudes and residuals with this lens
  double rms_px = 0.0;                   ///< of the stars used
  int stars = 0;                         ///< used
  int outliers = 0;                      ///< left out: beyond four times the root mean square
};

/// Fits from the identified stars of one or more images and their lens. Throws std::runtime_error for fewer than
/// kFewestStars, or if the least squares do not converge. k3 is held.
inline constexpr int kFewestStars = 20;
[[nodiscard]] LensCalibration calibrate_lens(const std::vector<StarFix>& fixes, const fsw::imaging::CameraModel& start);

}  // namespace vbar::star_images
