#pragma once
// Random vectors and rotations.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::training {

inline double log_uniform(double low, double high, engine::RandomStream& stream) {
  return low * std::exp(stream.uniform() * std::log(high / low));
}

inline std::size_t index_below(std::size_t count, engine::RandomStream& stream) {
  return std::min(static_cast<std::size_t>(stream.uniform() * static_cast<double>(count)), count - 1);
}

inline fsw::Vector3 normal_vector(engine::RandomStream& stream) {
  const double x = stream.normal(), y = stream.normal(), z = stream.normal();
  return {x, y, z};
}

/// Draws a unit vector uniform on the sphere.
inline fsw::Vector3 unit_vector(engine::RandomStream& stream) {
  return normal_vector(stream).normalized();
}

/// Draws a unit vector uniform on the circle about `axis` (unit).
inline fsw::Vector3 perpendicular(const fsw::Vector3& axis, engine::RandomStream& stream) {
  const fsw::Vector3 v = unit_vector(stream);
  return (v - axis * axis.dot(v)).normalized();
}

/// Draws a unit vector at `angle` (rad) from `axis` (unit), uniform about it.
inline fsw::Vector3 at_angle(const fsw::Vector3& axis, double angle, engine::RandomStream& stream) {
  return std::cos(angle) * axis + std::sin(angle) * perpendicular(axis, stream);
}

/// Draws an attitude uniform on SO(3).
inline Eigen::Quaterniond attitude(engine::RandomStream& stream) {
  const double w = stream.normal(), x = stream.normal(), y = stream.normal(), z = stream.normal();
  return Eigen::Quaterniond(w, x, y, z).normalized();
}

}  // namespace vbar::training
