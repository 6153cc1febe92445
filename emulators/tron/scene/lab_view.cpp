#include "emulators/tron/scene/lab_view.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace vbar::tron::bench {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("a view of the laboratory: " + what);
}

void check_pose(const Eigen::Isometry3d& pose, const char* name) {
  constexpr double kLarge = 100.0;  // m, far outside of any laboratory
  const fsw::Matrix3 R = pose.linear();
  if (!((R * R.transpose() - fsw::Matrix3::Identity()).norm() < 1e-6) || !(R.determinant() > 0.0) ||
      !(pose.translation().norm() < kLarge))
    refuse(std::string("the pose ") + name + " is not a rigid one within 100 m");
}

void check_number(double value, double low, double high, const char* name) {
  if (!(value >= low && value <= high))
    refuse(std::string(name) + " is " + std::to_string(value) + ", not within " + std::to_string(low) + " to " +
           std::to_string(high));
}

void check_camera(const twins::camera::CameraSettings& camera) {
  const auto& optics = camera.optics;
  check_number(optics.focal_length_mm, 1.0, 1000.0, "the focal length, mm,");
  check_number(optics.f_number, 0.5, 100.0, "the f-number");
  check_number(optics.point_spread_sigma_px, 0.2, 20.0, "the point spread, px,");
  check_number(optics.halo_fraction, 0.0, 1.0, "the halo's fraction");
  check_number(optics.halo_sigma_px, 0.2, 50.0, "the halo, px,");
  check_number(camera.detector.pixel_pitch_um, 0.5, 50.0, "the pixel pitch, um,");
  check_number(camera.exposure_s, 1e-7, 100.0, "the exposure, s,");
  check_number(camera.zero_magnitude_photons, 0.0, 1e15, "the photons of magnitude 0");
  for (const double place : optics.principal_point_px) check_number(place, -1e4, 1e4, "the principal point, px,");
  for (const double coefficient : optics.distortion) check_number(coefficient, -10.0, 10.0, "a distortion");
  const auto& region = camera.region;
  const bool is_on = region.x >= 0 && region.y >= 0 && region.width > 0 && region.height > 0 &&
                     region.width <= camera.detector.width - region.x &&
                     region.height <= camera.detector.height - region.y;
  if (!is_on || camera.detector.width > 8192 || camera.detector.height > 8192)
    refuse("the region is empty or not on the detector");
}

}  // namespace

void check_view(const LabView& view) {
  check_pose(view.T_L_C, "of the camera");
  if (view.T_L_board)
    check_pose(*view.T_L_board, "of the board");
  else
    check_pose(view.T_L_T, "of the target");
  check_number(view.lamp.azimuth_rad, -10.0, 10.0, "the lamp's azimuth, rad,");
  check_number(view.lamp.power, 0.0, 10.0, "the lamp's power");
  for (const double power : view.box_powers) check_number(power, 0.0, 10.0, "a box's power");
  for (const Limb& limb : view.arms) {
    for (const fsw::Vector3& end : {limb.from_m, limb.to_m})
      for (int axis = 0; axis < 3; ++axis) check_number(end[axis], -100.0, 100.0, "an end of a limb, m,");
    check_number(limb.radius_m, 1e-4, 10.0, "the radius of a limb, m,");
  }
  check_camera(view.camera);
}

}  // namespace vbar::tron::bench
