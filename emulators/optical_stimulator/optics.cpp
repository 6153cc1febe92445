#include "emulators/optical_stimulator/optics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "host_sim/engine/random_stream.h"

namespace vbar::optical_stimulator::bench {

namespace {

constexpr double kArcsec = std::numbers::pi / 648000.0;
constexpr int kMargin = 2;  ///< nodes before the first pixel and behind the last
constexpr int kLightWaves = 8;

struct Wave {
  double amplitude, k_u, k_v, phase;

  [[nodiscard]] double at(double u, double v) const { return amplitude * std::cos(k_u * u + k_v * v + phase); }
};

std::vector<Wave> draw_waves(engine::RandomStream stream, int count, double rms, double wave_number) {
  std::vector<Wave> waves;
  const double amplitude = rms * std::sqrt(2.0 / std::max(1, count));
  for (int k = 0; k < count; ++k) {
    const double k_u = wave_number * stream.normal();
    const double k_v = wave_number * stream.normal();
    waves.push_back({amplitude, k_u, k_v, stream.uniform(0.0, 2.0 * std::numbers::pi)});
  }
  return waves;
}

double sum(const std::vector<Wave>& waves, double u, double v) {
  double value = 0.0;
  for (const Wave& wave : waves) value += wave.at(u, v);
  return value;
}

/// Weights of the four nodes about a place `t` steps behind the second (Catmull and Rom 1974).
std::array<double, 4> spline(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t + 2.0 * t2 - t3), 0.5 * (2.0 - 5.0 * t2 + 3.0 * t3), 0.5 * (t + 4.0 * t2 - 3.0 * t3),
          0.5 * (t3 - t2)};
}

}  // namespace

ErrorField::ErrorField(const FieldSettings& settings, std::uint64_t seed, int width, int height)
    : columns_(width / kStep_px + 2 * kMargin + 2), rows_(height / kStep_px + 2 * kMargin + 2) {
  const double rms = settings.direction_arcsec * kArcsec;
  const auto x = draw_waves({seed, "bench/field/x"}, settings.waves, rms, 1.0 / settings.wave_length_px);
  const auto y = draw_waves({seed, "bench/field/y"}, settings.waves, rms, 1.0 / settings.wave_length_px);
  const auto light = draw_waves({seed, "bench/field/light"}, kLightWaves, settings.light, 2.0 / width);
  nodes_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const double u = kStep_px * (column - kMargin), v = kStep_px * (row - kMargin);
      nodes_.push_back({sum(x, u, v), sum(y, u, v), sum(light, u, v)});
    }
  }
}

FieldError ErrorField::at(double u, double v) const {
  const double c = std::clamp(u / kStep_px + kMargin, 1.0, columns_ - 2.001);
  const double r = std::clamp(v / kStep_px + kMargin, 1.0, rows_ - 2.001);
  const auto column = static_cast<std::size_t>(c), row = static_cast<std::size_t>(r);
  const auto wu = spline(c - static_cast<double>(column)), wv = spline(r - static_cast<double>(row));
  FieldError error;
  for (std::size_t j = 0; j < 4; ++j) {
    const FieldError* nodes = &nodes_[(row + j - 1) * static_cast<std::size_t>(columns_) + column - 1];
    FieldError line;
    for (std::size_t i = 0; i < 4; ++i) {
      line.x += wu[i] * nodes[i].x;
      line.y += wu[i] * nodes[i].y;
      line.light += wu[i] * nodes[i].light;
    }
    error.x += wv[j] * line.x;
    error.y += wv[j] * line.y;
    error.light += wv[j] * line.light;
  }
  return error;
}

double DisplayLight::luminance(double count) const {
  if (!(count > first_count)) return 0.0;
  return full_luminance * std::pow((count - first_count) / (255.0 - first_count), gamma);
}

CountTable luminance_table(const DisplayLight& light) {
  CountTable table{};
  for (std::size_t count = 0; count < kCounts; ++count)
    table[count] = static_cast<float>(light.luminance(static_cast<double>(count)));
  return table;
}

double PixelEvenness::of(std::uint64_t pixel) const {
  const double uniform = stream_.uniforms_of(pixel / 4)[pixel % 4];
  return std::max(0.0, 1.0 + sigma_ * engine::normal_quantile(uniform));
}

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
