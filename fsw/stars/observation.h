#pragma once
// Input and result of star identification.

#include <array>
#include <cstddef>

#include "fsw/core/types.h"
#include "fsw/imaging/detected_object.h"

namespace vbar::fsw::stars {

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

}  // namespace vbar::fsw::stars
