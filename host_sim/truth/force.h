#pragma once
// What every force on a spacecraft looks like: one call, one small file each. A force object belongs to one spacecraft
// (it may hold the spacecraft's properties and caches of its own); what is large and constant is shared between them.

#include "fsw/core/types.h"

namespace vbar::truth {

/// The instant and state at which forces are asked for, with what several of them need.
struct ForceInput {
  double seconds = 0.0;  ///< after the model's epoch
  fsw::Vector3 position_eci = fsw::Vector3::Zero();
  fsw::Vector3 velocity_eci = fsw::Vector3::Zero();
  fsw::Matrix3 R_itrf_gcrf = fsw::Matrix3::Identity();
  fsw::Vector3 position_itrf = fsw::Vector3::Zero();
};

class Force {
 public:
  virtual ~Force() = default;

  /// Acceleration, m/s^2, in ECI, beside that of the Earth's point mass.
  virtual fsw::Vector3 acceleration_eci(const ForceInput& input) = 0;
};

}  // namespace vbar::truth
