#pragma once
// Partial derivatives of positions with respect to what a fit adjusts.
//
// State-transition matrices come from differences of propagations under a low-degree gravity field. An acceleration's
// partials follow by quadrature: dr(t) = Phi_r(t) int Phi(s)^-1 [0; b(s)] ds, those of an impulse at tb are
// Phi_r(t) Phi(tb)^-1 [0; R_eci_rtn]. As the motion under gravity is Hamiltonian, Phi^-1 = -J Phi^T J (symplectic),
// which is exact and inverts nothing. Their error of parts in a thousand slows the iteration of the fit; its result is
// that of the full forces.

#include <functional>
#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/orbit_fit/dynamics.h"

namespace vbar::orbit_fit {

using Matrix36 = Eigen::Matrix<double, 3, 6>;

class Transition {
 public:
  /// Computes the matrices from the epoch to `nodes_s`, ascending from 0, about `start`; in parallel on `threads`.
  Transition(const FittedDynamics& simplified, const fsw::orbit::CartesianState& start, std::span<const double> nodes_s,
             int threads);

  [[nodiscard]] std::size_t size() const { return nodes_s_.size(); }
  [[nodiscard]] double seconds(std::size_t node) const { return nodes_s_[node]; }
  [[nodiscard]] const fsw::Matrix6& matrix(std::size_t node) const { return matrices_[node]; }

  /// Returns the upper three rows: the position at a node by the state at the epoch.
  [[nodiscard]] Matrix36 of_position(std::size_t node) const { return matrices_[node].topRows<3>(); }

  /// Returns the inverse at a time between the first and the last node, linear between nodes.
  [[nodiscard]] fsw::Matrix6 inverse_at(double seconds) const;

  /// Returns the equivalent change of the state at the epoch, at every node, of an acceleration `direction(node)`:
  /// columns of 6, by the trapezoidal rule from `from_s` to `to_s`.
  [[nodiscard]] std::vector<fsw::Vector6> of_acceleration(const std::vector<fsw::Vector3>& direction, double from_s,
                                                          double to_s) const;

 private:
  std::vector<double> nodes_s_;
  std::vector<fsw::Matrix6> matrices_;
};

/// Returns the change of the state at the epoch that is equivalent to a change of a burn: columns time (s), R, T, N
/// (m/s). `at` is the state at the burn.
[[nodiscard]] Eigen::Matrix<double, 6, 4> burn_at_epoch(const Transition& transition, const Burn& burn,
                                                        const fsw::orbit::CartesianState& at);

/// Calls `work` for 0 to `count` - 1 from up to `threads` threads; throws the first exception.
void in_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace vbar::orbit_fit
