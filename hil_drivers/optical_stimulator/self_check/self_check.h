#pragma once
// Check before each run that the testbed is still the one that was calibrated. It shows dots at places that are not on
// the calibration's grid, black frames and a grey one, in a few seconds.

#include <functional>
#include <string>
#include <vector>

#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"
#include "hil_drivers/optical_stimulator/counts/picture.h"
#include "hil_drivers/optical_stimulator/display_map/display_map.h"
#include "hil_drivers/optical_stimulator/exchange/exchange.h"
#include "hil_drivers/optical_stimulator/scene/calibrated_display.h"

namespace vbar::optical_stimulator {

// Limits for acceptance. The shift is 10 um of the display.
inline constexpr double kResidualLimit_arcsec = 3.0;
inline constexpr double kShiftLimit_px = 1.0;
inline constexpr double kScaleLimit_ppm = 200.0;
inline constexpr double kBrightnessLimit = 0.05;
inline constexpr double kNoiseLimit = 0.2, kOffsetLimit = 0.2;

struct SelfCheckFigures {
  int dots = 0;                  ///< found
  double residual_arcsec = 0.0;  ///< mean, after the correction
  DayCorrection correction;
  double brightness = 0.0;  ///< brightness of the grey frame, relative to the calibration
  double noise = 0.0;       ///< noise of black frames, relative to the calibration
  double offset = 0.0;      ///< offset of black frames, relative to the calibration
  int new_hot_pixels = 0;   ///< in the region of the image
};

/// Returns each figure that is beyond its limit, with the limit; empty: accepted.
[[nodiscard]] std::string complaint_of(const SelfCheckFigures& figures);

class SelfCheck {
 public:
  /// `camera`: calibrated; its region is that of the image.
  SelfCheck(const BenchCalibration& calibration, const twins::camera::CameraSettings& camera, const DisplayMap& map,
            const DisplayLight& light);

  /// Throws what the exchange throws.
  [[nodiscard]] SelfCheckFigures run(Exchange& exchange) const;

  static constexpr int kDots = 40;

 private:
  struct Dot {
    fsw::Vector2 camera_px, display_px;
  };

  using Image = std::vector<std::uint16_t>;

  void check_black(const Image& first, const Image& second, SelfCheckFigures& figures) const;
  void check_grey(const Image& image, SelfCheckFigures& figures) const;
  void check_dots(const std::vector<Image>& images, SelfCheckFigures& figures) const;
  [[nodiscard]] double black_dn() const;

  const BenchCalibration& calibration_;
  const twins::camera::CameraSettings& camera_;
  const DisplayMap& map_;
  const DisplayLight& light_;
  std::vector<Dot> dots_;
};

}  // namespace vbar::optical_stimulator
