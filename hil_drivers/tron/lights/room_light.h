#pragma once
// Light of an image in the laboratory: lamp as the Sun, boxes as the Earth.

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/calibration_file/calibration.h"
#include "hil_drivers/tron/exchange/devices.h"
#include "hil_drivers/tron/lights/box_light.h"
#include "hil_drivers/tron/lights/photometric_table.h"

namespace vbar::tron {

/// Returns the factor by which an exposure is longer in the laboratory than in orbit.
[[nodiscard]] inline double exposure_factor(const Lamp& lamp) {
  return 1.0 / lamp.irradiance_ratio;
}

class RoomLight final : public LightPlanner {
 public:
  RoomLight(const BenchFile& bench, const Calibration& calibration, const PhotometricTable& table);

  /// Returns levels at which the lamp shines as bright as the visible part of the Sun, at its azimuth of `place`; the
  /// boxes as the Earth.
  [[nodiscard]] LightLevels levels(const Scene& scene, const Place& place) override;

 private:
  const Calibration& calibration_;
  BoxLight boxes_;
  fsw::Vector3 centre_T_;  ///< middle of the target
};

}  // namespace vbar::tron
