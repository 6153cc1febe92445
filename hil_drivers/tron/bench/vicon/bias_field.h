#pragma once
// Random vector field of zero mean over places and directions: the bias of motion capture, the same whenever an
// object returns to a pose, and different elsewhere.

#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "fsw/core/types.h"

namespace vbar::tron::bench {

/// Sums plane waves of random phase, whose wave vectors are normal: its covariance falls with distance as a Gaussian
/// (Rahimi and Recht 2007, "Random features for large-scale kernel machines").
class BiasField {
 public:
  using Place = Eigen::Matrix<double, 9, 1>;

  /// Draws the field. `sigma`: standard deviation of each component. `length`: of the correlation along each component
  /// of a place; infinite: the field does not depend on it.
  BiasField(std::uint64_t seed, const std::string& stream, double sigma, const Place& length);

  [[nodiscard]] fsw::Vector3 at(const Place& place) const;

 private:
  static constexpr std::size_t kWaves = 48;  ///< number of waves of each component
  struct PlaneWave {
    Place wave_vector = Place::Zero();
    double phase = 0.0;
  };
  double amplitude_;
  std::array<std::array<PlaneWave, kWaves>, 3> waves_;
};

}  // namespace vbar::tron::bench
