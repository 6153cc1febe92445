#pragma once
// Least squares with bounds.

#include <Eigen/Core>

namespace vbar::tron {

struct BoundedSolution {
  Eigen::VectorXd x;
  double residual_norm = 0.0;
  bool has_converged = false;
};

/// Minimises |A x - b| over 0 <= x <= 1: active set (Stark and Parker 1995, "Bounded-variable least squares: an
/// algorithm and applications"), on the triangular factor of A. A has at least as many rows as columns. A variable
/// whose column is zero stays 0. Throws std::invalid_argument for a number that is not finite.
[[nodiscard]] BoundedSolution bounded_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace vbar::tron
