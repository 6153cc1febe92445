#pragma once
// The mission's start and the data folder, for the tests of the truth.

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/numeric/odeint.hpp>

#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/radiation_pressure.h"
#include "host_sim/truth/orbital_motion.h"
#include "host_sim/truth/spacecraft_dynamics.h"
#include "host_sim/truth/spacecraft_propagator.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/paths.h"

namespace vbar::truth::test {

inline const std::filesystem::path kDataDirectory = std::filesystem::path(vbar::tests::source_path("data"));

inline constexpr double kGm = 3.986004415e14;      // GGM05S
inline constexpr double kEarthRadius = 6378136.3;  // GGM05S
inline constexpr double kDegree = 3.14159265358979323846 / 180.0;

inline fsw::GpsTime mission_epoch() {
  return gps_from_utc("2011-07-18T01:00:00Z");
}

/// The servicer's osculating elements as the mission's table prints them.
inline fsw::orbit::QnsElements servicer_elements() {
  return {7087300.0, 0.0015, -4.17e-8, 98.18 * kDegree, -90.0 * kDegree, -0.69 * kDegree};
}

inline fsw::orbit::CartesianState servicer_state() {
  return orbit_geometry(servicer_elements(), kGm).state;
}

/// A target `along_track_m` ahead of the servicer on the same orbit.
inline fsw::orbit::CartesianState target_state(double along_track_m) {
  fsw::orbit::QnsElements elements = servicer_elements();
  elements.u += along_track_m / elements.a;
  return orbit_geometry(elements, kGm).state;
}

/// Gravity alone, at a tolerance whose errors over the mission stay below the claims of the accuracy tests.
inline TruthSettings mission_settings() {
  TruthSettings settings;
  settings.tolerance = 1e-13;
  settings.epoch = mission_epoch();
  settings.data_directory = kDataDirectory;
  return settings;
}

inline bool same_bits(const fsw::orbit::CartesianState& a, const fsw::orbit::CartesianState& b) {
  return a.position_eci == b.position_eci && a.velocity_eci == b.velocity_eci;
}

// Dynamics with the forces that a test of the truth wants.

inline std::unique_ptr<SpacecraftDynamics> dynamics_with(std::vector<std::unique_ptr<Force>> forces) {
  static const auto orientation = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(kDataDirectory / "earth/eop_2009_2013.csv"));
  return std::make_unique<SpacecraftDynamics>("test", kGm, kEarthRadius, EarthRotation(orientation, mission_epoch()),
                                              std::move(forces));
}

/// J2 about the inertial z axis.
class InertialJ2 final : public Force {
 public:
  std::string_view name() const override { return "inertial J2"; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override {
    constexpr double kJ2 = 1.0826358191967e-3;
    const fsw::Vector3& r = input.position_eci;
    const double d = r.norm(), z2 = 5.0 * r.z() * r.z() / (d * d);
    const double scale = -1.5 * kJ2 * kGm * kEarthRadius * kEarthRadius / std::pow(d, 5);
    return scale * fsw::Vector3(r.x() * (1.0 - z2), r.y() * (1.0 - z2), r.z() * (3.0 - z2));
  }
};

/// 0.02 m^2/kg: the servicer's.
inline SurfaceProperties surface() {
  SurfaceProperties properties;
  properties.mass_kg = 154.0;
  properties.radiation_area_m2 = 2.5;
  properties.radiation_coefficient = 1.32;
  return properties;
}

template <class... Forces>
std::vector<std::unique_ptr<Force>> list(std::unique_ptr<Forces>... forces) {
  std::vector<std::unique_ptr<Force>> all;
  (all.push_back(std::move(forces)), ...);
  return all;
}

inline std::unique_ptr<RadiationPressureForce> sunlight(Shadow shadow) {
  return std::make_unique<RadiationPressureForce>(surface(), shadow);
}

/// The servicer after `seconds`, from the mission's start.
inline fsw::orbit::CartesianState fly(std::vector<std::unique_ptr<Force>> forces, double tolerance, double seconds,
                                      IntegrationStatistics* statistics = nullptr) {
  SpacecraftPropagator propagator(dynamics_with(std::move(forces)), tolerance, 0.0, servicer_state());
  propagator.advance_to(seconds);
  if (statistics != nullptr) *statistics = propagator.statistics();
  return propagator.state();
}

// The mission's spacecraft under every force, for the tests of the whole force model.

inline constexpr SurfaceProperties kMango{154.0, 1.3, 2.5, 2.5, 1.32};

/// Three-hourly indices and a conical shadow: the most jumps and edges there are.
inline constexpr ForceModel kAllForces{.drag = true,
                                       .geomagnetic_index = GeomagneticIndex::kThreeHourly,
                                       .radiation_pressure = true,
                                       .shadow = Shadow::kConical,
                                       .sun = true,
                                       .moon = true,
                                       .solid_tides = true,
                                       .relativity = true};

inline TruthSettings all_forces_settings() {
  TruthSettings settings = mission_settings();
  settings.forces = kAllForces;
  return settings;
}

/// `metres_ahead` of the mission's servicer, on its orbit.
inline SpacecraftSettings mango(const std::string& name = "mango", double metres_ahead = 0.0) {
  return {name, target_state(metres_ahead), kMango};
}

// An independent propagation of the same forces: Newton's equations in Cartesian coordinates (Cowell's method),
// integrated by Boost.Odeint's Fehlberg 7(8).

/// State `to` seconds after the epoch of one that is `from` seconds after it. `tolerance` is the relative local error.
inline fsw::orbit::CartesianState cowell(SpacecraftDynamics& dynamics, const fsw::orbit::CartesianState& state,
                                         double from, double to, double tolerance = 1e-14) {
  using State = std::array<double, 6>;
  using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<State>;
  const auto rates = [&](const State& y, State& rate, double t) {
    fsw::orbit::CartesianState now;
    now.position_eci << y[0], y[1], y[2];
    now.velocity_eci << y[3], y[4], y[5];
    const double r = now.position_eci.norm();
    const fsw::Vector3 acceleration =
        dynamics.perturbation_eci(t, now) - dynamics.gm() / (r * r * r) * now.position_eci;
    for (int i = 0; i < 3; ++i) {
      rate[static_cast<std::size_t>(i)] = now.velocity_eci[i];
      rate[static_cast<std::size_t>(i) + 3] = acceleration[i];
    }
  };
  State y;
  for (int i = 0; i < 3; ++i) {
    y[static_cast<std::size_t>(i)] = state.position_eci[i];
    y[static_cast<std::size_t>(i) + 3] = state.velocity_eci[i];
  }
  // Copied from a static object, whose scratch memory is zero: GCC rightly dislikes copying what was never written.
  static const Stepper stepper;
  boost::numeric::odeint::integrate_adaptive(boost::numeric::odeint::make_controlled(0.0, tolerance, stepper), rates, y,
                                             from, to, 10.0);
  fsw::orbit::CartesianState end;
  end.position_eci << y[0], y[1], y[2];
  end.velocity_eci << y[3], y[4], y[5];
  return end;
}

// A circular orbit about a point mass, in closed form.

inline constexpr double kTwoPi = 2.0 * 3.14159265358979323846;

/// In the plane through the node on the x axis with the given inclination, rad; at the node at time 0.
struct CircularOrbit {
  double radius = 7078e3;
  double inclination = 1.7;

  double mean_motion() const { return std::sqrt(kGm / (radius * radius * radius)); }
  double period() const { return kTwoPi / mean_motion(); }

  fsw::Vector3 at_phase(double phase) const {
    return {std::cos(phase), std::sin(phase) * std::cos(inclination), std::sin(phase) * std::sin(inclination)};
  }
  fsw::Vector3 position(double t) const { return radius * at_phase(mean_motion() * t); }
  fsw::Vector3 velocity(double t) const { return radius * mean_motion() * at_phase(mean_motion() * t + 0.25 * kTwoPi); }
  fsw::Vector3 normal() const { return {0.0, -std::sin(inclination), std::cos(inclination)}; }

  ForceInput operator()(double t) const {
    ForceInput input;
    input.seconds = t;
    input.position_eci = position(t);
    input.velocity_eci = velocity(t);
    return input;
  }
};

}  // namespace vbar::truth::test
