#include "hil_drivers/tron/lights/light_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vbar::tron {
namespace {

std::uint16_t value_of(double share) {
  if (!(share > 0.0)) return 0;
  constexpr double kFull = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(std::lround(kFull * std::min(share, 1.0)));
}

}  // namespace

LightValues light_values(const LightLevels& levels, const Lamp& lamp, const PhotometricTable& table) {
  LightValues values{};
  values[0] = value_of(table.lamp().level(levels.lamp_power));
  const double arc_rad = lamp.azimuth_high_rad - lamp.azimuth_low_rad;
  if (arc_rad > 0.0) values[1] = value_of((levels.lamp_azimuth_rad - lamp.azimuth_low_rad) / arc_rad);
  for (std::size_t k = 0; k < kBoxes; ++k) values[2 + k] = value_of(table.box(k).level(levels.box_power[k]));
  return values;
}

}  // namespace vbar::tron
