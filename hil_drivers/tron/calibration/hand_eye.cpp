#include "hil_drivers/tron/calibration/hand_eye.h"

#include <Eigen/Dense>

namespace vbar::tron::calibrate {

namespace {

using Eigen::Matrix3d;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Row3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Matrix9 kronecker(const Matrix3d& a, const Matrix3d& b) {
  Matrix9 product;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) product.block<3, 3>(3 * i, 3 * j) = a(i, j) * b;
  return product;
}

Matrix3d nearest_rotation(const Matrix3d& matrix) {
  // A square matrix needs none of the QR decompositions that come with the default.
  const Eigen::JacobiSVD<Matrix3d, Eigen::NoQRPreconditioner> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if (rotation.determinant() < 0.0)
    rotation = svd.matrixU() * Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal() * svd.matrixV().transpose();
  return rotation;
}

void solve_rotations(const std::vector<HandEyePair>& pairs, HandEye& result) {
  // With rows in a vector, R_A R_X = R_Z R_B reads (R_A (x) I) x = (I (x) R_B') z. Matrices of sizes known to the
  // compiler would cost it 0.1 GB more.
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(18, 18), rows(9, 18);
  for (const HandEyePair& pair : pairs) {
    rows.leftCols<9>() = kronecker(pair.A.linear(), Matrix3d::Identity());
    rows.rightCols<9>() = -kronecker(Matrix3d::Identity(), pair.B.linear().transpose());
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(normal);
  const Eigen::VectorXd null = eigen.eigenvectors().col(0);
  const Matrix3d X = Eigen::Map<const Row3>(null.data()), Z = Eigen::Map<const Row3>(null.data() + 9);
  const double sign = X.determinant() + Z.determinant() < 0.0 ? -1.0 : 1.0;
  result.X.linear() = nearest_rotation(sign * X);
  result.Z.linear() = nearest_rotation(sign * Z);
}

void solve_translations(const std::vector<HandEyePair>& pairs, HandEye& result) {
  // R_A t_X + t_A = R_Z t_B + t_Z.
  const auto count = static_cast<Eigen::Index>(pairs.size());
  Eigen::MatrixXd matrix(3 * count, 6);
  Eigen::VectorXd right(3 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const HandEyePair& pair = pairs[static_cast<std::size_t>(i)];
    matrix.block<3, 3>(3 * i, 0) = pair.A.linear();
    matrix.block<3, 3>(3 * i, 3) = -Matrix3d::Identity();
    right.segment<3>(3 * i) = result.Z.linear() * pair.B.translation() - pair.A.translation();
  }
  const Eigen::VectorXd solution = matrix.colPivHouseholderQr().solve(right);
  result.X.translation() = solution.head<3>();
  result.Z.translation() = solution.tail<3>();
}

}  // namespace

HandEye solve_hand_eye(const std::vector<HandEyePair>& pairs) {
  HandEye result;
  if (pairs.empty()) return result;
  solve_rotations(pairs, result);
  solve_translations(pairs, result);
  return result;
}

}  // namespace vbar::tron::calibrate
