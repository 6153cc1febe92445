#pragma once
// Light of an image in the laboratory: lamp as the Sun, boxes as the Earth.

#include <array>
#include <cstdint>

#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/imaging/devices.h"
#include "hil_drivers/tron/lights/box_light.h"
#include "hil_drivers/tron/lights/photometry.h"

namespace vbar::tron {

// Values of 16 bits for the lights of the testbed: lamp power, lamp place, boxes 1 to 10.

using LightValues = std::array<std::uint16_t, 2 + kBoxes>;

/// Limits powers to those that a source can give, azimuths to the lamp's arc. A number that is not finite gives
/// zero.
[[nodiscard]] LightValues light_values(const LightLevels& levels, const Lamp& lamp, const PhotometricTable& table);

/// Returns the factor by which an exposure is longer in the laboratory than in orbit.
[[nodiscard]] inline double exposure_factor(const Lamp& lamp) {
  return 1.0 / lamp.irradiance_ratio;
}

class RoomLight final : public LightPlanner {
 public:
  RoomLight(const TestbedDesign& bench, const Calibration& calibration, const PhotometricTable& table);

  /// Returns levels at which the lamp shines as bright as the visible part of the Sun, at its azimuth of `place`; the
  /// boxes as the Earth.
  [[nodiscard]] LightLevels levels(const Scene& scene, const Place& place) override;

 private:
  const Calibration& calibration_;
  BoxLight boxes_;
  fsw::Vector3 centre_T_;  ///< middle of the target
};

}  // namespace vbar::tron
