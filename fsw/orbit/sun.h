#pragma once
#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
namespace vbar::fsw::orbit {
Vector3 sun_direction_eci(GpsTime time);
Vector3 earth_velocity_eci(GpsTime time);
}
