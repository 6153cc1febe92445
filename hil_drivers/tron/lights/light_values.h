#pragma once
// Values of 16 bits for the lights of the testbed: lamp power, lamp place, boxes 1 to 10.

#include <array>
#include <cstdint>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/exchange/devices.h"
#include "hil_drivers/tron/lights/photometric_table.h"

namespace vbar::tron {

using LightValues = std::array<std::uint16_t, 2 + kBoxes>;

/// Limits powers to those that a source can give, azimuths to the lamp's arc. A number that is not finite gives
/// zero.
[[nodiscard]] LightValues light_values(const LightLevels& levels, const Lamp& lamp, const PhotometricTable& table);

}  // namespace vbar::tron
