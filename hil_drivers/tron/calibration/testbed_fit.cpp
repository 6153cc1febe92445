#include "hil_drivers/tron/calibration/testbed_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "hil_drivers/tron/calibration/chain_fit.h"
#include "hil_drivers/tron/calibration/hand_eye.h"
#include "hil_drivers/tron/calibration/pose_estimation.h"

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

namespace {

constexpr std::size_t kMinImages = 20;
/// About what a stage leaves unexplained: its weights against the corners' and the priors'.
constexpr Scatter kMountsScatter{5e-3, 5e-3, 3e-3}, kOffsetsScatter{1e-3, 1e-3, 1.2e-3}, kFlexScatter{7e-4, 7e-4, 8e-4},
    kChainScatter{2e-4, 2e-4, 2e-4}, kViconScatter{1.6e-3, 1.6e-3, 3e-4};

class BenchFitter {
 public:
  BenchFitter(const TestbedDesign& bench, const LensCalibration& lens, const CalibrationMeasurements& measurements,
              const Progress& progress)
      : measurements_(measurements), progress_(progress), T_T_B_(T_target_board(bench)) {
    design_ = calibration_as_designed(bench);
    design_.lens = lens;
  }

  TestbedFit run() {
    fit_lens();
    start_with_hand_eye();
    const Calibration start = current_;
    fit_vicon_alone();
    fit_whole_chain();
    fit_stages(start);
    return finish();
  }

 private:
  void report(const std::string& line) const {
    if (progress_) progress_(line);
  }

  /// Poses by the images, with the lens of `calibration` and starts by its chain.
  void pose_images(const Calibration& calibration) {
    std::vector<FitImage> next;
    covariances_.clear();
    for (const Measurement& measurement : measurements_.fitted) {
      const auto pose = board_pose(board_, calibration.lens, measurement.corners,
                                   T_C_T_of_arms(calibration, measurement.posture) * T_T_B_);
      if (!pose) continue;
      next.push_back({measurement, pose->T_C_B * T_T_B_.inverse(), pose->sigma_px});
      covariances_.push_back(about_target(*pose));
    }
    images_ = std::move(next);
    if (images_.size() < kMinImages)
      throw std::runtime_error(fmt::format("the board was seen in {} images of {}; at least {} are needed",
                                           images_.size(), measurements_.fitted.size(), kMinImages));
  }

  /// Returns the covariance about the target's origin instead of the board's.
  [[nodiscard]] Matrix6 about_target(const BoardPose& pose) const {
    const fsw::Vector3 arm = pose.T_C_B.linear() * T_T_B_.inverse().translation();
    Matrix6 move = Matrix6::Identity();
    move.bottomLeftCorner<3, 3>() << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
    return move * pose.covariance * move.transpose();
  }

  void fit_lens() {
    pose_images(design_);
    FitSettings settings;
    settings.stage = FitStage::kLens;
    settings.is_vicon_used = false;
    const FitResult fit = fit_chain(board_, T_T_B_, images_, design_, settings);
    if (!fit.is_usable) throw std::runtime_error("the fit of the lens does not converge");
    current_ = design_;
    current_.lens = fit.calibration.lens;
    report(fmt::format("lens by {} images: focal length {:.2f} px, centre {:.2f} {:.2f} px", images_.size(),
                       current_.lens.fx_px, current_.lens.cx_px, current_.lens.cy_px));
    pose_images(current_);
  }

  /// Mounts of both arms by the null space: T_C_T = X_C^-1 M X_T, with M between the flanges as designed.
  void start_with_hand_eye() {
    Calibration bare = current_;
    bare.camera_arm.mount = bare.target_arm.mount = {};
    std::vector<HandEyePair> pairs;
    for (const FitImage& image : images_)
      if (image.sigma_px < 3.0 * kCornerSigma_px)
        pairs.push_back({image.T_C_T, T_C_T_of_arms(bare, image.measurement.posture)});
    if (pairs.size() < kMinImages)
      throw std::runtime_error(
          fmt::format("{} images are good enough to begin with; at least {} are needed", pairs.size(), kMinImages));
    const HandEye start = solve_hand_eye(pairs);
    current_.camera_arm.mount = PoseFigures::of(start.Z.inverse());
    current_.target_arm.mount = PoseFigures::of(start.X.inverse());
    pose_images(current_);
  }

  [[nodiscard]] std::vector<Matrix6> covariances_with_vicon() const {
    std::vector<Matrix6> covariances;
    for (std::size_t k = 0; k < images_.size(); ++k)
      covariances.push_back(covariances_[k] + scatter_covariance(kViconScatter, images_[k].T_C_T));
    return covariances;
  }

  void fit_vicon_alone() {
    const auto count =
        std::ranges::count_if(images_, [](const FitImage& image) { return image.measurement.vicon.has_value(); });
    if (count < 6) throw std::runtime_error("motion capture saw both objects at fewer than 6 of the postures");
    const ViconStart start = fit_vicon(images_, covariances_with_vicon(), design_.vicon.rotation);
    current_.vicon = start.vicon;
    report(fmt::format("motion capture: angles in the order {}", start.vicon.rotation));
    if (start.vicon.rotation != design_.vicon.rotation)
      for (FitImage& image : images_) reorder(image.measurement, start.vicon.rotation);
    current_.vicon.T_V_L = vicon_of_laboratory(images_, current_);
  }

  void reorder(Measurement& measurement, const std::string& order) const {
    if (!measurement.vicon) return;
    measurement.vicon->T_V_camera = reordered(measurement.vicon->T_V_camera, design_.vicon.rotation, order);
    measurement.vicon->T_V_target = reordered(measurement.vicon->T_V_target, design_.vicon.rotation, order);
  }

  /// For the report: what less of a model comes to, with the lens of the whole problem and without motion capture.
  void fit_stages(Calibration calibration) {
    calibration.lens = current_.lens;
    add_arm_stage("mounts", FitStage::kMounts, kMountsScatter, calibration);
    add_arm_stage("mounts and joint offsets", FitStage::kOffsets, kOffsetsScatter, calibration);
    add_arm_stage("with flex and track", FitStage::kFlexAndTrack, kFlexScatter, calibration);
    stages_.push_back({"whole chain", current_});
    vicon_alone_ = fit_vicon(images_, covariances_with_vicon(), current_.vicon.rotation).vicon;
  }

  void add_arm_stage(const std::string& name, FitStage stage, const Scatter& scatter, Calibration& calibration) {
    FitSettings settings;
    settings.stage = stage;
    settings.is_lens_free = false;
    settings.is_vicon_used = false;
    settings.arms = scatter;
    const FitResult fit = fit_chain(board_, T_T_B_, images_, calibration, settings);
    if (!fit.is_usable) throw std::runtime_error("the fit does not converge: " + name);
    report(fmt::format("{}: {} iterations", name, fit.iterations));
    calibration = fit.calibration;
    stages_.push_back({name, calibration});
  }

  void fit_whole_chain() {
    FitSettings settings;
    settings.arms = kChainScatter;
    settings.vicon = kViconScatter;
    for (int round = 0; round < 3; ++round) {
      current_.vicon.T_V_L = vicon_of_laboratory(images_, current_);
      whole_ = fit_chain(board_, T_T_B_, images_, current_, settings);
      if (!whole_.is_usable) throw std::runtime_error("the fit of the whole chain does not converge");
      current_ = whole_.calibration;
      pose_images(current_);
      if (current_.vicon.rotation != design_.vicon.rotation)
        for (FitImage& image : images_) reorder(image.measurement, current_.vicon.rotation);
      estimate_scatters(settings);
      report(
          fmt::format("whole chain: {} iterations, cost {:.0f}; arms {:.4f} {:.4f} deg {:.2f} mm, motion capture "
                      "{:.3f} {:.3f} deg {:.2f} mm",
                      whole_.iterations, whole_.cost, deg(settings.arms.camera_rad), deg(settings.arms.target_rad),
                      1e3 * settings.arms.place_m, deg(settings.vicon.camera_rad), deg(settings.vicon.target_rad),
                      1e3 * settings.vicon.place_m));
    }
    set_covariances(settings);
  }

  static double deg(double rad) { return rad * 180.0 / 3.14159265358979323846; }

  void estimate_scatters(FitSettings& settings) const {
    std::vector<ScatterSample> arms, vicon;
    for (std::size_t k = 0; k < images_.size(); ++k) {
      const Isometry3d by_arms = T_C_T_of_arms(current_, images_[k].measurement.posture);
      arms.push_back({by_arms, pose_difference(by_arms, images_[k].T_C_T), covariances_[k]});
    }
    settings.arms = estimate_scatter(arms, settings.arms);
    for (const FitImage& image : images_) {
      if (!image.measurement.vicon) continue;
      const Isometry3d by_arms = T_C_T_of_arms(current_, image.measurement.posture);
      const Isometry3d by_vicon =
          T_C_T_of_vicon(current_, image.measurement.vicon->T_V_camera, image.measurement.vicon->T_V_target);
      vicon.push_back(
          {by_arms, pose_difference(by_arms, by_vicon),
           scatter_covariance(settings.arms, by_arms) + posterior_of_difference(whole_, image.measurement.posture)});
    }
    settings.vicon = estimate_scatter(vicon, settings.vicon);
  }

  /// Means over the fitted postures, translations divided by the range.
  void set_covariances(const FitSettings& settings) {
    Matrix6 arms = Matrix6::Zero(), vicon = Matrix6::Zero();
    for (const FitImage& image : images_) {
      const Isometry3d T = T_C_T_of_arms(current_, image.measurement.posture);
      Matrix6 by_range = Matrix6::Identity();
      by_range.bottomRightCorner<3, 3>() /= T.translation().norm();
      const Matrix6 of_arms =
          posterior_of_difference(whole_, image.measurement.posture) + scatter_covariance(settings.arms, T);
      arms += by_range * of_arms * by_range;
      vicon += by_range * scatter_covariance(settings.vicon, T) * by_range;
    }
    const auto count = static_cast<double>(images_.size());
    arms /= count;
    vicon /= count;
    current_.covariance.arms = 0.5 * (arms + arms.transpose());
    current_.covariance.vicon = 0.5 * (vicon + vicon.transpose());
    current_.covariance.vicon *= vicon_excess();
  }

  /// Student's t takes the core of a distribution and leaves its shoulders out: the median of chi-square of the
  /// difference of both sources over its value for six degrees of freedom, which the gate of fusion assumes.
  [[nodiscard]] double vicon_excess() const {
    constexpr double kMedian = 5.348;
    std::vector<double> squares;
    for (const FitImage& image : images_) {
      FusedPose fused;
      if (pose_of_source(current_, Source::kFused, image.measurement, &fused)) squares.push_back(fused.chi_square);
    }
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::ranges::nth_element(squares, middle);
    return std::max(1.0, *middle / kMedian);
  }

  TestbedFit finish() {
    TestbedFit result;
    std::vector<Measurement> judged = measurements_.judged;
    if (current_.vicon.rotation != design_.vicon.rotation)
      for (Measurement& measurement : judged) reorder(measurement, current_.vicon.rotation);
    const auto judge = [&](const Calibration& calibration, Source source) {
      return evaluate(calibration, source, board_, T_T_B_, judged);
    };
    for (const auto& [name, calibration] : stages_)
      current_.figures.push_back(figures_of("arms, " + name, judge(calibration, Source::kArms)));
    Calibration alone = current_;
    alone.vicon = vicon_alone_;
    current_.figures.push_back(figures_of("motion capture alone", judge(alone, Source::kVicon)));
    result.arms = judge(current_, Source::kArms);
    result.vicon = judge(current_, Source::kVicon);
    result.fused = judge(current_, Source::kFused);
    current_.figures.push_back(figures_of("motion capture, whole problem", result.vicon));
    current_.figures.push_back(figures_of("fused", result.fused));
    result.calibration = current_;
    return result;
  }

  struct Stage {
    std::string name;
    Calibration calibration;
  };

  const CalibrationMeasurements& measurements_;
  const Progress& progress_;
  BoardDesign board_;
  Isometry3d T_T_B_;
  Calibration design_, current_;
  ViconCalibration vicon_alone_;
  std::vector<FitImage> images_;
  std::vector<Matrix6> covariances_;  ///< covariances of the poses by the images
  std::vector<Stage> stages_;
  FitResult whole_;
};

}  // namespace

TestbedFit fit_testbed(const TestbedDesign& bench, const LensCalibration& lens,
                       const CalibrationMeasurements& measurements, const Progress& progress) {
  return BenchFitter(bench, lens, measurements, progress).run();
}

}  // namespace vbar::tron::calibrate
