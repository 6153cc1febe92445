#pragma once
// Track as it really is: its scale, and the displacement and rotation of the carriage along it.

#include <cstdint>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench/world/draws.h"
#include "hil_drivers/tron/bench/world/error_sizes.h"
#include "hil_drivers/tron/bench_file/bench_file.h"

namespace vbar::tron::bench {

class TrueTrack {
 public:
  /// Draws the errors. `base`: of the arm with the carriage at 0.
  TrueTrack(const Track& design, const BasePose& base, const ErrorSizes& sizes, std::uint64_t seed);

  /// Returns the base of the arm with the carriage at the place that its encoder states, m along L x. It rotates about
  /// the plate by which the arm hangs.
  [[nodiscard]] Eigen::Isometry3d T_L_base(double encoder_m) const;

  /// Returns the deviation of the carriage from its encoder at standstill number `number`, m.
  [[nodiscard]] double repeatability_m(std::uint64_t number) const;

 private:
  Track design_;
  BasePose base_;
  double scale_, repeatability_m_;
  Wave sideways_m_, height_m_, roll_rad_, pitch_rad_, yaw_rad_;
  std::uint64_t seed_;
};

}  // namespace vbar::tron::bench
