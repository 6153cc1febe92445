#pragma once

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::fsw::navigation {

/// A burn of the servicer, executed or commanded.
struct Burn {
  GpsTime time;
  Vector3 dv_rtn = Vector3::Zero();  ///< m/s, in its RTN before the burn
};

}  // namespace vbar::fsw::navigation
