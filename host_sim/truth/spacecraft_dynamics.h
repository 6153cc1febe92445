#pragma once
// The equations of motion of one spacecraft: Gauss's variational equations driven by a list of forces.
//
// Forces with edges (force.h) act on the side that was set last. The dynamics number the sides over all
// forces; the integration (spacecraft_propagator.h) locates the edges and changes the sides.

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/thrust_force.h"

namespace vbar::truth {

/// One force's share of the acceleration.
struct ForceAcceleration {
  std::string_view force;
  fsw::Vector3 acceleration_eci;  ///< m/s^2
};

/// Wall-clock time spent in one force, or in computations that all of them share.
struct ForceTime {
  std::string_view force;  ///< the force's name, or "frames" for the Earth's rotation, the Sun and the Moon
  double wall_s;
};

/// Regime of the motion: the date from which the forces' interval runs, of each edge whether it is positive, and the
/// longest step (s) that the forces allow there.
struct ForceRegime {
  double seconds = 0.0;
  std::vector<bool> sides;
  double longest_step = std::numeric_limits<double>::infinity();
};

/// Equations of motion of one spacecraft. Not thread-safe: one object per spacecraft.
class SpacecraftDynamics {
 public:
  /// Altitude of re-entry. A spacecraft this low (m, above a sphere of the Earth's radius, so up to 101 km above the
  /// ellipsoid near a pole) has re-entered: no orbit is completed there (perigees of the last orbits of real satellites
  /// lie at 80 to 90 km, McDowell 2018), and free-molecular drag no longer applies.
  static constexpr double kReentryAltitude = 80e3;

  /// Makes the dynamics: `name` for messages; `gm` (m^3/s^2) and `earth_radius` (m) of the central body; forces beside
  /// the point mass.
  SpacecraftDynamics(std::string name, double gm, double earth_radius, EarthRotation earth_rotation,
                     std::vector<std::unique_ptr<Force>> forces);

  /// Returns the rates of the osculating elements [a, ex, ey, i, raan, u] `seconds` after the epoch. Throws
  /// std::domain_error, with the date, if the spacecraft is below kReentryAltitude or its orbit is not an ellipse.
  fsw::Vector6 element_rates(double seconds, const fsw::Vector6& elements);

  /// Returns the sum of all forces, m/s^2 in ECI, beside the point mass: what a Cartesian integration would use. Throws
  /// as element_rates() on re-entry.
  fsw::Vector3 perturbation_eci(double seconds, const fsw::orbit::CartesianState& state);

  /// Returns the shares of the sum, in the forces' order, in the regime of that very instant; the regime set is left
  /// unchanged.
  std::vector<ForceAcceleration> accelerations(double seconds, const fsw::orbit::CartesianState& state);

  /// Number of the edges of all forces, which are numbered consecutively, and the value of one.
  int edge_count() const { return static_cast<int>(edges_.size()); }
  double edge(int index, double seconds, const fsw::orbit::CartesianState& state);

  const ForceRegime& regime() const { return regime_; }
  void set_regime(const ForceRegime& regime);

  /// Enters the regime of an instant.
  void enter_regime_of(double seconds, const fsw::orbit::CartesianState& state);

  /// Crosses an edge: from here on the motion is on the other side of an edge.
  void cross_edge(int index, double seconds, const fsw::orbit::CartesianState& state);

  /// Enters an interval: from here on the motion is in the interval that begins at a jump.
  void enter_interval(double seconds);

  /// Returns the first date after `seconds` at which a force jumps by itself.
  double next_jump_after(double seconds) const;

  /// Adds a burn with a duration, not before the instant of the regime. Throws std::logic_error for a spacecraft whose
  /// burns are impulses, std::invalid_argument for a burn that begins before the last one has ended.
  void add_burn(const ThrustArc& arc);

  /// Returns the inputs of forces and torques at an instant. The Sun and the Moon only if a force needs them or
  /// provide_sun_and_moon() was called.
  ForceInput input_at(double seconds, const fsw::orbit::CartesianState& state);
  void provide_sun_and_moon() { needs_sun_and_moon_ = true; }

  /// Returns the geocentric position of the Sun, m.
  fsw::Vector3 sun_eci_at(double seconds);

  /// Measures the time of each force from now on (which adds some 50 ns per force), or stops measuring.
  void measure_time(bool on);
  std::vector<ForceTime> times() const;

  const std::string& name() const { return name_; }
  double gm() const { return gm_; }
  /// Returns the UTC of an instant, for messages.
  std::string date(double seconds) const;

 private:
  struct EdgeOfForce {
    Force* force;
    int index;
  };

  double longest_step(const ForceInput& input) const;
  fsw::Vector3 timed_perturbation_eci(double seconds, const fsw::orbit::CartesianState& state);
  void check_altitude(double seconds, const fsw::Vector3& position_eci) const;

  std::string name_;
  double gm_;
  double earth_radius_;
  EarthRotation earth_rotation_;
  SunMoonInterpolator sun_moon_;
  std::vector<std::unique_ptr<Force>> forces_;
  ThrustForce* thrust_ = nullptr;  ///< among the forces; null: burns are impulses
  bool needs_sun_and_moon_ = false;
  std::vector<EdgeOfForce> edges_;
  ForceRegime regime_;
  bool measures_time_ = false;
  std::vector<std::int64_t> times_ns_;  ///< the frames' first, then the forces'
};

}  // namespace vbar::truth
