#include "host_sim/sensors/camera/true_camera.h"

#include <Eigen/Cholesky>

#include "fsw/orbit/roe.h"

namespace vbar::sensors {

TrueCamera true_camera(const CameraSensor& camera, const twins::SpacecraftTruth& servicer) {
  const Eigen::Quaterniond& q_body_eci = servicer.attitude->q_body_eci;
  return {servicer.orbit.position_eci + q_body_eci.conjugate() * camera.position_body_m,
          camera.q_camera_body * q_body_eci};
}

std::optional<Eigen::Vector2d> pixel_of(const twins::camera::CameraSettings& settings, const fsw::Vector3& los_camera) {
  if (!(los_camera.z() > 0.1 * los_camera.norm())) return std::nullopt;
  const auto& [k1, k2, p1, p2, k3] = settings.optics.distortion;
  const double x = los_camera.x() / los_camera.z(), y = los_camera.y() / los_camera.z(), r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double f = settings.focal_length_px();
  return Eigen::Vector2d(
      settings.optics.principal_point_px[0] + f * (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)),
      settings.optics.principal_point_px[1] + f * (y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y));
}

fsw::Matrix6 symmetric(const double (&lower_triangle)[21]) {
  fsw::Matrix6 matrix;
  std::size_t place = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column) matrix(row, column) = matrix(column, row) = lower_triangle[place++];
  return matrix;
}

std::optional<double> normalised_square(const fsw::Vector6& error, const fsw::Matrix6& covariance) {
  const Eigen::LLT<fsw::Matrix6> factor(covariance);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return factor.matrixL().solve(error).squaredNorm();
}

std::optional<double> nees_of_roe(const double (&a_roe_m)[6], const double (&covariance_m2)[21],
                                  const fsw::orbit::CartesianState& servicer,
                                  const fsw::orbit::CartesianState& target) {
  const auto chief = fsw::orbit::qns_from_cartesian(servicer), deputy = fsw::orbit::qns_from_cartesian(target);
  if (!chief.ok() || !deputy.ok()) return std::nullopt;
  const fsw::Vector6 error = Eigen::Map<const fsw::Vector6>(a_roe_m) -
                             chief.value().a * fsw::orbit::roe_from_qns(chief.value(), deputy.value());
  return normalised_square(error, symmetric(covariance_m2));
}

}  // namespace vbar::sensors
