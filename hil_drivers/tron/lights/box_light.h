#pragma once
// Powers of the light boxes with which they shine on the target as the Earth does.

#include <array>
#include <vector>

#include <Eigen/Core>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

// Least squares with bounds.

struct BoundedSolution {
  Eigen::VectorXd x;
  double residual_norm = 0.0;
  bool has_converged = false;
};

/// Minimises |A x - b| over 0 <= x <= 1: active set (Stark and Parker 1995, "Bounded-variable least squares: an
/// algorithm and applications"), on the triangular factor of A. A has at least as many rows as columns. A variable
/// whose column is zero stays 0. Throws std::invalid_argument for a number that is not finite.
[[nodiscard]] BoundedSolution bounded_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

// Directions spread evenly over the sphere.

/// Returns the 162 corners of an icosahedron whose edges are divided into four, on the unit sphere.
[[nodiscard]] const std::vector<fsw::Vector3>& sphere_normals();

/// Holds the light of the Earth at the target in laboratory axes.
struct EarthLight {
  fsw::Vector3 direction_L = fsw::Vector3::UnitZ();  ///< to its middle, unit
  double half_angle = 1.1;                           ///< angular radius of the disc, rad
  double ratio = 0.0;  ///< irradiance of an area that faces it, to that of one that faces the Sun
};

/// Irradiances on a sphere about the target: each element belongs to one of its 162 normals.
using NormalIrradiances = Eigen::VectorXd;

struct BoxPowers {
  std::array<double, kBoxes> power{};  ///< light, not the DMX value; 0 to 1
  double misfit = 0.0;                 ///< rms over the normals, relative to the largest irradiance of the Earth
};

class BoxLight {
 public:
  /// `full_light`: light of each box, relative to full power as designed.
  explicit BoxLight(const TestbedDesign& bench, const std::array<double, kBoxes>& full_light = all_full());

  /// Returns irradiances by box i at full power as designed, column i, to that of the lamp at full power. `centre_L`:
  /// centre of the target, m.
  [[nodiscard]] Eigen::MatrixXd irradiances(const fsw::Vector3& centre_L) const;
  /// Returns irradiances by the Earth, relative to that of the Sun: the digital twin's light of the Earth.
  [[nodiscard]] NormalIrradiances irradiances(const EarthLight& earth) const;

  /// Throws std::invalid_argument for a number that is not finite.
  [[nodiscard]] BoxPowers powers(const fsw::Vector3& centre_L, const EarthLight& earth) const;

  /// Returns the radius of the sphere: the mean half width of the target, m.
  [[nodiscard]] double radius_m() const { return radius_m_; }

 private:
  static constexpr std::array<double, kBoxes> all_full() {
    std::array<double, kBoxes> full{};
    full.fill(1.0);
    return full;
  }

  std::array<std::array<fsw::Vector3, 4>, kBoxes> corners_L_;
  std::array<double, kBoxes> full_light_;
  double exitance_ratio_;
  double radius_m_;
};

}  // namespace vbar::tron
