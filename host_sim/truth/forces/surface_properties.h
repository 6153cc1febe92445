#pragma once
// A spacecraft for the forces on its surface: a sphere with a mass, an area and a coefficient (cannonball).

namespace vbar::truth {

struct SurfaceProperties {
  double mass_kg = 0.0;
  double drag_area_m2 = 0.0;
  double drag_coefficient = 0.0;
  double radiation_area_m2 = 0.0;
  double radiation_coefficient = 0.0;  ///< C_R: 1 absorbs all light, 2 reflects all light straight back
};

}  // namespace vbar::truth
