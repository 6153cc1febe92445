#pragma once
// Two thin lenses on the axis of a camera, and a display behind them.

namespace vbar::optical_stimulator::bench {

/// Describes two lenses: lens 1 is next to the camera; lens 2 stands `separation_mm` behind it, the display behind
/// lens 2.
struct LensPair {
  double f1_mm = 100.0;
  double f2_mm = 80.0;
  double separation_mm = 40.0;

  [[nodiscard]] constexpr double focal_length_mm() const { return f1_mm * f2_mm / (f1_mm + f2_mm - separation_mm); }
  /// Returns the distance of the display behind lens 2 at which its light leaves lens 1 parallel.
  [[nodiscard]] constexpr double infinity_mm() const {
    return f2_mm * (f1_mm - separation_mm) / (f1_mm + f2_mm - separation_mm);
  }
};

}  // namespace vbar::optical_stimulator::bench
