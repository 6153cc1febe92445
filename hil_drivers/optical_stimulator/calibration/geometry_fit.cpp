#include "hil_drivers/optical_stimulator/calibration/geometry_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "hil_drivers/optical_stimulator/calibration/procedure.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

constexpr double kLensOutlier_px = 3.0;  // above the fields that no lens model represents, below a wrong dot
constexpr int kDotsMin = 30;

/// A dot as the field sees it.
struct FieldDot {
  Vector2 lens_px;   ///< where the lens terms place it
  Vector2 residual;  ///< what the field has to add, px
};

struct FieldFit {
  ChebyshevField field;
  double sigma_px = 0.0;
};

/// Degree, and weight of the smoothness against the dots.
struct Stiffness {
  int degree;
  double weight;
};

/// The weight of a term's square grows with the fourth power of its degree: a field of few bends is preferred where
/// the dots do not decide.
Eigen::VectorXd smoothness(const Stiffness& stiffness) {
  Eigen::VectorXd weights(static_cast<Eigen::Index>(ChebyshevField::term_count(stiffness.degree)));
  Eigen::Index term = 0;
  for (int sum = 0; sum <= stiffness.degree; ++sum)
    for (int j = 0; j <= sum; ++j) weights[term++] = stiffness.weight * std::pow(sum / 8.0, 4.0);
  return weights;
}

FieldFit fit_field(const std::vector<FieldDot>& dots, ChebyshevField field, const Stiffness& stiffness) {
  field.degree = stiffness.degree;
  const auto terms = static_cast<Eigen::Index>(ChebyshevField::term_count(field.degree));
  if (terms == 0) return {field, 0.0};
  const auto rows = static_cast<Eigen::Index>(dots.size());
  Eigen::MatrixXd design(rows, terms), wanted(rows, 2);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const FieldDot& dot = dots[static_cast<std::size_t>(row)];
    const ChebyshevTerms values = chebyshev_terms(field, dot.lens_px);
    design.row(row) = Eigen::Map<const Eigen::RowVectorXd>(values.value.data(), terms);
    wanted.row(row) = dot.residual.transpose();
  }
  Eigen::MatrixXd normal = design.transpose() * design;
  normal.diagonal() += smoothness(stiffness);
  normal.diagonal().array() += 1e-9 * static_cast<double>(rows);
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
  const Eigen::MatrixXd solution = solver.solve(design.transpose() * wanted);
  field.x_px.assign(solution.col(0).begin(), solution.col(0).end());
  field.y_px.assign(solution.col(1).begin(), solution.col(1).end());
  // rms over the dots of the standard deviation: sigma^2 trace(A N^-1 A^T)/n, the trace being the terms in effect.
  const double effective = (solver.solve(design.transpose() * design)).trace();
  const double freedoms = std::max(1.0, 2.0 * (static_cast<double>(rows) - effective));
  const double variance = (design * solution - wanted).squaredNorm() / freedoms;
  return {field, std::sqrt(variance * effective / static_cast<double>(rows))};
}

double rms_of(const ChebyshevField& field, const std::vector<FieldDot>& dots) {
  double sum = 0.0;
  for (const FieldDot& dot : dots) sum += (dot.residual - value_of(field, dot.lens_px).offset_px).squaredNorm();
  return std::sqrt(sum / (2.0 * static_cast<double>(std::max<std::size_t>(1, dots.size()))));
}

struct Choice {
  Stiffness stiffness;
  double left_out_rms_px;
};

/// By the dots left out. A higher degree has to be better by one part in a hundred.
Choice choose_stiffness(const std::vector<FieldDot>& dots, const ChebyshevField& domain) {
  std::vector<FieldDot> fitted, left_out;
  for (std::size_t k = 0; k < dots.size(); ++k) (k % 3 == 0 ? left_out : fitted).push_back(dots[k]);
  Choice best{{-1, 0.0}, rms_of(domain, left_out)};
  for (const int degree : {2, 4, 6, 8, 10, 12, 14, 16}) {
    if (2 * ChebyshevField::term_count(degree) > fitted.size()) break;
    for (const double weight : {0.0, 0.001, 0.01, 0.1, 1.0}) {
      const Stiffness stiffness{degree, weight};
      const double rms_px = rms_of(fit_field(fitted, domain, stiffness).field, left_out);
      if (rms_px < 0.99 * best.left_out_rms_px) best = {stiffness, rms_px};
    }
  }
  return best;
}

std::vector<FieldDot> field_dots(const std::vector<Dot>& dots, const LensTerms& lens) {
  const auto terms = lens.values();
  std::vector<FieldDot> result;
  for (const Dot& dot : dots) {
    const Vector2 plane = dot.direction_camera.head<2>() / dot.direction_camera.z();
    const auto pixel = lens_pixel(terms.data(), plane.x(), plane.y());
    const Vector2 lens_px(pixel[0], pixel[1]);
    result.push_back({lens_px, dot.display_px - lens_px});
  }
  return result;
}

ChebyshevField domain_of(const std::vector<FieldDot>& dots) {
  ChebyshevField field;
  field.low_px = field.high_px = dots.front().lens_px;
  for (const FieldDot& dot : dots) {
    field.low_px = field.low_px.cwiseMin(dot.lens_px);
    field.high_px = field.high_px.cwiseMax(dot.lens_px);
  }
  return field;
}

/// Without those that the field misses by more than five times the median miss.
std::vector<FieldDot> without_outliers(const std::vector<FieldDot>& dots, const ChebyshevField& field) {
  std::vector<double> misses;
  for (const FieldDot& dot : dots) misses.push_back((dot.residual - value_of(field, dot.lens_px).offset_px).norm());
  std::vector<double> sorted = misses;
  std::sort(sorted.begin(), sorted.end());
  const double limit = 5.0 * sorted[sorted.size() / 2] + 1e-6;
  std::vector<FieldDot> kept;
  for (std::size_t k = 0; k < dots.size(); ++k)
    if (misses[k] <= limit) kept.push_back(dots[k]);
  return kept;
}

}  // namespace

GeometryFit fit_geometry(const std::vector<Dot>& dots, const DisplayMapParameters& start) {
  if (dots.size() < kDotsMin)
    throw std::runtime_error("geometry: " + std::to_string(dots.size()) + " dots were found; at least " +
                             std::to_string(kDotsMin) + " are needed");
  const LensFit lens = fit_lens(dots, start.lens, LensFreedom::kAll, kLensOutlier_px);
  if (!lens.converged) throw std::runtime_error("geometry: the fit of the lens terms did not converge");
  std::vector<FieldDot> left = field_dots(dots, lens.lens);
  const ChebyshevField domain = domain_of(left);
  const Choice first = choose_stiffness(left, domain);
  left = without_outliers(left, fit_field(left, domain, first.stiffness).field);
  const Choice choice = choose_stiffness(left, domain);
  const FieldFit fit = fit_field(left, domain, choice.stiffness);
  return {{start.width_px, start.height_px, lens.lens, fit.field},
          lens.sigma,
          fit.sigma_px,
          choice.left_out_rms_px,
          static_cast<int>(left.size())};
}

std::vector<Residual> residuals_of(const DisplayMap& map, const std::vector<Dot>& dots) {
  std::vector<Residual> residuals;
  for (const Dot& dot : dots) {
    const fsw::Vector3 error = map.direction_of(dot.display_px) - dot.direction_camera;
    // Across the line of sight: angle and length differ by 1e-10 of the length.
    const fsw::Vector3 x_axis = fsw::Vector3::UnitY().cross(dot.direction_camera).normalized();
    const fsw::Vector3 y_axis = dot.direction_camera.cross(x_axis);
    residuals.push_back({dot.camera_px, kArcsecPerRad * Vector2(error.dot(x_axis), error.dot(y_axis))});
  }
  return residuals;
}

ResidualFigures figures_of(const std::vector<Residual>& residuals) {
  if (residuals.empty()) return {};
  std::vector<double> angles;
  double sum = 0.0;
  for (const Residual& residual : residuals) angles.push_back(residual.error_arcsec.norm());
  for (const double angle : angles) sum += angle;
  std::sort(angles.begin(), angles.end());
  const auto count = static_cast<double>(angles.size());
  const auto p95 = std::min(angles.size() - 1, static_cast<std::size_t>(std::ceil(0.95 * count)) - 1);
  return {sum / count, angles[p95], static_cast<int>(angles.size())};
}

std::vector<Residual> in_region(const std::vector<Residual>& residuals, const twins::camera::Region& region) {
  std::vector<Residual> inside;
  for (const Residual& residual : residuals) {
    const Vector2 at = residual.camera_px - Vector2(region.x, region.y);
    if (at.x() >= -0.5 && at.y() >= -0.5 && at.x() < region.width - 0.5 && at.y() < region.height - 0.5)
      inside.push_back(residual);
  }
  return inside;
}

HeldOutResiduals held_out_residuals(const DisplayMapParameters& map, const std::vector<Dot>& dots,
                                    const twins::camera::Region& region) {
  DisplayMapParameters without_field = map;
  without_field.field = {};
  const auto with = residuals_of(DisplayMap(map), dots), without = residuals_of(DisplayMap(without_field), dots);
  HeldOutResiduals result;
  result.region = figures_of(in_region(with, region));
  result.detector = figures_of(with);
  result.region_lens_terms = figures_of(in_region(without, region));
  result.detector_lens_terms = figures_of(without);
  result.goal_reached = result.region.dots > 0 && result.region.mean_arcsec <= kRegionMeanGoal_arcsec &&
                        result.region.p95_arcsec <= kRegionP95Goal_arcsec &&
                        result.detector.mean_arcsec <= kDetectorMeanGoal_arcsec &&
                        result.detector.p95_arcsec <= kDetectorP95Goal_arcsec;
  return result;
}

}  // namespace vbar::optical_stimulator::calibrate
