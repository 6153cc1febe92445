#include "host_sim/sensors/settings/camera_file.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fsw/vision/imaging/image.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::sensors {
namespace {

using mission::above_to;
using mission::from_to;
using mission::Range;
using mission::TableReader;

using twins::camera::CameraSettings;
using twins::camera::DetectorSettings;
using twins::camera::OpticsSettings;
using twins::camera::Region;

constexpr int kLargestDetector_px = 16384;

template <std::size_t size>
void read(const TableReader& section, std::string_view key, Range range, std::array<double, size>& values) {
  if (section.has(key)) std::ranges::copy(section.numbers(key, size, size, range), values.begin());
}

void read_optics(const TableReader& section, OpticsSettings& optics) {
  const Range share = from_to(0.0, 1.0);
  read(section, "focal_length_mm", above_to(0.0, 1e4), optics.focal_length_mm);
  read(section, "f_number", from_to(0.5, 100.0), optics.f_number);
  read(section, "transmission", above_to(0.0, 1.0), optics.transmission);
  read(section, "principal_point_px", from_to(-1e5, 1e5), optics.principal_point_px);
  read(section, "distortion", from_to(-10.0, 10.0), optics.distortion);
  read(section, "point_spread_sigma_px", from_to(0.2, 20.0), optics.point_spread_sigma_px);
  read(section, "halo_fraction", share, optics.halo_fraction);
  read(section, "halo_sigma_px", from_to(0.2, 100.0), optics.halo_sigma_px);
  read(section, "vignetting", share, optics.vignetting);
  read(section, "sun_exclusion_deg", from_to(0.0, 180.0), optics.sun_exclusion_deg);
  read(section, "stray_light_electrons", from_to(0.0, 1e9), optics.stray_light_electrons);
}

/// A gain is a sum's where there are sums, whatever the order of the keys.
void read_binning_and_gain(const TableReader& section, CameraFile& camera) {
  if (section.has("binning")) {
    camera.binning = static_cast<int>(section.integer("binning", 1, 4));
    if (camera.binning == 3) section.refuse_value("binning", "1, 2 or 4");
    camera.gain_dn_per_electron.reset();
    camera.region.reset();
  }
  const Range gain = above_to(0.0, 1e3);
  if (!section.has("gain_dn_per_electron")) return;
  if (camera.binning == 1)
    camera.single.detector.gain_dn_per_electron = section.number("gain_dn_per_electron", gain);
  else
    camera.gain_dn_per_electron = section.number("gain_dn_per_electron", gain);
}

void read_detector(const TableReader& section, DetectorSettings& detector) {
  const Range share = from_to(0.0, 1.0);
  read(section, "width", 1, kLargestDetector_px, detector.width);
  read(section, "height", 1, kLargestDetector_px, detector.height);
  read(section, "pixel_pitch_um", above_to(0.0, 1e3), detector.pixel_pitch_um);
  read(section, "quantum_efficiency", above_to(0.0, 1.0), detector.quantum_efficiency);
  read(section, "full_well_electrons", above_to(0.0, 1e7), detector.full_well_electrons);
  read(section, "bits", 8, 12, detector.bits);
  if (detector.bits != 8 && detector.bits != 12) section.refuse_value("bits", "8 or 12");
  read(section, "offset_dn", from_to(0.0, 4095.0), detector.offset_dn);
  read(section, "read_noise_electrons", from_to(0.0, 1e4), detector.read_noise_electrons);
  read(section, "dark_electrons_per_s", from_to(0.0, 1e6), detector.dark_electrons_per_s);
  read(section, "dark_nonuniformity", share, detector.dark_nonuniformity);
  read(section, "photo_response_nonuniformity", from_to(0.0, 0.2), detector.photo_response_nonuniformity);
  read(section, "hot_pixels", 0, 10000, detector.hot_pixels);
  read(section, "hot_pixel_electrons_per_s", from_to(0.0, 1e9), detector.hot_pixel_electrons_per_s);
  read(section, "blooming_fraction", share, detector.blooming_fraction);
}

Region read_region(const TableReader& section) {
  const std::vector<double> r = section.numbers("region_px", 4, 4, from_to(0.0, kLargestDetector_px));
  const Region region = {static_cast<int>(r[0]), static_cast<int>(r[1]), static_cast<int>(r[2]),
                         static_cast<int>(r[3])};
  if (!std::ranges::equal(
          r, std::array<double, 4>{1.0 * region.x, 1.0 * region.y, 1.0 * region.width, 1.0 * region.height}))
    section.refuse("region_px", "a number that is no integer", "whole pixels: [x, y, width, height]");
  return region;
}

void check_region(const TableReader& section, const DetectorSettings& detector, const Region& region) {
  if (region.width < 1 || region.height < 1 || region.x + region.width > detector.width ||
      region.y + region.height > detector.height)
    section.refuse("region_px", "a region that does not lie on the detector",
                   "[x, y, width, height] inside " + std::to_string(detector.width) + " x " +
                       std::to_string(detector.height) + " pixels");
  const auto pixels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
  if (pixels > fsw::imaging::kMaxPixels)
    section.refuse("region_px", std::to_string(pixels) + " pixels",
                   "at most the " + std::to_string(fsw::imaging::kMaxPixels) + " that the flight software holds");
}

/// The field across the width of the detector states the focal length.
void read_field_of_view(const TableReader& section, CameraSettings& camera) {
  if (!section.has("field_of_view_deg")) return;
  if (section.has("focal_length_mm"))
    section.refuse("field_of_view_deg", "both focal_length_mm and field_of_view_deg", "one of them");
  const double field_rad = section.number("field_of_view_deg", above_to(0.0, 120.0)) * M_PI / 180.0;
  const double width_mm = 1e-3 * camera.detector.width * camera.detector.pixel_pitch_um;
  camera.optics.focal_length_mm = 0.5 * width_mm / std::tan(0.5 * field_rad);
}

}  // namespace

CameraSettings CameraFile::settings() const {
  CameraSettings sums = twins::camera::binned(single, binning);
  if (gain_dn_per_electron) sums.detector.gain_dn_per_electron = *gain_dn_per_electron;
  if (region) sums.region = *region;
  return sums;
}

void read_camera_settings(const TableReader& section, CameraFile& camera) {
  CameraSettings& single = camera.single;
  read(section, "exposure_s", from_to(1e-5, 60.0), single.exposure_s);
  read(section, "zero_magnitude_photons", above_to(0.0, 1e15), single.zero_magnitude_photons);
  const TableReader optics = section.table("optics");
  read_optics(optics, single.optics);
  const TableReader detector = section.table("detector");
  read_detector(detector, single.detector);
  read_field_of_view(optics, single);
  read_binning_and_gain(detector, camera);
  const double brightest_dn = (1 << single.detector.bits) - 1;
  if (!(single.detector.offset_dn < 0.5 * brightest_dn))
    detector.refuse("offset_dn", "an offset that leaves no room for light",
                    "less than half of the largest number of `bits`");
  if (section.has("region_px")) {
    if (camera.binning == 1)
      single.region = read_region(section);
    else
      camera.region = read_region(section);
  }
  const CameraSettings sums = camera.settings();
  check_region(section, sums.detector, sums.region);
}

CameraFile load_camera(const std::filesystem::path& file) {
  const toml::table table = mission::parse_toml(mission::read_data_text(file, "a camera file (TOML)"), file.string());
  const TableReader document(table, file.string());
  CameraFile camera;
  read_camera_settings(document, camera);
  document.finish();
  return camera;
}

}  // namespace vbar::sensors
