#pragma once
// Air and sunlight for torques, by the same models, switches and files as for the forces on the orbit.

#include <memory>
#include <utility>

#include "host_sim/truth/attitude/aerodynamic_torque.h"
#include "host_sim/truth/attitude/radiation_torque.h"
#include "host_sim/truth/forces/drag_force.h"
#include "host_sim/truth/forces/radiation_pressure_force.h"

namespace vbar::truth {

/// The air of a drag force.
class AirOfDrag final : public Air {
 public:
  explicit AirOfDrag(std::unique_ptr<DragForce> drag) : drag_(std::move(drag)) {}

  [[nodiscard]] double density(const ForceInput& orbit) override { return drag_->atmosphere_at(orbit).drag_density; }
  [[nodiscard]] double next_jump_after(double seconds) const override { return drag_->next_jump_after(seconds); }
  void enter_interval(double seconds) override { drag_->enter_interval(seconds); }

 private:
  std::unique_ptr<DragForce> drag_;
};

/// The sunlight of a radiation pressure force.
class SunlightOfRadiationPressure final : public Sunlight {
 public:
  explicit SunlightOfRadiationPressure(std::unique_ptr<RadiationPressureForce> pressure)
      : pressure_(std::move(pressure)) {}

  [[nodiscard]] double fraction(const ForceInput& orbit) const override { return pressure_->sunlit_fraction(orbit); }
  [[nodiscard]] int edge_count() const override { return pressure_->edge_count(); }
  [[nodiscard]] double edge(int index, const ForceInput& orbit) const override { return pressure_->edge(index, orbit); }
  void set_side(int index, bool positive) override { pressure_->set_side(index, positive); }

 private:
  std::unique_ptr<RadiationPressureForce> pressure_;
};

}  // namespace vbar::truth
