#pragma once
// Sun and Moon in the images of a camera: discs composed of point sources.

#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/object_view.h"

namespace vbar::twins::camera {

inline constexpr double kMoonRadiusM = 1.7374e6;  ///< mean

/// Draws a disc without limb darkening. `direction`: unit; `radius`: rad; the points lie on a square grid,
/// `points_across` of them over the disc.
void uniform_disc(const fsw::Vector3& direction, double radius, double photons_per_m2_s, int points_across,
                  std::vector<LightSample>& out);

/// Draws the Moon: surface brightness after Lommel and Seeliger (the full Moon has no limb darkening), total brightness
/// after Allen's phase law (Astrophysical Quantities 1976, section 66: V = -12.73 + 0.026 |a| + 4e-9 a^4, a in degrees,
/// at the mean distances), which holds to 160 deg. Sunlight at the Moon is that at the Earth. `moon`: from the camera,
/// m; `sun_direction`: from the Moon, unit; in the same axes.
void moon_disc(const fsw::Vector3& moon, const fsw::Vector3& sun_direction, double zero_magnitude_photons,
               int points_across, std::vector<LightSample>& out);

/// Returns V of the Moon at `distance_m`, at the phase angle Sun - Moon - observer (rad).
double moon_magnitude(double phase_angle, double distance_m);

}  // namespace vbar::twins::camera
