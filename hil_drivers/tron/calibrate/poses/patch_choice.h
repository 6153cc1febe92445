#pragma once
// Postures at which the sources of light shine on the white patch of the board and the camera sees it.

#include <array>
#include <cstdint>
#include <vector>

#include "hil_drivers/tron/calibrate/poses/pose_choice.h"
#include "hil_drivers/tron/lights/photometric_table.h"

namespace vbar::tron::calibrate {

struct PatchPosture {
  Posture posture;
  /// Names the sources (photometric_table.h) to be measured here, and the irradiance of the patch by them at full power
  /// as designed, to that of the lamp on an area that faces it.
  struct Light {
    std::size_t source = 0;
    double irradiance = 0.0;
  };
  std::vector<Light> lights;
};

/// One flag a source.
using SourceFlags = std::array<bool, kLightSources>;

/// Chooses postures for all sources but those of `measured`, while the lamp stands at `lamp_azimuth_rad`; throws
/// std::runtime_error that names those for which no posture was found.
[[nodiscard]] std::vector<PatchPosture> choose_patch_postures(const BenchFile& bench, const LensCalibration& lens,
                                                              const BoardDesign& board, double lamp_azimuth_rad,
                                                              std::uint64_t seed, const PostureFilter& filter = {},
                                                              const SourceFlags& measured = {});

}  // namespace vbar::tron::calibrate
