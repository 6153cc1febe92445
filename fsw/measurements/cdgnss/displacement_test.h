#pragma once
// Is the estimate wrong, or are the measurements? Generalised likelihood ratio of a displacement of the target (Willsky
// and Jones 1976, of one epoch).
//
//   H0: y ~ N(0, S)        the innovations are those of a correct estimate
//   H1: y ~ N(G b, S)      the target is displaced by b, unknown
//
// The ratio b' G' S^-1 G b of the best b is chi-square with three degrees of freedom under H0. Errors of single
// measurements (cycle slips, multipath) do not have the pattern of a displacement: they remain in the rest of y, and
// the worst of them are left out.

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "fsw/core/types.h"

namespace vbar::fsw::measurements {

/// Result of the test of one epoch.
struct Displacement {
  bool is_tested = false;            ///< enough measurements
  bool is_detected = false;          ///< a displacement explains them, and nothing else does
  double ratio = 0.0;                ///< of the likelihoods: chi-square with three degrees of freedom under H0
  Vector3 metres = Vector3::Zero();  ///< best estimate, in the axes of the directions
};

class DisplacementTest {
 public:
  static constexpr int kMaxRows = 24;
  static constexpr int kMinRows = 6;  ///< three components, a clock, and two to tell a displacement from an outlier
  using Matrix = Eigen::Matrix<double, kMaxRows, kMaxRows>;
  using Vector = Eigen::Matrix<double, kMaxRows, 1>;

  void clear();
  [[nodiscard]] bool is_full() const { return count_ == kMaxRows; }
  [[nodiscard]] int count() const { return count_; }
  /// Adds an innovation, m, with its change per displacement; its covariances with the rows so far and its own variance
  /// follow by set_covariance().
  void add(double innovation_m, const Vector3& direction);
  void set_covariance(int row, int column, double covariance_m2);

  /// Evaluates the rows. `gate`: of the ratio. `max_rest`: of the mean square of what the displacement does not
  /// explain.
  [[nodiscard]] Displacement evaluate(double gate, double max_rest);

 private:
  void leave_out(int row);

  int count_ = 0;
  Matrix covariance_ = Matrix::Identity();
  Vector innovation_ = Vector::Zero();
  Eigen::Matrix<double, kMaxRows, 3> direction_ = Eigen::Matrix<double, kMaxRows, 3>::Zero();
};

}  // namespace vbar::fsw::measurements
