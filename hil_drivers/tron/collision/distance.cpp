#include "hil_drivers/tron/collision/distance.h"

#include <algorithm>
#include <cmath>

namespace vbar::tron {
namespace {

using fsw::Vector3;

constexpr double kPoint = 1e-24;  ///< squared length of a segment that is a point
constexpr int kSections = 30;     ///< steps of the golden ratio: 0.618^30 is 5e-7

double point_box_distance(const Vector3& point, const Vector3& half) {
  return (point.cwiseAbs() - half).cwiseMax(0.0).norm();
}

}  // namespace

double segment_distance(const Vector3& a_from, const Vector3& a_to, const Vector3& b_from, const Vector3& b_to) {
  const Vector3 a = a_to - a_from, b = b_to - b_from, r = a_from - b_from;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), br = b.dot(r);
  double s = 0.0, t = 0.0;
  if (aa <= kPoint && bb <= kPoint) return r.norm();
  if (aa <= kPoint) {
    t = std::clamp(br / bb, 0.0, 1.0);
  } else {
    const double ar = a.dot(r);
    if (bb <= kPoint) {
      s = std::clamp(-ar / aa, 0.0, 1.0);
    } else {
      const double ab = a.dot(b), determinant = aa * bb - ab * ab;
      s = determinant > 0.0 ? std::clamp((ab * br - ar * bb) / determinant, 0.0, 1.0) : 0.0;
      t = (ab * s + br) / bb;
      if (t < 0.0) {
        t = 0.0;
        s = std::clamp(-ar / aa, 0.0, 1.0);
      } else if (t > 1.0) {
        t = 1.0;
        s = std::clamp((ab - ar) / aa, 0.0, 1.0);
      }
    }
  }
  return (r + s * a - t * b).norm();
}

double box_distance(const Vector3& from, const Vector3& to, const OrientedBox& box) {
  const Eigen::Isometry3d T_box_L = box.T_L_box.inverse();
  const Vector3 start = T_box_L * from, way = T_box_L.linear() * (to - from);
  // The distance is convex along the segment: section by the golden ratio.
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  const auto distance = [&](double t) { return point_box_distance(start + t * way, box.half_m); };
  double low = 0.0, high = 1.0, x1 = 1.0 - ratio, x2 = ratio, f1 = distance(x1), f2 = distance(x2);
  for (int k = 0; k < kSections; ++k) {
    if (f1 <= f2) {
      high = x2;
      x2 = x1;
      f2 = f1;
      x1 = high - ratio * (high - low);
      f1 = distance(x1);
    } else {
      low = x1;
      x1 = x2;
      f1 = f2;
      x2 = low + ratio * (high - low);
      f2 = distance(x2);
    }
  }
  return std::min({f1, f2, distance(0.0), distance(1.0)});
}

}  // namespace vbar::tron
