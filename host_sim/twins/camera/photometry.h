#pragma once
// Photometry: stars and the Sun in photons that a silicon detector counts.
//
// A photon here is one at the peak of the detector's response: a flux is the integral over 400 to 900 nm of photons
// times response relative to its peak, so one quantum efficiency (the peak's) converts every colour to electrons.
// Spectra are log-linear between the effective wavelengths of B, V, R and I.
//
// Flux of a star of magnitude 0 and no colour (A0 V): Bessell, Castelli, Plez 1998, table A2, in 1e-11 erg/(cm^2 s A):
// B 632, V 363.1, R 217.7, I 112.6; in photons/(cm^2 s A) 1394, 996, 702, 452. Over 400 to 900 nm that makes
// 3.9e10 photons/(m^2 s), of which the response leaves 3.1e10. Response: typical of front-illuminated silicon with
// micro-lenses, such as the Optical Stimulator's 5.86 um pixels: flat from 450 to 600 nm, a half at 760 nm, a sixth at
// 900 nm. Colours V-R and V-I follow from B-V as for ordinary stars (after Bessell 1979, 1990; rounded).

namespace vbar::twins::camera {

/// Magnitude V of the Sun at 1 au (IAU 2015: V = -26.74 +- 0.02 on several authors' scales).
inline constexpr double kSunMagnitude = -26.74;
inline constexpr double kSunColour = 0.653;                  ///< B-V; Ramirez et al. 2012
inline constexpr double kAstronomicalUnit = 1.495978707e11;  ///< m, IAU 2012

/// Returns the photons/(m^2 s) of a star of V = 0 and B-V = 0, from the spectrum above.
/// CameraSettings::zero_magnitude_photons is this, rounded.
double zero_magnitude_photons_from_spectrum();

/// Returns the photons of a star of colour B-V against those of one of B-V = 0 and the same V; colours beyond -0.3 and
/// 1.7 count as these.
double colour_factor(double b_v);

/// Returns the photons/(m^2 s) of a star of magnitude `v` and colour `b_v`.
double star_photons(double zero_magnitude_photons, double v, double b_v);

/// Returns the photons/(m^2 s) of the Sun at `distance_m`.
double sun_photons(double zero_magnitude_photons, double distance_m);

}  // namespace vbar::twins::camera
