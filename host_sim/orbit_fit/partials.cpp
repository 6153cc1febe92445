#include "host_sim/orbit_fit/partials.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <thread>

#include "fsw/orbit/rtn.h"

namespace vbar::orbit_fit {

namespace {

using fsw::Matrix6;
using fsw::Vector3;
using fsw::Vector6;
using fsw::orbit::CartesianState;

/// Half steps of the differences: the orbit answers linearly to 1e-6 of them, the propagation errs by micrometres.
constexpr double kHalfStep_m = 5.0, kHalfStep_mps = 5e-3;

CartesianState displaced(CartesianState state, int component, double sign) {
  if (component < 3) {
    state.position_eci[component] += sign * kHalfStep_m;
  } else {
    state.velocity_eci[component - 3] += sign * kHalfStep_mps;
  }
  return state;
}

/// Inverse of a symplectic matrix.
Matrix6 symplectic_inverse(const Matrix6& phi) {
  Matrix6 inverse;
  inverse << phi.bottomRightCorner<3, 3>().transpose(), -phi.topRightCorner<3, 3>().transpose(),
      -phi.bottomLeftCorner<3, 3>().transpose(), phi.topLeftCorner<3, 3>().transpose();
  return inverse;
}

}  // namespace

void in_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> failures(count);
  const auto take_work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        failures[i] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int k = 1; k < std::min(threads, static_cast<int>(count)); ++k) helpers.emplace_back(take_work);
    take_work();
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

Transition::Transition(const FittedDynamics& simplified, const CartesianState& start, std::span<const double> nodes_s,
                       int threads)
    : nodes_s_(nodes_s.begin(), nodes_s.end()), matrices_(nodes_s.size()) {
  std::array<std::vector<CartesianState>, 12> displaced_orbits;
  in_parallel(displaced_orbits.size(), threads, [&](std::size_t k) {
    OrbitParameters parameters;
    parameters.start = displaced(start, static_cast<int>(k / 2), k % 2 == 0 ? 1.0 : -1.0);
    displaced_orbits[k] = simplified.propagate(parameters, nodes_s_);
  });
  for (int column = 0; column < 6; ++column) {
    const double step = 2.0 * (column < 3 ? kHalfStep_m : kHalfStep_mps);
    const auto& plus = displaced_orbits[static_cast<std::size_t>(2 * column)];
    const auto& minus = displaced_orbits[static_cast<std::size_t>(2 * column + 1)];
    for (std::size_t node = 0; node < nodes_s_.size(); ++node) {
      matrices_[node].col(column).head<3>() = (plus[node].position_eci - minus[node].position_eci) / step;
      matrices_[node].col(column).tail<3>() = (plus[node].velocity_eci - minus[node].velocity_eci) / step;
    }
  }
}

Matrix6 Transition::inverse_at(double seconds) const {
  const auto behind = std::ranges::upper_bound(nodes_s_, seconds);
  if (behind == nodes_s_.begin()) return symplectic_inverse(matrices_.front());
  if (behind == nodes_s_.end()) return symplectic_inverse(matrices_.back());
  const auto place = static_cast<std::size_t>(behind - nodes_s_.begin());
  const double fraction = (seconds - nodes_s_[place - 1]) / (nodes_s_[place] - nodes_s_[place - 1]);
  return (1.0 - fraction) * symplectic_inverse(matrices_[place - 1]) + fraction * symplectic_inverse(matrices_[place]);
}

std::vector<Vector6> Transition::of_acceleration(const std::vector<Vector3>& direction, double from_s,
                                                 double to_s) const {
  std::vector<Vector6> sums(size(), Vector6::Zero());
  const auto integrand = [&](std::size_t node) -> Vector6 {
    return symplectic_inverse(matrices_[node]).rightCols<3>() * direction[node];
  };
  Vector6 before = integrand(0);
  for (std::size_t node = 1; node < size(); ++node) {
    const Vector6 here = integrand(node);
    const double overlap = std::min(nodes_s_[node], to_s) - std::max(nodes_s_[node - 1], from_s);
    sums[node] = sums[node - 1];
    if (overlap > 0.0) sums[node] += 0.5 * overlap * (before + here);
    before = here;
  }
  return sums;
}

Eigen::Matrix<double, 6, 4> burn_at_epoch(const Transition& transition, const Burn& burn, const CartesianState& at) {
  const fsw::Matrix3 R_eci_rtn = fsw::orbit::R_rtn_eci(at).transpose();
  const Vector3 rate = at.position_eci.cross(at.velocity_eci) / at.position_eci.squaredNorm();
  const Vector3 dv = R_eci_rtn * burn.dv_rtn;
  // A later impulse leaves the position behind by dv a second, and its direction has rotated with RTN.
  Eigen::Matrix<double, 6, 4> change;
  change << -dv, fsw::Matrix3::Zero(), rate.cross(dv), R_eci_rtn;
  return transition.inverse_at(burn.seconds) * change;
}

}  // namespace vbar::orbit_fit
