#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/core.h>

#include "host_sim/star_images/star_fix.h"

namespace vbar::star_images {
namespace {

using fsw::Matrix3;
using fsw::Vector2;
using fsw::Vector3;
using fsw::imaging::CameraModel;

constexpr int kLens = 5;  // ln of the focal length, k1, k2, p1, p2
constexpr int kIterations = 20;
constexpr double kSmallestStep_px = 1e-6;  // root mean square over the stars
// A faint star beside another one, or one that is not in the catalogue, is beyond it; of noise 3 in 10,000 are.
constexpr double kOutlier = 4.0;
constexpr int kRejections = 10;

CameraModel with_step(CameraModel camera, const Eigen::VectorXd& step) {
  camera.focal_length_px *= std::exp(step[0]);
  for (std::size_t k = 0; k < kLens - 1; ++k) camera.distortion[k] += step[static_cast<Eigen::Index>(k) + 1];
  return camera;
}

Matrix3 rotated(const Matrix3& R, const Vector3& angle) {
  const double size = angle.norm();
  return size > 0.0 ? Matrix3(Eigen::AngleAxisd(size, angle / size).toRotationMatrix() * R) : R;
}

class StarLeastSquares {
 public:
  StarLeastSquares(const std::vector<StarFix>& fixes, const CameraModel& camera) : fixes_(fixes), camera_(camera) {
    for (const StarFix& fix : fixes) used_.emplace_back(fix.stars.size(), true);
  }

  LensCalibration solve() {
    for (int round = 0; round < kRejections; ++round) {
      converge();
      if (!reject()) break;
    }
    return result();
  }

 private:
  [[nodiscard]] static Vector2 residual(const SeenStar& star, const CameraModel& camera, const Matrix3& R) {
    const auto pixel = fsw::imaging::pixel_of(camera, R * star.direction_eci);
    if (!pixel.ok()) throw std::runtime_error("the fit of the lens does not converge");
    return star.pixel - pixel.value();
  }

  /// Gauss-Newton with central differences of 1e-6: of the plane's coordinates, some 0.005 px.
  void converge() {
    for (int k = 0; k < kIterations; ++k) {
      accumulate();
      const Eigen::LDLT<Eigen::MatrixXd> factor(normal_);
      const Eigen::VectorXd step = factor.solve(right_);
      if (factor.info() != Eigen::Success || !step.allFinite()) break;
      camera_ = with_step(camera_, step.head(kLens));
      for (std::size_t image = 0; image < fixes_.size(); ++image)
        fixes_[image].R_camera_eci =
            rotated(fixes_[image].R_camera_eci, step.segment<3>(kLens + 3 * static_cast<Eigen::Index>(image)));
      if (std::sqrt(step.dot(normal_ * step) / stars_) < kSmallestStep_px) return;
    }
    throw std::runtime_error("the fit of the lens does not converge");
  }

  void accumulate() {
    const auto size = static_cast<Eigen::Index>(kLens + 3 * fixes_.size());
    normal_ = Eigen::MatrixXd::Zero(size, size);
    right_ = Eigen::VectorXd::Zero(size);
    sum_ = 0.0;
    stars_ = 0;
    for (std::size_t image = 0; image < fixes_.size(); ++image) {
      const Matrix3& R = fixes_[image].R_camera_eci;
      const Eigen::Index place = kLens + 3 * static_cast<Eigen::Index>(image);
      for (std::size_t k = 0; k < fixes_[image].stars.size(); ++k) {
        if (!used_[image][k]) continue;
        const SeenStar& star = fixes_[image].stars[k];
        Eigen::MatrixXd row = Eigen::MatrixXd::Zero(2, size);
        for (Eigen::Index c = 0; c < kLens + 3; ++c) {
          const auto shifted = [&](double by) {
            Eigen::VectorXd lens = Eigen::VectorXd::Zero(kLens);
            Vector3 angle = Vector3::Zero();
            (c < kLens ? lens[c] : angle[c - kLens]) = by;
            return residual(star, with_step(camera_, lens), rotated(R, angle));
          };
          row.col(c < kLens ? c : place + c - kLens) =
              (shifted(-kDifference) - shifted(kDifference)) / (2.0 * kDifference);
        }
        const Vector2 miss = residual(star, camera_, R);
        normal_ += row.transpose() * row;
        right_ += row.transpose() * miss;
        sum_ += miss.squaredNorm();
        ++stars_;
      }
    }
    if (stars_ < kFewestStars)
      throw std::runtime_error(fmt::format("found {} identified stars, accepted: {} or more", stars_, kFewestStars));
  }

  /// Leaves out stars beyond the limit; false if there are none. A star once left out stays so.
  bool reject() {
    accumulate();
    const double limit = kOutlier * std::sqrt(sum_ / stars_ / 2.0);
    bool has_changed = false;
    for (std::size_t image = 0; image < fixes_.size(); ++image)
      for (std::size_t k = 0; k < fixes_[image].stars.size(); ++k)
        if (used_[image][k] && residual(fixes_[image].stars[k], camera_, fixes_[image].R_camera_eci).norm() > limit) {
          used_[image][k] = false;
          ++outliers_;
          has_changed = true;
        }
    return has_changed;
  }

  LensCalibration result() {
    accumulate();
    LensCalibration calibration;
    calibration.camera = camera_;
    const double freedoms = 2.0 * stars_ - static_cast<double>(normal_.rows());
    const Eigen::MatrixXd covariance = normal_.inverse() * (sum_ / freedoms);
    calibration.focal_length_sigma_px = camera_.focal_length_px.x() * std::sqrt(covariance(0, 0));
    for (Eigen::Index k = 1; k < kLens; ++k) calibration.distortion_sigma.push_back(std::sqrt(covariance(k, k)));
    calibration.rms_px = std::sqrt(sum_ / stars_);
    calibration.stars = stars_;
    calibration.outliers = outliers_;
    for (std::size_t image = 0; image < fixes_.size(); ++image) {
      StarFix fix = fixes_[image];
      fix.stars.clear();
      for (std::size_t k = 0; k < fixes_[image].stars.size(); ++k) {
        if (!used_[image][k]) continue;
        fix.stars.push_back(fixes_[image].stars[k]);
        fix.stars.back().residual_px = residual(fix.stars.back(), camera_, fix.R_camera_eci);
      }
      calibration.fixes.push_back(std::move(fix));
    }
    return calibration;
  }

  static constexpr double kDifference = 1e-6;
  std::vector<StarFix> fixes_;
  CameraModel camera_;
  std::vector<std::vector<bool>> used_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd right_;
  double sum_ = 0.0;
  int stars_ = 0;
  int outliers_ = 0;
};

}  // namespace

LensCalibration calibrate_lens(const std::vector<StarFix>& fixes, const CameraModel& start) {
  return StarLeastSquares(fixes, start).solve();
}

}  // namespace vbar::star_images
