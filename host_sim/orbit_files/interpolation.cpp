#include "host_sim/orbit_files/interpolation.h"

#include <algorithm>
#include <span>
#include <vector>

namespace vbar::orbit_files {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;

constexpr std::size_t kStates = 4;
constexpr std::size_t kPositions = 10;
constexpr std::size_t kMinPositions = 6;

/// Newton's divided differences: nodes may occur twice, with a derivative.
struct Newton {
  std::vector<double> nodes_s;
  std::vector<Vector3> coefficients;

  /// Value and derivative at `t_s`, by Horner's scheme.
  [[nodiscard]] CartesianState at(double t_s) const {
    Vector3 value = coefficients.back(), derivative = Vector3::Zero();
    for (std::size_t k = coefficients.size() - 1; k-- > 0;) {
      derivative = derivative * (t_s - nodes_s[k]) + value;
      value = value * (t_s - nodes_s[k]) + coefficients[k];
    }
    CartesianState state;
    state.position_eci = value;
    state.velocity_eci = derivative;
    return state;
  }
};

Newton polynomial_through(std::span<const TimedState> states, fsw::GpsTime origin, bool has_velocities) {
  Newton newton;
  std::vector<Vector3> column, velocities;
  const std::size_t copies = has_velocities ? 2 : 1;
  for (const TimedState& one : states)
    for (std::size_t k = 0; k < copies; ++k) {
      newton.nodes_s.push_back(fsw::seconds(one.time - origin));
      column.push_back(one.state.position_eci);
      velocities.push_back(one.state.velocity_eci);
    }
  newton.coefficients.push_back(column.front());
  for (std::size_t order = 1; order < newton.nodes_s.size(); ++order) {
    for (std::size_t k = 0; k + order < newton.nodes_s.size(); ++k) {
      const double width_s = newton.nodes_s[k + order] - newton.nodes_s[k];
      column[k] = width_s == 0.0 ? velocities[k] : Vector3((column[k + 1] - column[k]) / width_s);
    }
    newton.coefficients.push_back(column.front());
  }
  return newton;
}

/// The `count` states about `time`, fewer if there are fewer.
std::span<const TimedState> states_about(const Track& track, fsw::GpsTime time, std::size_t count) {
  const std::span<const TimedState> all(track.states);
  count = std::min(count, all.size());
  const auto behind = std::ranges::upper_bound(all, time, {}, &TimedState::time);
  const auto place = static_cast<std::size_t>(behind - all.begin());
  const std::size_t begin = place < count / 2 ? 0 : std::min(place - count / 2, all.size() - count);
  return all.subspan(begin, count);
}

bool has_gap(const Track& track, std::span<const TimedState> states) {
  if (track.largest_step_s <= 0.0) return false;
  for (std::size_t k = 1; k < states.size(); ++k)
    if (fsw::seconds(states[k].time - states[k - 1].time) > track.largest_step_s) return true;
  return false;
}

}  // namespace

std::optional<CartesianState> interpolated(const Track& track, fsw::GpsTime time) {
  const auto exact = std::ranges::find(track.states, time, &TimedState::time);
  if (exact != track.states.end() && track.has_velocities) return exact->state;
  const auto states = states_about(track, time, track.has_velocities ? kStates : kPositions);
  if (states.size() < (track.has_velocities ? 2 : kMinPositions) || has_gap(track, states)) return std::nullopt;
  return polynomial_through(states, time, track.has_velocities).at(0.0);
}

}  // namespace vbar::orbit_files
