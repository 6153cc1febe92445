#pragma once
// Light of the Earth on a surface near a spacecraft.

namespace vbar::twins::camera {

/// Returns the irradiance by the Earth of an area whose normal makes an angle of this cosine with the nadir, in units
/// of that of an area which faces it; `sine_earth`: sine of its half angle. A sphere of even radiance, horizon
/// included: Snyder (1996), "Area light sources for real-time graphics", in the form of Lagarde and de Rousiers (2014),
/// "Moving Frostbite to physically based rendering", listing 7.
[[nodiscard]] double earth_light_factor(double cosine, double sine_earth);

}  // namespace vbar::twins::camera
