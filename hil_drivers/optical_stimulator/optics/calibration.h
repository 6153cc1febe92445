#pragma once
// Result of a calibration of the Optical Stimulator: vbar_os_calibrate writes the file, and the driver reads it.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/optics/display_map.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::optical_stimulator {

/// Holds a fitted figure and its standard deviation.
struct Figure {
  double value = 0.0;
  double sigma = 0.0;
};

/// States where and with which devices the calibration was made. With another magnification, display or camera it is
/// invalid.
struct Validity {
  std::string date_utc;   ///< ISO 8601
  bool emulated = false;  ///< the camera names itself an emulator in its manufacturer-info register
  std::string camera_vendor, camera_model, camera_serial;
  double rail_lens_mm = 0.0;     ///< position of the axis of lens 2: the magnification
  double rail_display_mm = 0.0;  ///< position of the axis of the display: the focus
  int display_width_px = 1920, display_height_px = 1200;
  double display_rate_hz = 60.0;
  twins::camera::Region region{710, 200, 500, 800};  ///< part of the detector to which the figures "region" refer
  double exposure_s = 0.2;                           ///< exposure of the flight's images
};

/// Holds the relative light of a full display pixel over the display, both lenses' vignetting included: bilinear
/// between the values at the nodes, constant beyond the outermost.
struct UniformityGrid {
  int columns = 0, rows = 0;
  fsw::Vector2 first_px{0.0, 0.0};  ///< display pixel of the first node
  fsw::Vector2 step_px{1.0, 1.0};
  std::vector<double> values;  ///< row by row, 1 on average over the nodes
  double sigma = 0.0;          ///< standard deviation of the value

  [[nodiscard]] double at(const fsw::Vector2& display_px) const;
};

/// Holds the light of one display pixel of count D in the camera, photo-electrons on its whole image per second of
/// exposure:
///   uniformity (full_pixel ((D - first_count)/(255 - first_count))^gamma + black_pixel), the power for D >
///   first_count.
struct CountsToLight {
  Figure full_pixel_electrons_per_s;
  Figure black_pixel_electrons_per_s;
  Figure gamma;
  Figure first_count;     ///< D0
  double residual = 0.0;  ///< rms relative difference of the measured dots from the curve

  /// Returns full_pixel / black_pixel.
  [[nodiscard]] double contrast() const { return full_pixel_electrons_per_s.value / black_pixel_electrons_per_s.value; }
  /// Returns the light by the formula above, without uniformity and black level.
  [[nodiscard]] double electrons_per_s(double count) const;
};

struct HotPixel {
  int x = 0, y = 0;  ///< pixel of the detector
  double electrons_per_s = 0.0;
};

struct CameraFigures {
  Figure offset_dn;
  Figure gain_dn_per_electron;
  Figure read_noise_electrons;
  Figure background_electrons_per_s;  ///< light of a camera pixel with the display black: black level and dark current
  Figure point_spread_sigma_px;  ///< image of a displayed point (counts of sigma 0.5 display pixels), camera pixels
  int bits = 12;
  std::vector<HotPixel> hot_pixels;
};

/// Holds the angle between where the map says a dot of the held-out set is seen and where the camera saw it, arcsec.
struct ResidualFigures {
  double mean_arcsec = 0.0, p95_arcsec = 0.0;
  int dots = 0;
};

struct HeldOutResiduals {
  ResidualFigures region, detector;                        ///< with the field terms
  ResidualFigures region_lens_terms, detector_lens_terms;  ///< figures of the lens terms alone
  bool goal_reached = false;                               ///< the goals of calibrate/procedure.h
};

struct StimulatorCalibration {
  Validity validity;
  DisplayMapParameters geometry;
  LensTerms lens_sigma;         ///< standard deviations of the lens terms
  double field_sigma_px = 0.0;  ///< rms over the display of the standard deviation of the field, display pixels
  CountsToLight light;
  UniformityGrid uniformity;
  CameraFigures camera;
  HeldOutResiduals held_out;
  double centroid_floor_px = 0.0;  ///< camera pixels, an axis: what the flight software is to add to a star's centroid

  /// Returns photo-electrons per second on the whole image of a display pixel with count 255, without the black level.
  [[nodiscard]] double full_pixel_electrons_per_s(const fsw::Vector2& display_px) const {
    return uniformity.at(display_px) * light.full_pixel_electrons_per_s.value;
  }
};

/// Throws a MissionError that names the file and the key if the file is missing, damaged or not a calibration.
[[nodiscard]] StimulatorCalibration load_calibration(const std::filesystem::path& file);
[[nodiscard]] StimulatorCalibration parse_calibration(std::string_view text, const std::string& file);

/// Returns TOML; the shortest decimal numbers that read back as the same bits.
[[nodiscard]] std::string toml_of(const StimulatorCalibration& calibration);
/// Replaces the file as a whole.
void save_calibration(const StimulatorCalibration& calibration, const std::filesystem::path& file);

}  // namespace vbar::optical_stimulator
