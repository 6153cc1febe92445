#pragma once
// Cost of an impulse, by the thrusters available at a time, and the contact function of that cost
// (Koenig & D'Amico 2020, "Fast Algorithm for Fuel-Optimal Impulsive Control of Linear Systems with Time-Varying
// Cost").
//
// Every cost here is a sum of Euclidean norms over groups of RTN axes: the axes of a group are served by one steerable
// thruster. Its contact function (the support function of the unit sublevel set) is then the largest norm of a group.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/core/types.h"

namespace vbar::fsw::control {

enum class ThrustCost : std::uint8_t {
  kSteerable,        ///< |dv|: one thruster that is steered
  kOrthogonalPairs,  ///< |dv_R| + |dv_T| + |dv_N|: three pairs of thrusters along the RTN axes
  kRadialAndPlane,   ///< |dv_R| + hypot(dv_T, dv_N): a pair along R, one steerable thruster in the plane of T and N
};

/// Set of RTN axes: bit 0 is R, bit 1 T, bit 2 N.
using AxisSet = std::uint8_t;

struct AxisGroups {
  std::array<AxisSet, 3> group{};
  std::size_t count = 0;
};

/// Returns the groups whose norms are summed.
constexpr AxisGroups axis_groups(ThrustCost cost) {
  switch (cost) {
    case ThrustCost::kSteerable:
      return {{0b111}, 1};
    case ThrustCost::kOrthogonalPairs:
      return {{0b001, 0b010, 0b100}, 3};
    case ThrustCost::kRadialAndPlane:
      return {{0b001, 0b110}, 2};
  }
  return {};
}

/// Returns the part of `v` along the axes of `axes`, zero elsewhere.
inline Vector3 masked(const Vector3& v, AxisSet axes) {
  return {(axes & 1U) != 0 ? v.x() : 0.0, (axes & 2U) != 0 ? v.y() : 0.0, (axes & 4U) != 0 ? v.z() : 0.0};
}

/// Holds the contact function of a primer vector: its square, and the group that attains it.
struct Contact {
  double squared = 0.0;
  AxisSet axes = 0;
};

inline Contact contact(ThrustCost cost, const Vector3& primer) {
  if (cost == ThrustCost::kSteerable) return {primer.squaredNorm(), 0b111};
  const AxisGroups groups = axis_groups(cost);
  Contact largest;
  for (std::size_t k = 0; k < groups.count; ++k) {
    const double squared = masked(primer, groups.group[k]).squaredNorm();
    if (!(squared <= largest.squared) || k == 0) largest = {squared, groups.group[k]};
  }
  return largest;
}

/// Returns the cost of an impulse.
inline double impulse_cost(ThrustCost cost, const Vector3& dv) {
  const AxisGroups groups = axis_groups(cost);
  double sum = 0.0;
  for (std::size_t k = 0; k < groups.count; ++k) sum += masked(dv, groups.group[k]).norm();
  return sum;
}

}  // namespace vbar::fsw::control
