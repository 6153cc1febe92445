#include "hil_drivers/optical_stimulator/calibration/lens_fit.h"

#include <cmath>

#include <ceres/ceres.h>

namespace vbar::optical_stimulator::calibrate {
namespace {

constexpr int kTerms = static_cast<int>(LensTerms::kCount);

struct Miss {
  fsw::Vector2 plane, display_px;

  template <typename T>
  bool operator()(const T* terms, T* residual) const {
    const auto pixel = lens_pixel(terms, T(plane.x()), T(plane.y()));
    residual[0] = pixel[0] - display_px.x();
    residual[1] = pixel[1] - display_px.y();
    return true;
  }
};

LensTerms sigma_of(ceres::Problem& problem, double* terms, double variance_px2) {
  std::array<double, LensTerms::kCount * LensTerms::kCount> covariance{};
  std::array<double, LensTerms::kCount> sigma{};
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = -1;
  ceres::Covariance estimate(options);
  if (!estimate.Compute({std::pair<const double*, const double*>(terms, terms)}, &problem)) return LensTerms::of(sigma);
  estimate.GetCovarianceBlock(terms, terms, covariance.data());
  for (std::size_t k = 0; k < LensTerms::kCount; ++k)
    sigma[k] = std::sqrt(std::max(0.0, covariance[k * LensTerms::kCount + k]) * variance_px2);
  return LensTerms::of(sigma);
}

}  // namespace

LensFit fit_lens(const std::vector<Dot>& dots, const LensTerms& start, LensFreedom freedom, double outlier_px) {
  std::array<double, LensTerms::kCount> terms = start.values();
  ceres::Problem problem;
  for (const Dot& dot : dots) {
    const fsw::Vector2 plane = dot.direction_camera.head<2>() / dot.direction_camera.z();
    auto* cost = new ceres::AutoDiffCostFunction<Miss, 2, kTerms>(new Miss{plane, dot.display_px});  // Ceres owns it
    problem.AddResidualBlock(cost, new ceres::CauchyLoss(outlier_px), terms.data());
  }
  if (freedom == LensFreedom::kPose)
    problem.SetManifold(terms.data(), new ceres::SubsetManifold(kTerms, {4, 5, 6, 7, 8, 9, 10}));
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  LensFit fit;
  fit.lens = LensTerms::of(terms);
  fit.converged = summary.IsSolutionUsable();
  const double freedoms = std::max(1.0, 2.0 * static_cast<double>(dots.size()) - kTerms);
  fit.sigma = sigma_of(problem, terms.data(), 2.0 * summary.final_cost / freedoms);
  return fit;
}

}  // namespace vbar::optical_stimulator::calibrate
