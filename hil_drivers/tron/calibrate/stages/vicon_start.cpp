#include "hil_drivers/tron/calibrate/stages/vicon_start.h"

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "hil_drivers/tron/calibrate/fit/hand_eye.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::array kOrders{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};

struct Sample {
  Isometry3d seen, between;  ///< T_C_T by the image; camera's object to target's object
  Matrix6 whiten;
};

struct Frames {
  Isometry3d T_C_object, T_object_T;

  [[nodiscard]] Frames moved(const Vector12& step) const {
    return {T_C_object * rigid_of(step.data()), T_object_T * rigid_of(step.data() + 6)};
  }
  [[nodiscard]] Vector6 residual(const Sample& sample) const {
    return sample.whiten * pose_difference(sample.seen, T_C_object * sample.between * T_object_T);
  }
};

/// Huber's loss on the size of the whole residual.
double weight_of(const Vector6& residual) {
  constexpr double kLoss = 4.0;
  const double size = residual.norm();
  return size <= kLoss ? 1.0 : kLoss / size;
}

Frames refined(const std::vector<Sample>& samples, Frames frames) {
  for (int iteration = 0; iteration < 15; ++iteration) {
    Eigen::Matrix<double, 12, 12> normal = Eigen::Matrix<double, 12, 12>::Zero();
    Vector12 right = Vector12::Zero();
    for (const Sample& sample : samples) {
      const Vector6 residual = frames.residual(sample);
      Eigen::Matrix<double, 6, 12> jacobian;
      for (int k = 0; k < 12; ++k)
        jacobian.col(k) = (frames.moved(1e-6 * Vector12::Unit(k)).residual(sample) -
                           frames.moved(-1e-6 * Vector12::Unit(k)).residual(sample)) /
                          2e-6;
      const double weight = weight_of(residual);
      normal += weight * jacobian.transpose() * jacobian;
      right -= weight * jacobian.transpose() * residual;
    }
    const Vector12 step = normal.ldlt().solve(right);
    if (!step.allFinite()) return frames;
    frames = frames.moved(step);
    if (step.norm() < 1e-9) break;
  }
  return frames;
}

}  // namespace

ViconStart fit_vicon(const std::vector<FitImage>& images, const std::vector<Matrix6>& covariances,
                     const std::string& assumed) {
  ViconStart best;
  best.rotation_rms_rad = std::numeric_limits<double>::infinity();
  for (const char* order : kOrders) {
    std::vector<Sample> samples;
    std::vector<HandEyePair> pairs;
    for (std::size_t k = 0; k < images.size(); ++k) {
      if (!images[k].measurement.vicon) continue;
      const ViconObjects& objects = *images[k].measurement.vicon;
      const Isometry3d between =
          reordered(objects.T_V_camera, assumed, order).inverse() * reordered(objects.T_V_target, assumed, order);
      const Eigen::LLT<Matrix6> llt(covariances[k]);
      samples.push_back({images[k].T_C_T, between, llt.matrixL().solve(Matrix6::Identity())});
      pairs.push_back({images[k].T_C_T, between});
    }
    if (samples.size() < 6) continue;
    // T_C_T = T_C_object between T_object_T reads A X = Z B with X = T_object_T^-1.
    const HandEye start = solve_hand_eye(pairs);
    Frames frames{start.Z, start.X.inverse()};
    const auto rms_of = [&] {
      double square = 0.0;
      for (const Sample& sample : samples)
        square += std::min(1.0, pose_difference(sample.seen, frames.T_C_object * sample.between * frames.T_object_T)
                                    .head<3>()
                                    .squaredNorm());
      return std::sqrt(square / static_cast<double>(samples.size()));
    };
    // A wrong order is off by degrees: no need to refine it.
    if (rms_of() > 3.0 * best.rotation_rms_rad) continue;
    frames = refined(samples, frames);
    const double rms = rms_of();
    if (rms >= best.rotation_rms_rad) continue;
    best.rotation_rms_rad = rms;
    best.vicon.rotation = order;
    best.vicon.T_C_object = PoseFigures::of(frames.T_C_object);
    best.vicon.T_object_T = PoseFigures::of(frames.T_object_T);
  }
  return best;
}

PoseFigures vicon_of_laboratory(const std::vector<FitImage>& images, const Calibration& calibration) {
  const Isometry3d T_object_C = calibration.vicon.T_C_object.isometry().inverse();
  Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();
  fsw::Vector3 place = fsw::Vector3::Zero();
  double count = 0.0;
  for (const FitImage& image : images) {
    if (!image.measurement.vicon) continue;
    const Isometry3d T_V_L = image.measurement.vicon->T_V_camera * T_object_C *
                             T_L_C_of_arm(calibration, image.measurement.posture).inverse();
    const Eigen::Vector4d q = Eigen::Quaterniond(T_V_L.linear()).coeffs();
    quaternion += q.dot(quaternion) < 0.0 ? Eigen::Vector4d(-q) : q;
    place += T_V_L.translation();
    count += 1.0;
  }
  Isometry3d mean = Isometry3d::Identity();
  if (count == 0.0) return PoseFigures::of(mean);
  mean.linear() = Eigen::Quaterniond(Eigen::Vector4d(quaternion.normalized())).toRotationMatrix();
  mean.translation() = place / count;
  return PoseFigures::of(mean);
}

}  // namespace vbar::tron::calibrate
