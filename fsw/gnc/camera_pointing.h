#pragma once
// Where a camera looks, and where the servicer was at an image's time.

#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/navigation/burn.h"
#include "fsw/navigation/gnss_navigation.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::gnc {

/// Where the camera shall look: a direction in the servicer's RTN that moves on a straight line.
struct Pointing {
  GpsTime time;
  Vector3 boresight_rtn = Vector3::Zero();       ///< unit vector
  Vector3 boresight_rate_rtn = Vector3::Zero();  ///< 1/s

  [[nodiscard]] Vector3 boresight_rtn_at(GpsTime at) const {
    return (boresight_rtn + seconds(at - time) * boresight_rate_rtn).normalized();
  }
};

/// To the centre of the target. kOutOfRange if there is no distance between them.
Result<Pointing> pointing_at(GpsTime time, const orbit::CartesianState& servicer, const orbit::CartesianState& target);

/// Axes of the servicer's body under a pointing command, as the platform keeps them: z along the boresight, -y as near
/// to the zenith as that allows.
Matrix3 R_body_eci_of(const Pointing& pointing, GpsTime time, const orbit::CartesianState& servicer);

/// The servicer at `time` by its own receiver, through the burns on the way; one at the very time is after it. None if
/// the receiver has not got so far yet, or is ahead of it.
std::optional<orbit::CartesianState> servicer_at(GpsTime time, const navigation::GnssNavigation& own_orbit,
                                                 std::span<const navigation::Burn> burns);

}  // namespace vbar::fsw::gnc
