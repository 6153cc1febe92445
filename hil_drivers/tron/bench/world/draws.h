#pragma once
// Errors drawn from named random streams: poses and waves.

#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Geometry>

#include "fsw/core/types.h"

namespace vbar::tron::bench {

/// Returns a small pose: rotation vector and translation, each component normal. The same stream with other sizes gives
/// the same error, scaled.
[[nodiscard]] Eigen::Isometry3d drawn_pose(std::uint64_t seed, const std::string& stream, double rotation_deg,
                                           double translation_mm);

/// Describes a random function of place of zero mean: two sinusoids of random wavelength.
class Wave {
 public:
  /// Draws the function. `sigma`: standard deviation at any place, over emulators.
  Wave(std::uint64_t seed, const std::string& stream, double sigma, double wavelength_low, double wavelength_high);
  [[nodiscard]] double at(double place) const;

 private:
  struct Part {
    double wavenumber = 0.0, sine = 0.0, cosine = 0.0;
  };
  std::array<Part, 2> parts_;
};

}  // namespace vbar::tron::bench
