#pragma once
// The Earth's gravity beyond the point mass, as a force.

#include <memory>

#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/gravity_field.h"

namespace vbar::truth {

class GravityForce final : public Force {
 public:
  /// Makes the force; `field` is shared between spacecraft and must not be null.
  explicit GravityForce(std::shared_ptr<const GravityField> field);

  std::string_view name() const override { return "gravity"; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

 private:
  std::shared_ptr<const GravityField> field_;
};

}  // namespace vbar::truth
