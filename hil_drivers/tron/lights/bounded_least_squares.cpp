#include "hil_drivers/tron/lights/bounded_least_squares.h"

#include <stdexcept>
#include <vector>

#include <Eigen/QR>

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

}  // namespace vbar::tron
