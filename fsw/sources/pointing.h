#pragma once
// Pointing of a camera.

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::sources {

/// Commanded line of sight: a direction in the servicer's RTN with a constant rate.
struct Pointing {
  GpsTime time;
  Vector3 boresight_rtn = Vector3::Zero();       ///< unit vector
  Vector3 boresight_rate_rtn = Vector3::Zero();  ///< 1/s

  [[nodiscard]] Vector3 boresight_rtn_at(GpsTime at) const {
    return (boresight_rtn + seconds(at - time) * boresight_rate_rtn).normalized();
  }
};

/// To the centre of the target. kOutOfRange if the distance is zero.
Result<Pointing> pointing_at(GpsTime time, const orbit::CartesianState& servicer, const orbit::CartesianState& target);

/// Body axes of the servicer under a pointing command: z along the boresight, -y as close to the zenith as possible.
/// The platform follows the same convention.
Matrix3 R_body_eci_of(const Pointing& pointing, GpsTime time, const orbit::CartesianState& servicer);

}  // namespace vbar::fsw::sources
