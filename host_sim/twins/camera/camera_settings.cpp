#include "host_sim/twins/camera/camera_settings.h"

#include <algorithm>

namespace vbar::twins::camera {
namespace {

void bin(OpticsSettings& optics, double b) {
  for (double& c : optics.principal_point_px) c = (c + 0.5) / b - 0.5;
  optics.point_spread_sigma_px /= b;
  optics.halo_sigma_px /= b;
  optics.stray_light_electrons *= b * b;
}

void bin(DetectorSettings& detector, int binning) {
  const double b = binning;
  detector.width /= binning;
  detector.height /= binning;
  detector.pixel_pitch_um *= b;
  detector.full_well_electrons *= b * b;
  detector.gain_dn_per_electron /= b * b;
  detector.read_noise_electrons *= b;
  detector.dark_electrons_per_s *= b * b;
  detector.dark_nonuniformity /= b;
  detector.photo_response_nonuniformity /= b;
}

}  // namespace

CameraSettings binned(const CameraSettings& single, int binning) {
  if (binning <= 1) return single;
  CameraSettings sums = single;
  bin(sums.optics, binning);
  bin(sums.detector, binning);
  const Region& region = single.region;
  sums.region.x = region.x / binning;
  sums.region.y = region.y / binning;
  sums.region.width = std::max(1, std::min(region.width / binning, sums.detector.width - sums.region.x));
  sums.region.height = std::max(1, std::min(region.height / binning, sums.detector.height - sums.region.y));
  return sums;
}

}  // namespace vbar::twins::camera
