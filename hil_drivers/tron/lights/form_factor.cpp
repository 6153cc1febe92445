#include "hil_drivers/tron/lights/form_factor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

namespace vbar::tron {
namespace {

using fsw::Vector3;

/// Corners relative to the point, of the part above its horizon: Sutherland and Hodgman (1974).
std::vector<Vector3> above_horizon(const Vector3& point, const Vector3& normal, std::span<const Vector3> corners) {
  std::vector<Vector3> part;
  part.reserve(corners.size() + 1);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector3 here = corners[k] - point, next = corners[(k + 1) % corners.size()] - point;
    const double height = normal.dot(here), height_next = normal.dot(next);
    if (height >= 0.0) part.push_back(here);
    if ((height > 0.0 && height_next < 0.0) || (height < 0.0 && height_next > 0.0))
      part.push_back(here + height / (height - height_next) * (next - here));
  }
  return part;
}

}  // namespace

double form_factor(const Vector3& point, const Vector3& normal, std::span<const Vector3> corners) {
  if (corners.size() < 3) return 0.0;
  const Vector3 bright_side = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(bright_side.dot(point - corners[0]) > 0.0)) return 0.0;
  const std::vector<Vector3> part = above_horizon(point, normal, corners);
  double sum = 0.0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const Vector3 &here = part[k], &next = part[(k + 1) % part.size()];
    const Vector3 axis = next.cross(here);  // anticlockwise from the bright side is clockwise from the point
    const double sine = axis.norm();
    if (sine > 0.0) sum += std::atan2(sine, here.dot(next)) * normal.dot(axis) / sine;
  }
  return std::max(0.0, sum / (2.0 * std::numbers::pi));
}

}  // namespace vbar::tron
