#pragma once
// Errors that no lens model expresses: a smooth field of direction errors over the display, and a smooth unevenness of
// its light. Both are sums of plane waves, tabulated on a grid that a cubic spline interpolates.

#include <cstdint>
#include <vector>

namespace vbar::optical_stimulator::bench {

struct FieldSettings {
  int waves = 60;
  double wave_length_px = 300.0;   ///< reciprocal of one sigma of a wave number (rad/px), a component
  double direction_arcsec = 15.0;  ///< rms of the direction, an axis
  double light = 0.05;             ///< rms of the light, relative; its waves are as long as the display is wide
};

/// Holds the errors at one place of the display.
struct FieldError {
  double x = 0.0, y = 0.0;  ///< rad
  double light = 0.0;       ///< relative
};

class ErrorField {
 public:
  /// Draws the field of a display of `width` times `height` pixels.
  ErrorField(const FieldSettings& settings, std::uint64_t seed, int width, int height);

  /// Returns the errors at a display pixel; beyond the display the field continues for a few pixels.
  [[nodiscard]] FieldError at(double u, double v) const;

  static constexpr int kStep_px = 16;

 private:
  int columns_, rows_;
  std::vector<FieldError> nodes_;  ///< the first is at (-2, -2) steps
};

}  // namespace vbar::optical_stimulator::bench
