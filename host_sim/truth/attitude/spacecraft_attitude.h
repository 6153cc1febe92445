#pragma once
// Air and sunlight for torques, by the same models, switches and files as for the forces on the orbit.

#include <functional>
#include <memory>
#include <utility>

#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/attitude/attitude_settings.h"
#include "host_sim/truth/attitude/rigid_body.h"
#include "host_sim/truth/attitude/torques.h"
#include "host_sim/truth/forces/drag_force.h"
#include "host_sim/truth/forces/radiation_pressure.h"

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

// Makes the attitude of one spacecraft from its settings and from what surrounds it.

/// Inputs of the attitude models. Those that the settings of a spacecraft do not require may be empty.
struct AttitudeSurroundings {
  double gm = 0.0;         ///< gravitational parameter of the Earth, m^3/s^2
  double tolerance = 0.0;  ///< tolerance of the integration (RigidBody)
  double seconds = 0.0;    ///< now
  RigidBody::OrbitOfTime orbit;
  std::unique_ptr<Air> air;
  std::unique_ptr<Sunlight> sunlight;
  MotionOfTime own;
  MotionOfTime other;  ///< motion of the spacecraft pointed at
  SunOfTime sun;
};

/// Throws std::invalid_argument for inconsistent settings, and for settings that require what the surroundings lack.
[[nodiscard]] std::unique_ptr<AttitudeMotion> make_attitude(const AttitudeSettings& settings,
                                                            AttitudeSurroundings surroundings);

}  // namespace vbar::truth
