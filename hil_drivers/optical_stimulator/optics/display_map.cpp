#include "hil_drivers/optical_stimulator/optics/display_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace vbar::optical_stimulator {

namespace {

using fsw::Vector2;

struct Polynomials {
  std::array<double, ChebyshevField::kDegreeMax + 1> value{}, slope{};  // T_n and dT_n by the display coordinate
};

/// T_0 to T_degree at a coordinate, constant beyond the domain.
Polynomials polynomials(double coordinate, double low, double high, int degree) {
  const double half = 0.5 * (high - low), raw = (coordinate - 0.5 * (low + high)) / half;
  const double u = std::clamp(raw, -1.0, 1.0), u_slope = raw == u ? 1.0 / half : 0.0;
  Polynomials p;
  p.value[0] = 1.0;
  if (degree < 1) return p;
  p.value[1] = u;
  p.slope[1] = u_slope;
  for (std::size_t n = 2; n <= static_cast<std::size_t>(degree); ++n) {
    p.value[n] = 2.0 * u * p.value[n - 1] - p.value[n - 2];
    p.slope[n] = 2.0 * (u_slope * p.value[n - 1] + u * p.slope[n - 1]) - p.slope[n - 2];
  }
  return p;
}

template <typename Visit>
void for_each_term(int degree, const Visit& visit) {
  std::size_t term = 0;
  for (int sum = 0; sum <= degree; ++sum)
    for (int j = 0; j <= sum; ++j) visit(term++, static_cast<std::size_t>(sum - j), static_cast<std::size_t>(j));
}

}  // namespace

ChebyshevTerms chebyshev_terms(const ChebyshevField& field, const Vector2& pixel) {
  const Polynomials x = polynomials(pixel.x(), field.low_px.x(), field.high_px.x(), field.degree);
  const Polynomials y = polynomials(pixel.y(), field.low_px.y(), field.high_px.y(), field.degree);
  const std::size_t count = ChebyshevField::term_count(field.degree);
  ChebyshevTerms terms{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
  for_each_term(field.degree, [&](std::size_t term, std::size_t i, std::size_t j) {
    terms.value[term] = x.value[i] * y.value[j];
    terms.by_x[term] = x.slope[i] * y.value[j];
    terms.by_y[term] = x.value[i] * y.slope[j];
  });
  return terms;
}

FieldValue value_of(const ChebyshevField& field, const Vector2& pixel) {
  FieldValue result;
  if (field.degree < 0) return result;
  const Polynomials x = polynomials(pixel.x(), field.low_px.x(), field.high_px.x(), field.degree);
  const Polynomials y = polynomials(pixel.y(), field.low_px.y(), field.high_px.y(), field.degree);
  for_each_term(field.degree, [&](std::size_t term, std::size_t i, std::size_t j) {
    const Vector2 coefficient(field.x_px[term], field.y_px[term]);
    result.offset_px += coefficient * (x.value[i] * y.value[j]);
    result.jacobian.col(0) += coefficient * (x.slope[i] * y.value[j]);
    result.jacobian.col(1) += coefficient * (x.value[i] * y.slope[j]);
  });
  return result;
}

std::array<double, LensTerms::kCount> LensTerms::values() const {
  return {centre_px[0],  centre_px[1],  scale_px,      rotation_rad,  tilt_rad[0],  tilt_rad[1],
          distortion[0], distortion[1], distortion[2], distortion[3], distortion[4]};
}

LensTerms LensTerms::of(const std::array<double, kCount>& values) {
  LensTerms lens;
  lens.centre_px = {values[0], values[1]};
  lens.scale_px = values[2];
  lens.rotation_rad = values[3];
  lens.tilt_rad = {values[4], values[5]};
  lens.distortion = {values[6], values[7], values[8], values[9], values[10]};
  return lens;
}

using fsw::Matrix2;
using fsw::Vector3;

namespace {

/// A number with its derivatives by the two coordinates of the tangent plane.
struct Dual {
  double value = 0.0;
  Vector2 slope = Vector2::Zero();
  Dual() = default;
  Dual(double number) : value(number) {}  // NOLINT(google-explicit-constructor): a constant
  Dual(double number, Vector2 derivative) : value(number), slope(std::move(derivative)) {}
};
Dual operator+(const Dual& a, const Dual& b) {
  return {a.value + b.value, a.slope + b.slope};
}
Dual operator-(const Dual& a, const Dual& b) {
  return {a.value - b.value, a.slope - b.slope};
}
Dual operator-(const Dual& a) {
  return {-a.value, -a.slope};
}
Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.slope * b.value + b.slope * a.value};
}
Dual operator/(const Dual& a, const Dual& b) {
  const double quotient = a.value / b.value;
  return {quotient, (a.slope - b.slope * quotient) / b.value};
}
Dual cos(const Dual& a) {
  return {std::cos(a.value), a.slope * -std::sin(a.value)};
}
Dual sin(const Dual& a) {
  return {std::sin(a.value), a.slope * std::cos(a.value)};
}

}  // namespace

DisplayMap::DisplayMap(const DisplayMapParameters& parameters, const DayCorrection& correction)
    : parameters_(parameters),
      lens_(parameters.lens.values()),
      middle_px_(0.5 * (parameters.width_px - 1), 0.5 * (parameters.height_px - 1)),
      shift_px_(correction.shift_px),
      correction_(correction.scale * Eigen::Rotation2Dd(correction.rotation_rad).toRotationMatrix()),
      radius_limit_(1.2 * corner_radius()),
      focal_length_px_(std::sqrt(std::abs(point_of(Vector2::Zero()).jacobian.determinant()))) {}

double DisplayMap::corner_radius() const {
  const Vector2 centre(lens_[0], lens_[1]);
  double radius_px = 0.0;
  for (const double x : {0.0, parameters_.width_px - 1.0})
    for (const double y : {0.0, parameters_.height_px - 1.0})
      radius_px = std::max(radius_px, (Vector2(x, y) - centre).norm());
  return radius_px / lens_[2];
}

DisplayMap::Point DisplayMap::lens_point(const Vector2& plane) const {
  std::array<Dual, LensTerms::kCount> terms;
  std::copy(lens_.begin(), lens_.end(), terms.begin());
  const auto pixel = lens_pixel(terms.data(), Dual(plane.x(), Vector2::UnitX()), Dual(plane.y(), Vector2::UnitY()));
  Point point;
  point.pixel = {pixel[0].value, pixel[1].value};
  point.jacobian << pixel[0].slope.transpose(), pixel[1].slope.transpose();
  return point;
}

DisplayMap::Point DisplayMap::point_of(const Vector2& plane) const {
  Point point;
  const double radius = plane.norm();
  if (!(radius > radius_limit_)) {
    point = lens_point(plane);
  } else {  // the ray through the limit's circle, continued in proportion
    const double stretch = radius / radius_limit_;
    const Point limit = lens_point(plane / stretch);
    const Vector2 centre(lens_[0], lens_[1]), from_centre = limit.pixel - centre, radial = plane / radius;
    point.pixel = centre + stretch * from_centre;
    point.jacobian = limit.jacobian * (Matrix2::Identity() - radial * radial.transpose()) +
                     from_centre * radial.transpose() / radius_limit_;
  }
  const FieldValue field = value_of(parameters_.field, point.pixel);
  point.pixel = middle_px_ + correction_ * (point.pixel + field.offset_px - middle_px_) + shift_px_;
  point.jacobian = correction_ * (Matrix2::Identity() + field.jacobian) * point.jacobian;
  return point;
}

std::optional<Vector2> DisplayMap::project(const Vector3& direction_camera) const {
  constexpr double kCosine70 = 0.342;
  if (!(direction_camera.z() > kCosine70 * direction_camera.norm())) return std::nullopt;
  return point_of(direction_camera.head<2>() / direction_camera.z()).pixel;
}

Vector2 DisplayMap::image_velocity(const Vector3& direction_camera, const Vector3& rate_camera) const {
  const double z = direction_camera.z();
  const Vector2 plane = direction_camera.head<2>() / z;
  return point_of(plane).jacobian * ((rate_camera.head<2>() - plane * rate_camera.z()) / z);
}

Vector2 DisplayMap::plane_of(const Vector2& pixel) const {
  Vector2 plane = (pixel - Vector2(lens_[0], lens_[1])) / lens_[2];
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Point point = point_of(plane);
    const Vector2 miss = pixel - point.pixel;
    plane += point.jacobian.inverse() * miss;
    if (!(miss.squaredNorm() > 1e-20)) break;
  }
  return plane;
}

Vector3 DisplayMap::direction_of(const Vector2& pixel) const {
  return plane_of(pixel).homogeneous().normalized();
}

double DisplayMap::vignetting(const Vector2&) const {
  return 1.0;
}

}  // namespace vbar::optical_stimulator
