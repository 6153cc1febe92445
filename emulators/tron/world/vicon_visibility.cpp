#include "emulators/tron/world/vicon_visibility.h"

#include <algorithm>
#include <cmath>

namespace vbar::tron::bench {

using fsw::Vector3;

namespace {

constexpr double kBelowCeiling_m = 0.15;
constexpr double kOffWall_m = 0.05;
/// Retroreflective spheres are seen up to a grazing angle.
constexpr double kMinCosine = 0.1;
/// Markers stand on posts this long, so that the surface below does not hide them.
constexpr double kPost_m = 0.02;

/// Least squared distance of two segments (Ericson 2005, "Real-time collision detection", 5.1.9).
double squared_distance(const Vector3& p, const Vector3& p_end, const Vector3& q, const Vector3& q_end) {
  const Vector3 u = p_end - p, v = q_end - q, w = p - q;
  const double a = u.dot(u), e = v.dot(v), f = v.dot(w), c = u.dot(w), b = u.dot(v);
  double s = 0.0, t = 0.0;
  if (e <= 0.0) {
    s = a > 0.0 ? std::clamp(-c / a, 0.0, 1.0) : 0.0;
  } else if (a <= 0.0) {
    t = std::clamp(f / e, 0.0, 1.0);
  } else {
    const double determinant = a * e - b * b;
    s = determinant > 0.0 ? std::clamp((b * f - c * e) / determinant, 0.0, 1.0) : 0.0;
    t = (b * s + f) / e;
    if (t < 0.0 || t > 1.0) {
      t = std::clamp(t, 0.0, 1.0);
      s = std::clamp((b * t - c) / a, 0.0, 1.0);
    }
  }
  return (w + s * u - t * v).squaredNorm();
}

}  // namespace

bool crosses(const Vector3& from, const Vector3& to, const Capsule& capsule) {
  return squared_distance(from, to, capsule.from, capsule.to) < capsule.radius_m * capsule.radius_m;
}

bool crosses(const Vector3& from, const Vector3& to, const Block& block) {
  const Eigen::Isometry3d T_block_L = block.T_L_block.inverse();
  const Vector3 begin = T_block_L * from, along = T_block_L * to - begin;
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(along[axis]) < 1e-12) {
      if (begin[axis] < block.low_m[axis] || begin[axis] > block.high_m[axis]) return false;
      continue;
    }
    const double low = (block.low_m[axis] - begin[axis]) / along[axis];
    const double high = (block.high_m[axis] - begin[axis]) / along[axis];
    first = std::max(first, std::min(low, high));
    last = std::min(last, std::max(low, high));
  }
  return first < last;
}

ViconVisibility::ViconVisibility(const TestbedDesign& laboratory) {
  const Vector3 &low = laboratory.room_low_m, &high = laboratory.room_high_m;
  constexpr std::size_t kSide = kCameras / 2;
  for (std::size_t k = 0; k < kCameras; ++k) {
    const double share = (static_cast<double>(k % kSide) + 0.5) / static_cast<double>(kSide);
    cameras_[k] = {low.x() + share * (high.x() - low.x()), k < kSide ? low.y() + kOffWall_m : high.y() - kOffWall_m,
                   high.z() - kBelowCeiling_m};
  }
}

std::size_t ViconVisibility::located(const Eigen::Isometry3d& T_L_object, const std::vector<Marker>& markers,
                                     const std::vector<Capsule>& capsules, const std::vector<Block>& blocks) const {
  const auto sees = [&](const Vector3& camera, const Vector3& marker, const Vector3& normal) {
    const Vector3 to_camera = camera - marker;
    return normal.dot(to_camera) > kMinCosine * to_camera.norm() &&
           std::ranges::none_of(capsules, [&](const Capsule& body) { return crosses(marker, camera, body); }) &&
           std::ranges::none_of(blocks, [&](const Block& body) { return crosses(marker, camera, body); });
  };
  return static_cast<std::size_t>(std::ranges::count_if(markers, [&](const Marker& marker) {
    const Vector3 normal = T_L_object.linear() * marker.normal;
    const Vector3 place = T_L_object * marker.at_m + kPost_m * normal;
    const auto seen =
        std::ranges::count_if(cameras_, [&](const Vector3& camera) { return sees(camera, place, normal); });
    return static_cast<std::size_t>(seen) >= kMinCameras;
  }));
}

std::vector<Marker> markers_of_box(const Vector3& low_m, const Vector3& high_m) {
  std::vector<Marker> markers;
  const Vector3 middle = 0.5 * (low_m + high_m);
  for (int corner = 0; corner < 8; ++corner) {
    Vector3 at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = (corner >> axis & 1) != 0 ? high_m[axis] : low_m[axis];
    markers.push_back({at, (at - middle).normalized()});
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_high : {false, true}) {
      Vector3 at = middle;
      at[axis] = is_high ? high_m[axis] : low_m[axis];
      markers.push_back({at, (is_high ? 1.0 : -1.0) * Vector3::Unit(axis)});
    }
  return markers;
}

}  // namespace vbar::tron::bench
