#pragma once
// RTKLIB's integer least squares out of Debian's librtklib, whose package carries no header.

#include <array>

#include <Eigen/Core>

namespace vbar::peers {

/// `fixed`, n x 2: best and second, whole numbers up to rounding; their squared norms. False: it gave up after 10,000
/// loops of its reduction or its search.
bool rtklib_lambda(const Eigen::VectorXd& ambiguities, const Eigen::MatrixXd& covariance, Eigen::MatrixXd& fixed,
                   std::array<double, 2>& norm2);

}  // namespace vbar::peers
