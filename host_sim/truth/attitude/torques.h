#pragma once
// A spacecraft as a rigid body with a surface.

#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/forces/force.h"

namespace vbar::truth {

/// A flat part of the outer surface. Light that it does not reflect is absorbed.
struct Facet {
  double area_m2 = 0.0;
  fsw::Vector3 centre_m = fsw::Vector3::Zero();  ///< centroid, in body axes, from the centre of mass
  fsw::Vector3 normal = fsw::Vector3::Zero();    ///< unit vector outwards, in body axes
  double specular = 0.0;                         ///< fraction of light reflected specularly
  double diffuse = 0.0;                          ///< fraction of light reflected by Lambert's law
};

/// Returns the facet of a plane convex polygon whose corners (m, body axes, from the centre of mass) go anticlockwise
/// seen from outside. Throws std::invalid_argument for fewer than three corners, corners off their plane by more than
/// 1e-6 of the size, or reflectivities that are negative or add to more than 1.
Facet facet_of_polygon(const std::vector<fsw::Vector3>& corners_m, double specular, double diffuse);

struct Body {
  std::string name;
  fsw::Matrix3 inertia_kgm2 = fsw::Matrix3::Zero();      ///< about the centre of mass, in body axes
  fsw::Vector3 centre_of_mass_m = fsw::Vector3::Zero();  ///< from the origin of the body frame
  std::vector<Facet> facets;                             ///< facets of a convex body; empty: its shape is unknown
};

// The interface of every torque on a rigid body: one call, one small file each, as the forces on its orbit
// (forces/force.h). A torque object belongs to one spacecraft.
//
// A torque may jump, as a force may: at an edge (a zero of a function of time and orbit: sunlight ends) or at a date
// known beforehand (the day's solar flux). The integration ends a step exactly there; in between the torque acts as on
// the side, or in the interval, that was set.

class Torque {
 public:
  Torque() = default;
  Torque(const Torque&) = delete;
  Torque& operator=(const Torque&) = delete;
  virtual ~Torque() = default;

  /// Returns the name as in the mission file and in tables: "gravity_gradient", "aerodynamic", "radiation".
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Returns the torque about the centre of mass, N m, in body axes. `orbit`: where the spacecraft is at that instant.
  [[nodiscard]] virtual fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) = 0;

  /// Returns the number of its edges, and the function of time and orbit whose zero edge `index` is.
  [[nodiscard]] virtual int edge_count() const { return 0; }
  [[nodiscard]] virtual double edge(int /*index*/, const ForceInput& /*orbit*/) const { return 1.0; }

  /// Sets the side: from here on (until the next call) the motion is on this side of the edge: edge() positive, or not.
  virtual void set_side(int /*index*/, bool /*positive*/) {}

  /// Returns the first date (seconds after the epoch) after `seconds` at which it jumps by itself.
  [[nodiscard]] virtual double next_jump_after(double /*seconds*/) const {
    return std::numeric_limits<double>::infinity();
  }

  /// Enters the interval in which the motion (re)starts at `seconds`: until the next jump the torque is that of the
  /// interval that begins here.
  virtual void enter_interval(double /*seconds*/) {}
};

// Torque of the gravity gradient over the body: T = 3 gm / r^3 (u x J u), u the unit vector from the Earth's centre
// (Hughes 2004, eq. 8.1.15; Wertz 1978, eq. 17-31). The Earth is a point mass: its oblateness would add a thousandth of
// the torque.

class GravityGradientTorque final : public Torque {
 public:
  /// Makes the torque from `gm` of the Earth in m^3/s^2; `inertia_kgm2` about the centre of mass, in body axes.
  GravityGradientTorque(double gm, const fsw::Matrix3& inertia_kgm2) : gm_(gm), inertia_(inertia_kgm2) {}

  [[nodiscard]] std::string_view name() const override { return "gravity_gradient"; }
  [[nodiscard]] fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) override;

 private:
  double gm_;
  fsw::Matrix3 inertia_;
};

// Torque of the air on a body's facets. Each facet that meets the flow takes from it the momentum of a Newtonian
// (hyperthermal) stream with one drag coefficient: dF = -1/2 rho C_D v^2 A cos(angle) along the flow (Wertz 1978, eq.
// 17-57). So a body's force is that of a cannonball with its projected area; lift, which needs the surface's
// accommodation, and the damping by the body's own rotation (cm/s against km/s) are neglected. Facets do not shade each
// other (a convex body).

/// The air at a spacecraft. Its discontinuities have dates, as those of a torque have.
class Air {
 public:
  Air() = default;
  Air(const Air&) = delete;
  Air& operator=(const Air&) = delete;
  virtual ~Air() = default;

  /// Returns the density, kg/m^3, in the interval entered last.
  [[nodiscard]] virtual double density(const ForceInput& orbit) = 0;

  [[nodiscard]] virtual double next_jump_after(double /*seconds*/) const {
    return std::numeric_limits<double>::infinity();
  }
  virtual void enter_interval(double /*seconds*/) {}
};

class AerodynamicTorque final : public Torque {
 public:
  /// Throws std::invalid_argument without facets or air.
  AerodynamicTorque(std::vector<Facet> facets, double drag_coefficient, std::unique_ptr<Air> air);

  [[nodiscard]] std::string_view name() const override { return "aerodynamic"; }
  [[nodiscard]] fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) override;
  [[nodiscard]] double next_jump_after(double seconds) const override { return air_->next_jump_after(seconds); }
  void enter_interval(double seconds) override { air_->enter_interval(seconds); }

 private:
  std::vector<Facet> facets_;
  double drag_coefficient_;
  std::unique_ptr<Air> air_;
};

/// Returns the velocity with respect to an atmosphere that rotates with the Earth, m/s, in ECI.
[[nodiscard]] fsw::Vector3 velocity_through_air_eci(const ForceInput& orbit);

// Torque of sunlight on a body's facets, each of which absorbs, mirrors and scatters its share (Wertz 1978, eq. 17-52):
//   F = -P A cos(angle) [(1 - specular) s + 2 (specular cos(angle) + diffuse / 3) n],   s to the Sun, n outwards.
// Facets do not shade each other (a convex body). Light from the Earth is neglected.

/// Visible fraction of the Sun. Where it jumps it has an edge, as a torque has.
class Sunlight {
 public:
  Sunlight() = default;
  Sunlight(const Sunlight&) = delete;
  Sunlight& operator=(const Sunlight&) = delete;
  virtual ~Sunlight() = default;

  /// Returns the visible fraction, 0 (eclipse) to 1 (full Sun), on the side last set.
  [[nodiscard]] virtual double fraction(const ForceInput& orbit) const = 0;

  [[nodiscard]] virtual int edge_count() const { return 0; }
  [[nodiscard]] virtual double edge(int /*index*/, const ForceInput& /*orbit*/) const { return 1.0; }
  virtual void set_side(int /*index*/, bool /*positive*/) {}
};

class RadiationTorque final : public Torque {
 public:
  /// Throws std::invalid_argument without facets or sunlight.
  RadiationTorque(std::vector<Facet> facets, std::unique_ptr<Sunlight> sunlight);

  [[nodiscard]] std::string_view name() const override { return "radiation"; }
  [[nodiscard]] fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) override;
  [[nodiscard]] int edge_count() const override { return sunlight_->edge_count(); }
  [[nodiscard]] double edge(int index, const ForceInput& orbit) const override { return sunlight_->edge(index, orbit); }
  void set_side(int index, bool positive) override { sunlight_->set_side(index, positive); }

 private:
  std::vector<Facet> facets_;
  std::unique_ptr<Sunlight> sunlight_;
};

}  // namespace vbar::truth
