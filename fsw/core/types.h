#pragma once
// Fixed-size vectors and matrices of flight code. Dynamic sizes are not used on board.

#if !defined(EIGEN_DONT_VECTORIZE) || !defined(EIGEN_DONT_PARALLELIZE)
#error "build through vbar_options: vectorised Eigen changes the bits of flight code"
#endif

#include <Eigen/Core>

namespace vbar::fsw {

using Vector2 = Eigen::Matrix<double, 2, 1>;
using Vector3 = Eigen::Matrix<double, 3, 1>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix2 = Eigen::Matrix<double, 2, 2>;
using Matrix3 = Eigen::Matrix<double, 3, 3>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

}  // namespace vbar::fsw
