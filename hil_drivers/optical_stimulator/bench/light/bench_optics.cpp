#include "hil_drivers/optical_stimulator/bench/light/bench_optics.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace vbar::optical_stimulator::bench {

using fsw::Matrix2;
using fsw::Matrix3;
using fsw::Vector2;
using fsw::Vector3;

namespace {

Matrix3 rotation(const Vector3& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Matrix3::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

}  // namespace

struct BenchOptics::Ray {
  Vector2 plane;             ///< before distortion
  Vector2 direction;         ///< (x, y, 1), bench axes
  double defocus_mm;         ///< defocus of this point of the tilted display
  double growth;             ///< growth of an area by distortion
  double light;              ///< relative, of the field
  Vector3 direction_camera;  ///< any length
};

BenchOptics::BenchOptics(const LensPair& lenses, const DisplayPose& pose, const OpticsErrors& errors,
                         const ErrorField& field, const twins::camera::CameraSettings& camera, int display_width,
                         int display_height)
    : lenses_(lenses),
      pose_(pose),
      errors_(errors),
      field_(&field),
      camera_(camera),
      lens_(camera),
      middle_(0.5 * (display_width - 1), 0.5 * (display_height - 1)) {
  R_display_ = rotation(1e-3 * Vector3(pose.tilt_mrad[0], pose.tilt_mrad[1], 0.0)) *
               rotation(1e-3 * Vector3(0.0, 0.0, pose.turn_mrad));
  R_camera_ =
      rotation(1e-3 * Vector3(errors.camera_turn_mrad[0], errors.camera_turn_mrad[1], errors.camera_turn_mrad[2]));
  BenchState nominal;
  nominal.separation_mm = lenses.separation_mm;
  nominal.display_mm = lenses.infinity_mm();
  set_state(nominal);
}

void BenchOptics::set_state(const BenchState& state) {
  state_ = state;
  lenses_.separation_mm = state.separation_mm;
  focal_length_mm_ = lenses_.focal_length_mm();
  defocus_mm_ = state.display_mm - lenses_.infinity_mm();
}

BenchOptics::Ray BenchOptics::ray(double u, double v) const {
  const double pitch_mm = 1e-3 * pose_.pitch_um * (1.0 + 1e-6 * state_.scale_ppm);
  const Vector3 on_display(pitch_mm * (u - middle_.x()), pitch_mm * (v - middle_.y()), 0.0);
  Vector3 point = R_display_ * on_display;
  Ray ray;
  ray.defocus_mm = defocus_mm_ + point.z();
  point.x() += pose_.shift_mm[0] + 1e-3 * state_.display_moved_um[0];
  point.y() += pose_.shift_mm[1] + 1e-3 * state_.display_moved_um[1];
  ray.plane = point.head<2>() / (focal_length_mm_ + ray.defocus_mm);
  const auto& [k1, k2, p1, p2] = errors_.distortion;
  const double x = ray.plane.x(), y = ray.plane.y(), r2 = ray.plane.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * k2);
  const double gain = 2.0 * (k1 + 2.0 * r2 * k2);  // derivative of radial, a unit of x and x
  ray.direction = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                   y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  const double xx = radial + gain * x * x + 2.0 * p1 * y + 6.0 * p2 * x;
  const double xy = gain * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
  const double yy = radial + gain * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  ray.growth = std::abs(xx * yy - xy * xy);
  const FieldError error = field_->at(u, v);
  ray.direction += Vector2(error.x, error.y);
  ray.light = 1.0 + error.light;
  ray.direction_camera = R_camera_ * Vector3(ray.direction.x(), ray.direction.y(), 1.0);
  return ray;
}

Vector2 BenchOptics::detector_pixel(double u, double v) const {
  // A display wider than 70 deg off the axis cannot be built with these lenses; it would be seen nowhere.
  return lens_.project(ray(u, v).direction_camera).value_or(Vector2(-1e9, -1e9));
}

SeenPixel BenchOptics::seen(double u, double v) const {
  const Ray ray = this->ray(u, v);
  SeenPixel seen;
  seen.pixel = lens_.project(ray.direction_camera).value_or(Vector2(-1e9, -1e9));
  const double apparent_mm = focal_length_mm_ + ray.defocus_mm;
  const double angle = 1e-3 * pose_.pitch_um * (1.0 + 1e-6 * state_.scale_ppm) / apparent_mm;
  seen.solid_angle = angle * angle * ray.growth * ray.light;
  seen.transmitted = lens_.vignetting(seen.pixel);
  const double pupil_mm = camera_.optics.focal_length_mm / camera_.optics.f_number;
  const double disc_px =
      camera_.focal_length_px() * pupil_mm * std::abs(ray.defocus_mm) / (focal_length_mm_ * focal_length_mm_);
  // The disc's variance, an axis, is a sixteenth of the square of its diameter.
  seen.sigma_px = std::hypot(errors_.point_spread_sigma_px, 0.25 * disc_px);
  const Vector2 principal(camera_.optics.principal_point_px[0], camera_.optics.principal_point_px[1]);
  const double corner_px = 0.5 * std::hypot(camera_.detector.width, camera_.detector.height);
  seen.coma_px = errors_.coma_px / corner_px * (seen.pixel - principal);
  return seen;
}

Vector2 BenchOptics::display_pixel(const Vector2& detector_pixel) const {
  Vector2 place = middle_;
  for (int iteration = 0; iteration < 12; ++iteration) {
    constexpr double kStep = 0.5;
    const Vector2 here = this->detector_pixel(place.x(), place.y());
    const Vector2 miss = here - detector_pixel;
    if (miss.squaredNorm() < 1e-14) break;
    Matrix2 jacobian;
    jacobian.col(0) = (this->detector_pixel(place.x() + kStep, place.y()) - here) / kStep;
    jacobian.col(1) = (this->detector_pixel(place.x(), place.y() + kStep) - here) / kStep;
    place -= jacobian.inverse() * miss;
  }
  return place;
}

}  // namespace vbar::optical_stimulator::bench
