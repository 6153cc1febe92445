#include "hil_drivers/tron/lights/box_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "hil_drivers/tron/lights/photometry.h"
#include "host_sim/twins/camera/earth_disc.h"

namespace vbar::tron {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rounding of the gradient, relative to its terms.
constexpr double kRounding = 1e-12;

enum class Bound { kLower, kUpper, kFree };

class ActiveSet {
 public:
  ActiveSet(const MatrixXd& A, const VectorXd& b)
      : A_(A), b_(b), x_(VectorXd::Zero(A.cols())), bounds_(static_cast<std::size_t>(A.cols()), Bound::kLower) {}

  bool solve() {
    // Each release lowers the residual; the bound is for problems in which rounding hides that.
    const Index releases = 20 * (A_.cols() + 1);
    for (Index k = 0; k < releases; ++k) {
      const Index free = best_release();
      if (free < 0) return true;
      const Bound before = bound(free);
      bound(free) = Bound::kFree;
      if (!settle(free)) {
        // Rounding: the variable would leave at once the way that it came. It stays at its bound.
        bound(free) = before;
        x_[free] = before == Bound::kUpper ? 1.0 : 0.0;
        is_barred_.resize(bounds_.size(), false);
        is_barred_[static_cast<std::size_t>(free)] = true;
      } else {
        is_barred_.assign(bounds_.size(), false);
      }
    }
    return false;
  }

  [[nodiscard]] const VectorXd& x() const { return x_; }

 private:
  Bound& bound(Index k) { return bounds_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] bool is_barred(Index k) const { return !is_barred_.empty() && is_barred_[static_cast<std::size_t>(k)]; }

  /// The variable at a bound whose release lowers the residual most; negative if none does.
  Index best_release() {
    const VectorXd residual = b_ - A_ * x_;
    Index best = -1;
    double best_gain = 0.0;
    for (Index k = 0; k < A_.cols(); ++k) {
      if (bound(k) == Bound::kFree || is_barred(k)) continue;
      const double descent = A_.col(k).dot(residual);
      const double gain = bound(k) == Bound::kLower ? descent : -descent;
      const double rounding = kRounding * A_.col(k).norm() * (b_.norm() + A_.norm());
      if (gain > rounding && gain > best_gain) {
        best = k;
        best_gain = gain;
      }
    }
    return best;
  }

  /// Solves for the free variables, fixing those that meet a bound on the way. False if `released` would be fixed by
  /// the first step at the bound that it came from.
  bool settle(Index released) {
    for (bool is_first = true;; is_first = false) {
      std::vector<Index> free;
      for (Index k = 0; k < A_.cols(); ++k)
        if (bound(k) == Bound::kFree) free.push_back(k);
      if (free.empty()) return true;
      const VectorXd wanted = unbounded(free);
      double step = 1.0;
      Index blocking = -1;
      for (std::size_t k = 0; k < free.size(); ++k) {
        const double from = x_[free[k]], to = wanted[static_cast<Index>(k)];
        if (to >= 0.0 && to <= 1.0) continue;
        const double share = ((to > 1.0 ? 1.0 : 0.0) - from) / (to - from);
        if (share < step || blocking < 0) {
          step = share;
          blocking = free[k];
        }
      }
      if (is_first && blocking == released && step <= 0.0) return false;
      for (std::size_t k = 0; k < free.size(); ++k) x_[free[k]] += step * (wanted[static_cast<Index>(k)] - x_[free[k]]);
      if (blocking < 0) return true;
      bound(blocking) = x_[blocking] > 0.5 ? Bound::kUpper : Bound::kLower;
      x_[blocking] = bound(blocking) == Bound::kUpper ? 1.0 : 0.0;
    }
  }

  [[nodiscard]] VectorXd unbounded(const std::vector<Index>& free) const {
    MatrixXd columns(A_.rows(), static_cast<Index>(free.size()));
    VectorXd rest = b_ - A_ * x_;
    for (std::size_t k = 0; k < free.size(); ++k) {
      columns.col(static_cast<Index>(k)) = A_.col(free[k]);
      rest += x_[free[k]] * A_.col(free[k]);
    }
    return columns.completeOrthogonalDecomposition().solve(rest);
  }

  const MatrixXd& A_;
  const VectorXd& b_;
  VectorXd x_;
  std::vector<Bound> bounds_;
  std::vector<bool> is_barred_;
};

}  // namespace

BoundedSolution bounded_least_squares(const MatrixXd& A, const VectorXd& b) {
  if (A.rows() != b.size() || A.rows() < A.cols() || A.cols() == 0)
    throw std::invalid_argument("bounded least squares: sizes");
  if (!A.allFinite() || !b.allFinite()) throw std::invalid_argument("bounded least squares: a number is not finite");
  // |A x - b|^2 = |R x - Q'b|^2 + a constant: the same minimum on few rows.
  const Eigen::HouseholderQR<MatrixXd> factor(A);
  const MatrixXd R = factor.matrixQR().topRows(A.cols()).triangularView<Eigen::Upper>();
  const VectorXd c = (factor.householderQ().adjoint() * b).head(A.cols());
  ActiveSet set(R, c);
  BoundedSolution solution;
  solution.has_converged = set.solve();
  solution.x = set.x();
  solution.residual_norm = (A * solution.x - b).norm();
  return solution;
}

namespace {

using fsw::Vector3;

constexpr int kParts = 4;  // parts of an edge: 10 kParts^2 + 2 corners

std::array<Vector3, 12> icosahedron() {
  std::array<Vector3, 12> corners;
  std::size_t k = 0;
  for (const double one : {-1.0, 1.0})
    for (const double golden : {-std::numbers::phi, std::numbers::phi}) {
      corners[k++] = {0.0, one, golden};
      corners[k++] = {one, golden, 0.0};
      corners[k++] = {golden, 0.0, one};
    }
  return corners;
}

void add(const Vector3& point, std::vector<Vector3>& normals) {
  const Vector3 normal = point.normalized();
  const auto is_same = [&](const Vector3& other) { return (other - normal).squaredNorm() < 1e-12; };
  if (std::ranges::none_of(normals, is_same)) normals.push_back(normal);
}

std::vector<Vector3> divided_icosahedron() {
  const auto corners = icosahedron();
  const auto are_neighbours = [](const Vector3& a, const Vector3& b) { return std::abs((a - b).norm() - 2.0) < 1e-9; };
  std::vector<Vector3> normals;
  for (std::size_t a = 0; a < corners.size(); ++a)
    for (std::size_t b = a + 1; b < corners.size(); ++b)
      for (std::size_t c = b + 1; c < corners.size(); ++c) {
        if (!are_neighbours(corners[a], corners[b]) || !are_neighbours(corners[a], corners[c]) ||
            !are_neighbours(corners[b], corners[c]))
          continue;
        for (int i = 0; i <= kParts; ++i)
          for (int j = 0; i + j <= kParts; ++j)
            add(i * corners[a] + j * corners[b] + (kParts - i - j) * corners[c], normals);
      }
  return normals;
}

}  // namespace

const std::vector<Vector3>& sphere_normals() {
  static const std::vector<Vector3> normals = divided_icosahedron();
  return normals;
}

namespace {

constexpr double kSteepest = 0.9;
constexpr double kSmallestHalfAngle = 1e-3;  // rad; as the twin's renderer

/// Anticlockwise as seen from the room; two edges are horizontal.
std::array<Vector3, 4> corners_of(const LightBox& box, double side_m) {
  const Vector3 reference = std::abs(box.normal.z()) < kSteepest ? Vector3::UnitZ() : Vector3::UnitX();
  const Vector3 right = 0.5 * side_m * reference.cross(box.normal).normalized();
  const Vector3 up = 0.5 * side_m * box.normal.cross(right).normalized();
  return {box.centre_m - right - up, box.centre_m + right - up, box.centre_m + right + up, box.centre_m - right + up};
}

}  // namespace

BoxLight::BoxLight(const TestbedDesign& bench, const std::array<double, kBoxes>& full_light)
    : full_light_(full_light),
      exitance_ratio_(bench.boxes.exitance_ratio),
      radius_m_(0.5 * bench.scale * (bench.target.body_high_m - bench.target.body_low_m).mean()) {
  for (std::size_t k = 0; k < kBoxes; ++k) corners_L_[k] = corners_of(bench.boxes.boxes[k], bench.boxes.side_m);
}

Eigen::MatrixXd BoxLight::irradiances(const Vector3& centre_L) const {
  const auto& normals = sphere_normals();
  Eigen::MatrixXd irradiances(static_cast<Eigen::Index>(normals.size()), static_cast<Eigen::Index>(kBoxes));
  for (Eigen::Index j = 0; j < irradiances.rows(); ++j) {
    const Vector3& normal = normals[static_cast<std::size_t>(j)];
    const Vector3 point = centre_L + radius_m_ * normal;
    for (Eigen::Index i = 0; i < irradiances.cols(); ++i)
      irradiances(j, i) = exitance_ratio_ * form_factor(point, normal, corners_L_[static_cast<std::size_t>(i)]);
  }
  return irradiances;
}

NormalIrradiances BoxLight::irradiances(const EarthLight& earth) const {
  const auto& normals = sphere_normals();
  const double sine = std::sin(std::clamp(earth.half_angle, kSmallestHalfAngle, 0.5 * std::numbers::pi));
  NormalIrradiances irradiances(static_cast<Eigen::Index>(normals.size()));
  for (Eigen::Index j = 0; j < irradiances.size(); ++j)
    irradiances[j] = earth.ratio * twins::camera::earth_light_factor(
                                       normals[static_cast<std::size_t>(j)].dot(earth.direction_L), sine);
  return irradiances;
}

BoxPowers BoxLight::powers(const Vector3& centre_L, const EarthLight& earth) const {
  if (!centre_L.allFinite() || !earth.direction_L.allFinite() || !std::isfinite(earth.half_angle + earth.ratio))
    throw std::invalid_argument("light boxes: a number of the target's place or of the Earth is not finite");
  const NormalIrradiances wanted = irradiances(earth);
  BoxPowers powers;
  const double largest = wanted.maxCoeff();
  if (largest <= 0.0) return powers;
  Eigen::MatrixXd full = irradiances(centre_L);
  for (std::size_t k = 0; k < kBoxes; ++k) full.col(static_cast<Eigen::Index>(k)) *= full_light_[k];
  const BoundedSolution solution = bounded_least_squares(full, wanted);
  for (std::size_t k = 0; k < kBoxes; ++k) powers.power[k] = full_light_[k] * solution.x[static_cast<Eigen::Index>(k)];
  powers.misfit = solution.residual_norm / std::sqrt(static_cast<double>(wanted.size())) / largest;
  return powers;
}

}  // namespace vbar::tron
