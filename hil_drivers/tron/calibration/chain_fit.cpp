#include "hil_drivers/tron/calibration/chain_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include "hil_drivers/tron/calibration/chain_costs.h"
#include "hil_drivers/tron/geometry/calibration.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;

constexpr double kCornerLoss = 2.5, kViconLoss = 4.0;  ///< in sigmas

using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Parameters {
  std::array<double, kLens> lens{};
  std::array<double, kCameraArm> camera{};
  std::array<double, kTargetArm> target{};
  std::vector<std::array<double, kTrackErrors>> knots;
  double scale = 0.0;
  std::array<double, kPose> V_L{}, C_object{}, object_T{};  ///< from their starts
  std::vector<std::array<double, kPose>> images;            ///< from their starts
};

Matrix6 whitening(const Matrix6& covariance) {
  const Eigen::LLT<Matrix6> llt(covariance);
  return llt.matrixL().solve(Matrix6::Identity());
}

void read_arm(const ArmCalibration& arm, double* block) {
  std::ranges::copy(arm.offset_rad, block + kOffset);
  for (std::size_t k = 0; k < arm.link.size(); ++k) std::ranges::copy(arm.link[k], block + kLink + 6 * k);
  std::ranges::copy(arm.flex_rad_m, block + kFlex);
}

class Fit {
 public:
  Fit(const BoardDesign& board, const Isometry3d& T_target_board, const std::vector<FitImage>& images,
      const Calibration& from, const FitSettings& settings)
      : board_(board),
        T_target_board_(T_target_board),
        images_(images),
        settings_(settings),
        start_(chain_start(from)) {
    const LensCalibration& lens = from.lens;
    values_.lens = {lens.fx_px,         lens.fy_px,         lens.cx_px,         lens.cy_px,        lens.distortion[0],
                    lens.distortion[1], lens.distortion[2], lens.distortion[3], lens.distortion[4]};
    read_arm(from.camera_arm, values_.camera.data());
    read_arm(from.target_arm, values_.target.data());
    values_.knots = from.track.knots;
    values_.scale = from.track.scale;
    values_.images.resize(images.size());
    add_corners();
    if (settings.stage != FitStage::kLens) add_arms();
    if (settings.is_vicon_used) add_vicon();
    add_priors();
    hold();
  }

  FitResult run() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (auto& image : values_.images)
      if (problem_.HasParameterBlock(image.data())) options.linear_solver_ordering->AddElementToGroup(image.data(), 0);
    for (double* block : globals())
      if (problem_.HasParameterBlock(block)) options.linear_solver_ordering->AddElementToGroup(block, 1);
    options.max_num_iterations = 60;
    options.function_tolerance = 1e-8;
    options.parameter_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    FitResult result;
    result.is_usable = summary.IsSolutionUsable();
    result.cost = summary.final_cost;
    result.iterations = static_cast<int>(summary.iterations.size());
    result.calibration = calibration();
    for (std::size_t k = 0; k < images_.size(); ++k)
      result.T_C_T.push_back(image_pose(images_[k].T_C_T, values_.images[k].data()));
    if (settings_.stage == FitStage::kWholeChain && result.is_usable) result.covariance = chain_covariance();
    return result;
  }

 private:
  static void write_arm(const double* block, ArmCalibration& arm) {
    std::copy_n(block + kOffset, 6, arm.offset_rad.begin());
    for (std::size_t k = 0; k < arm.link.size(); ++k) std::copy_n(block + kLink + 6 * k, 6, arm.link[k].begin());
    std::copy_n(block + kFlex, 2, arm.flex_rad_m.begin());
  }

  [[nodiscard]] Calibration calibration() const {
    Calibration c = start_.calibration;
    c.lens.fx_px = values_.lens[0];
    c.lens.fy_px = values_.lens[1];
    c.lens.cx_px = values_.lens[2];
    c.lens.cy_px = values_.lens[3];
    std::copy_n(values_.lens.begin() + 4, 5, c.lens.distortion.begin());
    write_arm(values_.camera.data(), c.camera_arm);
    write_arm(values_.target.data(), c.target_arm);
    c.camera_arm.mount = PoseFigures::of(start_.camera_mount * rigid_of(values_.camera.data() + kMount));
    c.target_arm.mount = PoseFigures::of(start_.target_mount * rigid_of(values_.target.data() + kMount));
    c.target_arm.base = PoseFigures::of(start_.target_base * rigid_of(values_.target.data() + kBase));
    c.track.knots = values_.knots;
    c.track.scale = values_.scale;
    c.vicon.T_V_L = PoseFigures::of(start_.V_L * rigid_of(values_.V_L.data()));
    c.vicon.T_C_object = PoseFigures::of(start_.C_object * rigid_of(values_.C_object.data()));
    c.vicon.T_object_T = PoseFigures::of(start_.object_T * rigid_of(values_.object_T.data()));
    return c;
  }

  /// All blocks but those of the images.
  std::vector<double*> globals() {
    std::vector<double*> blocks{values_.camera.data(),  values_.target.data(), &values_.scale,
                                values_.lens.data(),    values_.V_L.data(),    values_.C_object.data(),
                                values_.object_T.data()};
    for (auto& knot : values_.knots) blocks.push_back(knot.data());
    return blocks;
  }

  void add_corners() {
    for (std::size_t k = 0; k < images_.size(); ++k)
      for (const Corner& corner : images_[k].measurement.corners)
        problem_.AddResidualBlock(
            corner_cost(images_[k].T_C_T, T_target_board_ * board_.corner(corner.id), corner.px, images_[k].sigma_px)
                .release(),
            new ceres::HuberLoss(kCornerLoss), values_.lens.data(), values_.images[k].data());
  }

  /// Returns the blocks of the knots that act at a posture.
  std::array<double*, kSpline> knots(const Posture& posture) {
    const auto first = static_cast<std::size_t>(first_knot_at(start_.calibration.track, posture.carriage_m));
    std::array<double*, kSpline> blocks{};
    for (std::size_t k = 0; k < kSpline; ++k) blocks[k] = values_.knots[first + k].data();
    return blocks;
  }

  void add_arms() {
    for (std::size_t k = 0; k < images_.size(); ++k) {
      if (images_[k].measurement.corners.empty()) continue;
      const Posture& posture = images_[k].measurement.posture;
      const auto [k0, k1, k2, k3] = knots(posture);
      const Matrix6 whiten = whitening(scatter_covariance(settings_.arms, images_[k].T_C_T));
      problem_.AddResidualBlock(arms_cost(start_, posture, images_[k].T_C_T, whiten).release(), nullptr,
                                values_.images[k].data(), values_.camera.data(), values_.target.data(), k0, k1, k2, k3,
                                &values_.scale);
    }
  }

  void add_vicon() {
    const auto weights = [&](double rotation_rad) {
      Vector6 sigma;
      const double place_m = std::hypot(settings_.vicon.place_m, settings_.arms.place_m);
      sigma << rotation_rad, rotation_rad, rotation_rad, place_m, place_m, place_m;
      return Matrix6(sigma.cwiseInverse().asDiagonal());
    };
    for (const FitImage& image : images_) {
      if (!image.measurement.vicon) continue;
      const Posture& posture = image.measurement.posture;
      const ViconObjects& vicon = *image.measurement.vicon;
      const auto [k0, k1, k2, k3] = knots(posture);
      problem_.AddResidualBlock(
          vicon_camera_cost(start_, posture, vicon.T_V_camera, weights(settings_.vicon.camera_rad)).release(),
          new ceres::HuberLoss(kViconLoss), values_.V_L.data(), values_.camera.data(), k0, k1, k2, k3, &values_.scale,
          values_.C_object.data());
      problem_.AddResidualBlock(
          vicon_target_cost(start_, posture, vicon.T_V_target, weights(settings_.vicon.target_rad)).release(),
          new ceres::HuberLoss(kViconLoss), values_.V_L.data(), values_.target.data(), values_.object_T.data());
    }
  }

  template <std::size_t N>
  void add_prior(double* block, const std::array<double, N>& mean, const std::array<double, N>& sigma) {
    if (problem_.HasParameterBlock(block)) problem_.AddResidualBlock(prior_cost(mean, sigma).release(), nullptr, block);
  }

  void fill_arm(double* sigma) const {
    const FitPriors& p = settings_.priors;
    std::fill_n(sigma + kOffset, 6, p.offset_rad);
    for (int k = 0; k < kLinkErrors; ++k) {
      std::fill_n(sigma + kLink + 6 * k, 3, p.link_rad);
      std::fill_n(sigma + kLink + 6 * k + 3, 3, p.link_m);
    }
    std::fill_n(sigma + kFlex, 2, p.flex_rad_m);
    std::fill_n(sigma + kMount, 3, p.mount_rad);
    std::fill_n(sigma + kMount + 3, 3, p.mount_m);
  }

  void add_priors() {
    const FitPriors& p = settings_.priors;
    std::array<double, kLens> lens_sigma{p.focal_ratio * values_.lens[0], p.focal_ratio * values_.lens[1], p.centre_px,
                                         p.centre_px};
    const std::array<double, 5> least{0.01, 0.03, 2e-5, 2e-5, 0.02};
    for (std::size_t k = 0; k < 5; ++k)
      lens_sigma[4 + k] = std::max(least[k], p.distortion_ratio * std::abs(values_.lens[4 + k]));
    add_prior<kLens>(values_.lens.data(), values_.lens, lens_sigma);
    if (problem_.HasParameterBlock(values_.lens.data()))
      problem_.AddResidualBlock(aspect_cost(values_.lens[1] / values_.lens[0], p.pixel_aspect).release(), nullptr,
                                values_.lens.data());
    std::array<double, kCameraArm> camera_sigma{};
    fill_arm(camera_sigma.data());
    add_prior<kCameraArm>(values_.camera.data(), {}, camera_sigma);
    std::array<double, kTargetArm> target_sigma{};
    fill_arm(target_sigma.data());
    std::fill_n(target_sigma.data() + kBase, 3, p.base_rad);
    std::fill_n(target_sigma.data() + kBase + 3, 3, p.base_m);
    add_prior<kTargetArm>(values_.target.data(), {}, target_sigma);
    if (settings_.stage != FitStage::kLens)
      for (auto& knot : values_.knots) {
        problem_.AddParameterBlock(knot.data(), kTrackErrors);
        add_prior<kTrackErrors>(knot.data(), {}, {p.track_rad, p.track_rad, p.track_rad, p.track_m, p.track_m});
      }
    add_prior<1>(&values_.scale, {}, {p.track_scale});
    const std::array<double, 6> vicon_sigma{p.vicon_rad, p.vicon_rad, p.vicon_rad, p.vicon_m, p.vicon_m, p.vicon_m};
    add_prior<6>(values_.V_L.data(), {}, vicon_sigma);
    add_prior<6>(values_.C_object.data(), {}, vicon_sigma);
    add_prior<6>(values_.object_T.data(), {}, vicon_sigma);
  }

  void hold_within(double* block, int size, const std::vector<int>& constant) {
    if (problem_.HasParameterBlock(block) && !constant.empty())
      problem_.SetManifold(block, new ceres::SubsetManifold(size, constant));
  }

  /// What the stage does not fit.
  void hold() {
    if (!settings_.is_lens_free) problem_.SetParameterBlockConstant(values_.lens.data());
    if (settings_.stage == FitStage::kLens) return;
    std::vector<int> constant;
    const auto add = [&](int first, int end) {
      for (int k = first; k < end; ++k) constant.push_back(k);
    };
    if (settings_.stage == FitStage::kMounts) add(kOffset, kLink);
    if (settings_.stage != FitStage::kWholeChain) add(kLink, kFlex);
    if (settings_.stage < FitStage::kFlexAndTrack) add(kFlex, kMount);
    hold_within(values_.camera.data(), kCameraArm, constant);
    hold_within(values_.target.data(), kTargetArm, constant);
    if (settings_.stage >= FitStage::kFlexAndTrack) return;
    for (auto& knot : values_.knots) problem_.SetParameterBlockConstant(knot.data());
    problem_.SetParameterBlockConstant(&values_.scale);
  }

  /// Returns the covariance of camera arm, target arm, scale, knots, and both objects of motion capture, by the inverse
  /// of the normal matrix of all parameters.
  Eigen::MatrixXd chain_covariance() {
    std::vector<double*> blocks{values_.camera.data(), values_.target.data(), &values_.scale};
    for (auto& knot : values_.knots) blocks.push_back(knot.data());
    auto chain_size = static_cast<Eigen::Index>(kCameraArm + kTargetArm + 1 + kTrackErrors * values_.knots.size());
    if (settings_.is_vicon_used) chain_size += 2 * kPose;
    for (double* block : {values_.C_object.data(), values_.object_T.data(), values_.lens.data(), values_.V_L.data()})
      if (problem_.HasParameterBlock(block) && !problem_.IsParameterBlockConstant(block)) blocks.push_back(block);
    Eigen::Index global_size = 0;
    for (const double* block : blocks) global_size += problem_.ParameterBlockSize(block);
    for (auto& image : values_.images)
      if (problem_.HasParameterBlock(image.data())) blocks.push_back(image.data());
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks;
    ceres::CRSMatrix jacobian;
    problem_.Evaluate(options, nullptr, nullptr, nullptr, &jacobian);
    return reduced_normal(jacobian, global_size)
        .ldlt()
        .solve(Eigen::MatrixXd::Identity(global_size, global_size))
        .topLeftCorner(chain_size, chain_size);
  }

  /// J'J with the images' poses eliminated (Schur complement).
  static Eigen::MatrixXd reduced_normal(const ceres::CRSMatrix& jacobian, Eigen::Index global_size) {
    const Eigen::Index poses = (jacobian.num_cols - global_size) / kPose;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(global_size, global_size);
    std::vector<Eigen::MatrixXd> mixed(static_cast<std::size_t>(poses), Eigen::MatrixXd::Zero(kPose, global_size));
    std::vector<Matrix6> own(static_cast<std::size_t>(poses), Matrix6::Zero());
    for (int row = 0; row < jacobian.num_rows; ++row) {
      const auto first = static_cast<std::size_t>(jacobian.rows[static_cast<std::size_t>(row)]);
      const auto end = static_cast<std::size_t>(jacobian.rows[static_cast<std::size_t>(row) + 1]);
      for (std::size_t a = first; a < end; ++a)
        for (std::size_t b = first; b < end; ++b) {
          const Eigen::Index i = jacobian.cols[a], j = jacobian.cols[b];
          const double product = jacobian.values[a] * jacobian.values[b];
          if (i < global_size && j < global_size) normal(i, j) += product;
          if (i < global_size) continue;
          const auto pose = static_cast<std::size_t>((i - global_size) / kPose);
          const Eigen::Index at = (i - global_size) % kPose;
          if (j < global_size)
            mixed[pose](at, j) += product;
          else
            own[pose](at, (j - global_size) % kPose) += product;
        }
    }
    for (std::size_t k = 0; k < mixed.size(); ++k) {
      const Eigen::LDLT<Matrix6> ldlt(own[k]);
      normal -= mixed[k].transpose() * ldlt.solve(mixed[k]);
    }
    return normal;
  }

  const BoardDesign& board_;
  Isometry3d T_target_board_;
  const std::vector<FitImage>& images_;
  FitSettings settings_;
  ChainStart start_;
  Parameters values_;
  ceres::Problem problem_;
};

Eigen::MatrixXd jacobian_of_arms(const FitResult& fit, const Posture& posture) {
  const ChainStart start = chain_start(fit.calibration);
  const Isometry3d T_C_T = T_C_T_of_arms(fit.calibration, posture);
  Parameters at;
  const Cost cost = arms_cost(start, posture, T_C_T, Matrix6::Identity());
  const int first_knot = first_knot_at(start.calibration.track, posture.carriage_m);
  const std::array<double, kPose> image{};
  read_arm(fit.calibration.camera_arm, at.camera.data());
  read_arm(fit.calibration.target_arm, at.target.data());
  const auto knot = [&](int k) { return fit.calibration.track.knots[static_cast<std::size_t>(first_knot + k)].data(); };
  const std::array<const double*, 8> blocks{
      image.data(), at.camera.data(), at.target.data(), knot(0),
      knot(1),      knot(2),          knot(3),          &fit.calibration.track.scale};
  Eigen::Matrix<double, 6, kPose, Eigen::RowMajor> by_image;
  Eigen::Matrix<double, 6, kCameraArm, Eigen::RowMajor> by_camera;
  Eigen::Matrix<double, 6, kTargetArm, Eigen::RowMajor> by_target;
  std::array<Eigen::Matrix<double, 6, kTrackErrors, Eigen::RowMajor>, kSpline> by_knot;
  Eigen::Matrix<double, 6, 1> by_scale, residual;
  std::array<double*, 8> jacobians{by_image.data(),   by_camera.data(),  by_target.data(),  by_knot[0].data(),
                                   by_knot[1].data(), by_knot[2].data(), by_knot[3].data(), by_scale.data()};
  cost->Evaluate(blocks.data(), residual.data(), jacobians.data());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, fit.covariance.cols());
  jacobian.leftCols<kCameraArm>() = by_camera;
  jacobian.middleCols<kTargetArm>(kCameraArm) = by_target;
  jacobian.col(kCameraArm + kTargetArm) = by_scale;
  for (int k = 0; k < kSpline; ++k)
    jacobian.middleCols<kTrackErrors>(kCameraArm + kTargetArm + 1 + kTrackErrors * (first_knot + k)) =
        by_knot[static_cast<std::size_t>(k)];
  return jacobian;
}

/// Returns the Jacobian of T_C_T by motion capture, if its objects are seen where the arms say: by its two frames.
Eigen::MatrixXd jacobian_of_vicon(const FitResult& fit, const Posture& posture) {
  constexpr double kStep = 1e-6;
  const Isometry3d T_C_T = T_C_T_of_arms(fit.calibration, posture);
  const Isometry3d C_object = fit.calibration.vicon.T_C_object.isometry();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, fit.covariance.cols());
  const Eigen::Index first = fit.covariance.cols() - 2 * kPose;
  for (int k = 0; k < kPose; ++k) {
    const Vector6 step = kStep * Vector6::Unit(k);
    const Isometry3d moved = rigid_of(step.data());
    jacobian.col(first + k) = pose_difference(T_C_T, C_object * moved * C_object.inverse() * T_C_T) / kStep;
    jacobian.col(first + kPose + k) = pose_difference(T_C_T, T_C_T * moved) / kStep;
  }
  return jacobian;
}

}  // namespace

FitResult fit_chain(const BoardDesign& board, const Isometry3d& T_target_board, const std::vector<FitImage>& images,
                    const Calibration& start, const FitSettings& settings) {
  return Fit(board, T_target_board, images, start, settings).run();
}

Matrix6 posterior_of_arms(const FitResult& fit, const Posture& posture) {
  const Eigen::MatrixXd jacobian = jacobian_of_arms(fit, posture);
  return jacobian * fit.covariance * jacobian.transpose();
}

Matrix6 posterior_of_difference(const FitResult& fit, const Posture& posture) {
  const Eigen::MatrixXd jacobian = jacobian_of_arms(fit, posture) - jacobian_of_vicon(fit, posture);
  return jacobian * fit.covariance * jacobian.transpose();
}

}  // namespace vbar::tron::calibrate
