#pragma once
// Inputs of target tracking at an image: the objects that are not identified stars, and the servicer's own burns.

#include <cstddef>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/imaging/detected_object.h"

namespace vbar::fsw::tracking {

inline constexpr std::size_t kMaxCandidates = imaging::kMaxObjects;

/// An object of the image that is not an identified star.
struct Candidate {
  Vector3 direction_rtn = Vector3::UnitX();  ///< unit vector from the servicer, in its RTN at the image's time
  double sigma = 0.0;                        ///< rad, 1 sigma of the direction, each axis: centroid and attitude
  imaging::DetectedObject object;            ///< for brightness and for learning hot pixels
};

/// An impulse of the servicer.
struct OwnBurn {
  GpsTime time;
  Vector3 dv_rtn = Vector3::Zero();  ///< m/s, servicer's RTN at its time
  double sigma = 0.0;                ///< m/s, 1 sigma per axis
};

}  // namespace vbar::fsw::tracking
