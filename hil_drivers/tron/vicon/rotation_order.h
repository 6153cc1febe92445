#pragma once
// Angles about the axes of motion capture and rotation matrices. In the order "xyz" R = Rx(RotX) Ry(RotY) Rz(RotZ);
// "zyx" is Rz(RotZ) Ry(RotY) Rx(RotX).

#include <array>
#include <string_view>

#include "fsw/core/types.h"

namespace vbar::tron::vicon {

inline constexpr std::array<std::string_view, 6> kRotationOrders{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};

/// Returns the rotation by `angles_rad` about x, y, z, whatever the order. Throws std::invalid_argument for an order
/// that is not in kRotationOrders.
[[nodiscard]] fsw::Matrix3 rotation_of(const std::array<double, 3>& angles_rad, std::string_view order);

/// Returns the angles about x, y, z of a rotation.
[[nodiscard]] std::array<double, 3> angles_of(const fsw::Matrix3& rotation, std::string_view order);

}  // namespace vbar::tron::vicon
