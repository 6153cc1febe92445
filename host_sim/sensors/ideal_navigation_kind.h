#pragma once
// kind = "navigation": states that need no estimating, true or recorded.

#include "fsw/core/gps_time.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

struct NavigationSensor : mission::SensorSettings {
  fsw::Duration period;
};

extern const SensorKind kIdealNavigation;

}  // namespace vbar::sensors
