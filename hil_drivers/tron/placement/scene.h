#pragma once
// Content of an image: relative pose and lighting, in the camera's axes.

#include <Eigen/Geometry>

#include "fsw/core/types.h"

namespace vbar::tron {

struct Scene {
  Eigen::Isometry3d T_C_T = Eigen::Isometry3d::Identity();  ///< target in the camera, laboratory lengths
  fsw::Vector3 sun_C = fsw::Vector3::UnitZ();               ///< unit
  fsw::Vector3 earth_C = fsw::Vector3::UnitY();             ///< to the middle of its light, unit
  double earth_half_angle = 1.1;                            ///< angular radius of its disc, rad
  double earth_to_sun = 0.0;  ///< irradiance of an area that faces the Earth to that of one that faces the Sun
  double sunlit = 1.0;        ///< visible fraction of the Sun's disc
};

}  // namespace vbar::tron
