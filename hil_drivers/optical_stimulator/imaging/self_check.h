#pragma once
// Check before each run that the testbed is still the one that was calibrated. It shows dots at places that are not on
// the calibration's grid, black frames and a grey one, in a few seconds.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/imaging/image_exchange.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "hil_drivers/optical_stimulator/optics/display_map.h"
#include "hil_drivers/optical_stimulator/pictures/display_light.h"
#include "hil_drivers/optical_stimulator/pictures/scene_pictures.h"

namespace vbar::optical_stimulator {

// Centroid of a dot in an image.

struct Spot {
  fsw::Vector2 centre{0.0, 0.0};
  double dn = 0.0;  ///< sum of the window, above the background
};

/// Returns the centroid of the light near `near`, weighted by a Gaussian of `sigma_px` about the centroid itself
/// (Bertin's windowed positions: each step is twice the weighted mean offset, as the weight halves it). `dn`: rows of
/// `width` pixels. Empty if the window does not lie on the image, or holds less than `least_dn`.
[[nodiscard]] std::optional<Spot> windowed_centroid(std::span<const std::uint16_t> dn, int width,
                                                    const fsw::Vector2& near, double background_dn, double sigma_px,
                                                    double least_dn);

// Shift, rotation and scale of the display since its calibration, from dots.

/// Holds a dot: where the calibrated map says that light seen by the camera comes from, and where it came from. Display
/// px.
struct DotPair {
  fsw::Vector2 by_map{0.0, 0.0};
  fsw::Vector2 shown{0.0, 0.0};
};

struct FittedDay {
  DayCorrection correction;
  std::vector<double> residuals_px;  ///< distances that the correction leaves
};

/// Fits by least squares; `middle` is the display's, about which rotation and scale are. At least two dots at two
/// places.
[[nodiscard]] FittedDay fit_day(std::span<const DotPair> dots, const fsw::Vector2& middle);

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
  SelfCheck(const StimulatorCalibration& calibration, const twins::camera::CameraSettings& camera,
            const DisplayMap& map, const DisplayLight& light);

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

  const StimulatorCalibration& calibration_;
  const twins::camera::CameraSettings& camera_;
  const DisplayMap& map_;
  const DisplayLight& light_;
  std::vector<Dot> dots_;
};

}  // namespace vbar::optical_stimulator
