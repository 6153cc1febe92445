#pragma once
// Batch least squares of an orbit to positions: Gauss-Newton with the truth's forces, positions far off edited.

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fsw/core/types.h"
#include "host_sim/orbit_fit/arc.h"
#include "host_sim/orbit_fit/dynamics.h"
#include "host_sim/orbit_fit/partials.h"

namespace vbar::orbit_fit {

/// What is estimated beside the start and the burns of the parameters.
struct Estimated {
  bool drag_scale = false;  ///< of each of its intervals
  bool radiation_scale = false;
  std::array<bool, 3> burn_axes{true, true, true};  ///< R, T, N of the burns; the others stay as they are
};

/// One adjusted value, in the unit of its name.
struct Estimate {
  std::string name;
  double value = 0.0;
  double sigma = 0.0;
};

struct FittedOrbit {
  OrbitParameters parameters;
  std::vector<Estimate> estimates;                 ///< the start's as corrections in RTN to the first state of the arc
  std::vector<fsw::orbit::CartesianState> states;  ///< at the arc's times
  std::vector<fsw::Vector3> residuals_rtn;         ///< measured less fitted, m
  std::vector<bool> used;                          ///< false: edited
  fsw::Vector3 rms_rtn = fsw::Vector3::Zero();     ///< of the positions used
  double rms_m = 0.0;                              ///< of the distances of the positions used
  std::size_t edited = 0;
  double correlated = 1.0;  ///< number of positions that count as one: residuals next to each other are alike
  int iterations = 0;
  Eigen::MatrixXd design;     ///< of the positions used, in ECI: columns as the estimates, in SI units
  Eigen::VectorXd remainder;  ///< measured less fitted of the same rows
};

/// Sets of positions at the arc's times, in RTN of a fitted orbit.
[[nodiscard]] std::vector<fsw::Vector3> residuals_rtn(const std::vector<fsw::Vector3>& measured_eci,
                                                      const std::vector<fsw::orbit::CartesianState>& states);

class Batch {
 public:
  /// Prepares the partials of the arc. `dynamics` must outlive it.
  Batch(const FittedDynamics& dynamics, Arc arc, int threads);

  /// Fits from `first`, whose burns are estimated with their times (and keep their durations). Sigmas are scaled by the
  /// residuals and by the number of positions that are alike. Throws std::runtime_error where the arc does not
  /// determine a value or the iteration does not converge, std::domain_error for an orbit that is lost.
  [[nodiscard]] FittedOrbit fit(const OrbitParameters& first, const Estimated& estimated) const;

  [[nodiscard]] const Arc& arc() const { return arc_; }
  [[nodiscard]] const Transition& transition() const { return transition_; }
  /// Returns the node of the transition at a position of the arc.
  [[nodiscard]] std::size_t node_of(std::size_t position) const { return node_of_[position]; }
  [[nodiscard]] const FittedDynamics& dynamics() const { return dynamics_; }

 private:
  struct Columns;

  [[nodiscard]] Columns columns_of(const OrbitParameters& parameters, const Estimated& estimated) const;
  template <class Value>
  void set_acceleration(const std::vector<fsw::Vector3>& direction, const Intervals<Value>& intervals,
                        std::size_t place, Columns& columns) const;
  void add_scale_columns(const OrbitParameters& parameters, const Estimated& estimated,
                         const std::vector<fsw::orbit::CartesianState>& states, Columns& columns) const;
  void add_empirical_columns(const OrbitParameters& parameters, const std::vector<fsw::orbit::CartesianState>& states,
                             Columns& columns) const;
  void add_burn_columns(const OrbitParameters& parameters, const Estimated& estimated, Columns& columns) const;
  void state_estimates(const Columns& columns, const Eigen::MatrixXd& root, FittedOrbit& fitted) const;

  const FittedDynamics& dynamics_;
  Arc arc_;
  std::vector<double> nodes_s_;
  std::vector<std::size_t> node_of_;
  Transition transition_;
};

}  // namespace vbar::orbit_fit
