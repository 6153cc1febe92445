#pragma once
// A camera: optics and detector. Defaults are the Optical Stimulator's (35 mm lens, data/cameras/optical_stimulator).

#include <array>
#include <cstdint>
#include <filesystem>

#include "fsw/core/types.h"

namespace vbar::twins::camera {

/// A rectangle of the detector, px.
struct Region {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const Region&, const Region&) = default;
};

struct OpticsSettings {
  double focal_length_mm = 35.0;
  double f_number = 1.9;
  double transmission = 0.9;                               ///< transmission of all glass together
  std::array<double, 2> principal_point_px{959.5, 599.5};  ///< an integer is the centre of a pixel
  std::array<double, 5> distortion{};                      ///< Brown-Conrady k1, k2, p1, p2, k3, as OpenCV orders them
  double point_spread_sigma_px = 0.8;                      ///< sigma of the Gaussian core, before the pixel's own width
  double halo_fraction = 0.01;  ///< share of a point's light in a wide second Gaussian (scatter in the lens)
  double halo_sigma_px = 4.0;
  double vignetting = 0.15;              ///< light lost in the corners of the detector, as the radius to the fourth
  double sun_exclusion_deg = 30.0;       ///< closer to the boresight the Sun illuminates the baffle: stray light
  double stray_light_electrons = 2.0e4;  ///< a pixel and second, with the Sun at the edge of the field
};

struct DetectorSettings {
  int width = 1920, height = 1200;
  double pixel_pitch_um = 5.86;
  double quantum_efficiency = 0.7;  ///< at the peak of the response; photometry.h
  double full_well_electrons = 32000.0;
  double gain_dn_per_electron = 0.125;
  int bits = 12;  ///< bits of a pixel on the link, 8 or 12
  double offset_dn = 64.0;
  double read_noise_electrons = 7.0;
  double dark_electrons_per_s = 5.0;            ///< a pixel
  double dark_nonuniformity = 0.1;              ///< 1 sigma, relative, fixed pattern
  double photo_response_nonuniformity = 0.005;  ///< 1 sigma, relative, fixed pattern
  int hot_pixels = 20;                          ///< on the region that is read; places and sizes from the seed
  double hot_pixel_electrons_per_s = 20000.0;   ///< mean of an exponential distribution
  double blooming_fraction =
      0.02;  ///< share of the charge beyond the full well that spills to the neighbours; the rest is drained
};

struct CameraSettings {
  OpticsSettings optics;
  DetectorSettings detector;
  Region region{710, 200, 500, 800};  ///< that is read and crosses the link
  double exposure_s = 0.2;
  double zero_magnitude_photons =
      3.1e10;  ///< flux of a star of V = 0, B-V = 0 outside the atmosphere, 1/(m^2 s); photometry.h
  std::filesystem::path star_catalogue_file{"stars/hipparcos_v8.csv"};  ///< relative to the data folder; star_sky.h

  [[nodiscard]] double focal_length_px() const { return 1e3 * optics.focal_length_mm / detector.pixel_pitch_um; }
  /// Area of the entrance pupil, m^2.
  [[nodiscard]] double aperture_m2() const {
    const double radius_m = 0.5e-3 * optics.focal_length_mm / optics.f_number;
    return 3.14159265358979323846 * radius_m * radius_m;
  }
  /// Returns the photo-electrons on the detector per photon/m^2 at the lens, on axis.
  [[nodiscard]] double electrons_per_photon_m2() const {
    return aperture_m2() * optics.transmission * detector.quantum_efficiency;
  }
};

// Binning: the charges of b x b neighbouring pixels summed into one before they are read as a number.

/// Returns the camera whose pixels are the sums, from `single`, the camera with single pixels; `binning` is 1 or more.
/// Lengths in pixels and the detector's sides shrink (a fraction of a pixel at the right and lower edge is lost), an
/// integer stays the centre of a pixel. Full well, dark current and stray light of a sum are b^2 those of a pixel; read
/// noise, b^2 readings added, is b times one, and a relative non-uniformity 1/b. The gain is reduced such that a full
/// sum reads what a full pixel did, and the region covers the same part of the detector. Hot pixels stay as many and as
/// hot, one to a sum.
[[nodiscard]] CameraSettings binned(const CameraSettings& single, int binning);

}  // namespace vbar::twins::camera
