#include "host_sim/truth/forces/gravity_force.h"

#include <stdexcept>
#include <utility>

namespace vbar::truth {

GravityForce::GravityForce(std::shared_ptr<const GravityField> field) : field_(std::move(field)) {
  if (!field_) throw std::invalid_argument("the gravity force needs a field");
}

fsw::Vector3 GravityForce::acceleration_eci(const ForceInput& input) {
  return input.R_itrf_gcrf.transpose() * field_->perturbation_itrf(input.position_itrf);
}

}  // namespace vbar::truth
