#include "hil_drivers/tron/bench/vicon/capture_errors.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "hil_drivers/tron/bench/world/draws.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<const char*, kCaptureObjects> kNames{"camera", "target"};
constexpr std::uint64_t kNumbersOfFrame = 6;

std::string stream(const char* error, std::size_t object) {
  return std::string("tron/vicon/") + error + "/" + kNames[object];
}

Matrix3 rotation_by(const Vector3& vector) {
  const double angle = vector.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix() : Matrix3::Identity();
}

/// Any attitude, uniform: Shoemake (1992), "Uniform random rotations".
Matrix3 any_rotation(engine::RandomStream& random) {
  const double share = random.uniform();
  const double a = random.uniform(0.0, 2.0 * std::numbers::pi), b = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double one = std::sqrt(1.0 - share), two = std::sqrt(share);
  return Eigen::Quaterniond(two * std::cos(b), one * std::sin(a), one * std::cos(a), two * std::sin(b))
      .toRotationMatrix();
}

Eigen::Isometry3d object_on_body(const CaptureErrorSizes& sizes, std::uint64_t seed, std::size_t object) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (sizes.object_translation_mm == 0.0) return pose;
  engine::RandomStream random(seed, stream("axes", object));
  pose.linear() = any_rotation(random);
  for (double& component : pose.translation().reshaped())
    component = 1e-3 * sizes.object_translation_mm * random.normal();
  return pose;
}

/// Place, and two of the body's axes, which say its attitude.
BiasField::Place place_of(const Eigen::Isometry3d& pose) {
  BiasField::Place place;
  place << pose.translation(), pose.linear().col(0), pose.linear().col(1);
  return place;
}

BiasField::Place lengths(double place_m, double attitude_rad) {
  BiasField::Place length;
  length << Vector3::Constant(place_m), Vector3::Constant(attitude_rad), Vector3::Constant(attitude_rad);
  return length;
}

BiasField view_bias(const CaptureErrorSizes& sizes, std::uint64_t seed, std::size_t object) {
  return {seed, stream("view", object), sizes.view_rotation_deg * kDegree,
          lengths(sizes.view_length_m, sizes.view_length_deg * kDegree)};
}

}  // namespace

CaptureErrorSizes CaptureErrorSizes::none() {
  CaptureErrorSizes sizes;
  for (const CaptureErrorKey& key : kCaptureErrorKeys)
    if (key.smallest == 0.0) sizes.*key.size = 0.0;
  return sizes;
}

CaptureErrors::CaptureErrors(const CaptureErrorSizes& sizes, std::uint64_t seed)
    : sizes_(sizes),
      seed_(seed),
      T_V_L_(drawn_pose(seed, "tron/vicon/frame", sizes.frame_rotation_deg, sizes.frame_translation_mm)),
      T_body_object_{object_on_body(sizes, seed, 0), object_on_body(sizes, seed, 1)},
      place_bias_m_(seed, "tron/vicon/bias", 1e-3 * sizes.bias_mm,
                    lengths(sizes.bias_length_m, std::numeric_limits<double>::infinity())),
      view_bias_rad_{view_bias(sizes, seed, 0), view_bias(sizes, seed, 1)} {}

Eigen::Isometry3d CaptureErrors::stated(CaptureObject object, const Eigen::Isometry3d& T_L_body,
                                        std::uint64_t frame) const {
  const auto number = static_cast<std::size_t>(object);
  engine::RandomStream noise(seed_, stream("noise", number));
  noise.seek(kNumbersOfFrame * frame);
  Vector3 shift_m, turn_rad;
  for (double& component : shift_m) component = 1e-3 * sizes_.noise_mm * noise.normal();
  for (double& component : turn_rad) component = sizes_.noise_deg * kDegree * noise.normal();
  Eigen::Isometry3d pose = T_L_body * T_body_object_[number];
  const BiasField::Place place = place_of(pose);
  pose.translation() += place_bias_m_.at(place) + shift_m;
  pose.linear() = pose.linear() * rotation_by(view_bias_rad_[number].at(place)) * rotation_by(turn_rad);
  return T_V_L_ * pose;
}

}  // namespace vbar::tron::bench
