#pragma once
// The motion of one spacecraft as a fit adjusts it: the truth's forces and propagator, drag and radiation pressure with
// a scale each, empirical accelerations, and burns.

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/force_list.h"
#include "host_sim/truth/forces/ocean_tides.h"
#include "host_sim/truth/spacecraft_dynamics.h"
#include "host_sim/truth/truth_settings.h"

namespace vbar::orbit_fit {

/// Empirical accelerations (m/s^2) in the spacecraft's RTN, u its argument of latitude: what orbit determination adds
/// for forces that no model has (reduced-dynamic orbits; Montenbruck and Gill 2000, section 8.5).
struct Empirical {
  static constexpr int kCount = 5;
  /// T; T times cos u and sin u; N times cos u and sin u.
  Eigen::Matrix<double, kCount, 1> amplitude = Eigen::Matrix<double, kCount, 1>::Zero();
};

/// Returns the acceleration in ECI of each unit amplitude of Empirical, one a column.
[[nodiscard]] Eigen::Matrix<double, 3, Empirical::kCount> empirical_directions(const fsw::orbit::CartesianState& state);

/// A burn: its centre, its velocity change in the RTN of that instant, and how long it lasts (0: an impulse). Along a
/// longer burn the thrust is constant in RTN.
struct Burn {
  double seconds = 0.0;  ///< after the epoch
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
  double duration_s = 0.0;

  [[nodiscard]] double start_s() const { return seconds - 0.5 * duration_s; }
  [[nodiscard]] double end_s() const { return seconds + 0.5 * duration_s; }
};

/// Values that change from one interval of equal length to the next; the last one holds beyond its end.
template <class Value>
struct Intervals {
  double length_s = 0.0;  ///< 0: one value for all times
  std::vector<Value> values;

  [[nodiscard]] std::size_t place(double seconds) const {
    if (length_s <= 0.0 || seconds <= 0.0) return 0;
    return std::min(static_cast<std::size_t>(seconds / length_s), values.size() - 1);
  }
  [[nodiscard]] double next_after(double seconds) const;
};

/// What a fit adjusts; times count from the epoch, at which the start is.
struct OrbitParameters {
  fsw::orbit::CartesianState start;
  Intervals<double> drag_scale{0.0, {1.0}};
  double radiation_scale = 1.0;
  Intervals<Empirical> empirical{};  ///< without values: none
  std::vector<Burn> burns{};         ///< in order of time
};

/// Propagates spacecraft of one surface under one model of forces from one epoch. Calls from several threads at once
/// are allowed.
class FittedDynamics {
 public:
  /// Loads the data of the forces; `ocean_tides`: those of truth/forces/ocean_tides.h act as well. Throws what
  /// truth::load_force_data and truth::make_forces throw.
  FittedDynamics(truth::TruthSettings settings, const std::string& name, const truth::SurfaceProperties& surface,
                 bool ocean_tides);

  /// Returns the states at `seconds`, ascending from 0. Throws std::domain_error for an orbit that leaves its ellipse
  /// or re-enters.
  [[nodiscard]] std::vector<fsw::orbit::CartesianState> propagate(const OrbitParameters& parameters,
                                                                  std::span<const double> seconds) const;

  /// Returns the dynamics with these parameters but burns of no duration.
  [[nodiscard]] std::unique_ptr<truth::SpacecraftDynamics> dynamics(const OrbitParameters& parameters) const;

  /// Returns the same spacecraft under the gravity field alone up to a low degree: enough for partial derivatives.
  [[nodiscard]] FittedDynamics simplified() const;

  [[nodiscard]] const truth::TruthSettings& settings() const { return settings_; }
  [[nodiscard]] const truth::ForceData& data() const { return data_; }
  [[nodiscard]] const truth::SurfaceProperties& surface() const { return surface_; }

 private:
  truth::TruthSettings settings_;
  std::string name_;
  truth::SurfaceProperties surface_;
  truth::ForceData data_;
  std::shared_ptr<const std::vector<truth::OceanTideWave>> ocean_tides_;  ///< null: none act
};

}  // namespace vbar::orbit_fit
