#pragma once
// Which forces act on the spacecraft of a run, beside the Earth's gravity field: the switches of a mission file.

#include "host_sim/truth/atmosphere/solar_indices.h"

namespace vbar::truth {

/// The Earth's shadow: none, a cylinder with a sharp edge, or penumbra and umbra of a Sun with a disk.
enum class Shadow { kNone, kCylindrical, kConical };

struct ForceModel {
  bool drag = false;
  GeomagneticIndex geomagnetic_index = GeomagneticIndex::kDaily;
  bool radiation_pressure = false;
  Shadow shadow = Shadow::kCylindrical;
  bool sun = false;
  bool moon = false;
  bool solid_tides = false;
  bool relativity = false;
};

}  // namespace vbar::truth
