#pragma once
// Which forces act on the spacecraft of a run, beside the Earth's gravity field: the switches of a mission file.

#include "host_sim/truth/earth/space_weather.h"

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

// A spacecraft for the forces on its surface: a sphere with a mass, an area and a coefficient (cannonball).

struct SurfaceProperties {
  double mass_kg = 0.0;
  double drag_area_m2 = 0.0;
  double drag_coefficient = 0.0;
  double radiation_area_m2 = 0.0;
  double radiation_coefficient = 0.0;  ///< C_R: 1 absorbs all light, 2 reflects all light straight back
};

}  // namespace vbar::truth
