#pragma once
// Attitude determination: the rotation that best maps known directions to measured ones (Wahba 1965), by Davenport's
// q-method (Wertz 1978, 12.2.2), its covariance and a test of the residuals (Shuster & Oh 1981):
//
//   R_camera_eci = argmin sum |d_camera,k - R d_eci,k|^2 / sigma_k^2.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/vision/imaging/components.h"

namespace vbar::fsw::stars {

// Input and result of star identification.

/// An object of the image, star or not.
struct ObservedStar {
  Vector3 direction_camera = Vector3::UnitZ();  ///< unit vector
  double sigma_rad = 0.0;                       ///< 1 sigma, each axis across it
  double magnitude = 0.0;                       ///< from its flux; accurate to a magnitude
};

/// Cone around the complete field of view, for the density of stars in it.
struct Field {
  Vector3 centre_camera = Vector3::UnitZ();
  double radius_rad = 0.0;
};

struct StarMatch {
  int object = 0;     ///< index in the observed objects
  int catalogue = 0;  ///< star of the catalogue
};

/// Attitude from identified stars.
struct AttitudeFix {
  Matrix3 R_camera_eci = Matrix3::Identity();
  Matrix3 covariance_camera = Matrix3::Zero();  ///< small rotation between estimated and true camera, rad^2
  double sigma_rad = 0.0;                       ///< 1 sigma of the boresight's direction, worst axis
  double sigma_roll_rad = 0.0;                  ///< 1 sigma about the boresight
  double chi_square = 0.0;                      ///< sum of squared residuals over their sigma
  double log_chance = 0.0;                      ///< ln of the expected number of such agreements by chance
  double magnitude_offset = 0.0;                ///< median of observed less catalogue magnitude
  int hypotheses = 0;                           ///< number of hypotheses tried up to this one
  int matches = 0;                              ///< number of valid elements of `match`
  std::array<StarMatch, imaging::kMaxObjects> match{};
};

/// One direction in two frames, unit vectors, and the 1-sigma error of the measured one, each axis across it, rad.
struct DirectionPair {
  Vector3 camera = Vector3::Zero();
  Vector3 eci = Vector3::Zero();
  double sigma = 0.0;
};

struct AttitudeEstimate {
  Matrix3 R_camera_eci = Matrix3::Identity();
  Matrix3 covariance_camera = Matrix3::Zero();  ///< small rotation between estimated and true camera, rad^2
  double chi_square = 0.0;                      ///< sum of squared residuals over their sigma
  int degrees_of_freedom = 0;                   ///< 2 a direction, less 3
};

/// Returns the best attitude. kInvalidArgument: fewer than two pairs or a sigma that is not positive; kNotFinite;
/// kSingular: directions (nearly) on one line, or no best rotation.
Result<AttitudeEstimate> determine_attitude(std::span<const DirectionPair> pairs);

/// Returns the value that a chi-square variable of `degrees` > 0 degrees of freedom exceeds once in 10,000 (Wilson &
/// Hilferty 1931).
double chi_square_limit(int degrees);

/// Best attitude without outliers. If the residuals are larger than the noise allows, the worst direction is removed
/// and the others are tried again, until they agree. Removed pairs are moved to the end of `pairs` (order and `tags`,
/// one per pair, alike); `kept` is the number left. Errors are those of determine_attitude and kDidNotConverge: a third
/// would have to be removed, or fewer than three are left.
struct RobustAttitude {
  AttitudeEstimate estimate;
  int kept = 0;
};
Result<RobustAttitude> determine_attitude_robustly(std::span<DirectionPair> pairs, std::span<int> tags);

}  // namespace vbar::fsw::stars
