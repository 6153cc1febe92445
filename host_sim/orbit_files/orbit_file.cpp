#include "host_sim/orbit_files/orbit_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fsw/orbit/gravity_field.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::orbit_files {

namespace {

bool is_named(const Track& track, std::string_view object) {
  return track.object == object || track.object_id == object;
}

std::string text_of(fsw::GpsTime time) {
  return truth::format_utc(time, 3);
}

}  // namespace

std::span<const OrbitFormat> orbit_formats() {
  static constexpr std::array kFormats{
      OrbitFormat{"CCSDS OEM (KVN)", is_oem, read_oem},
      OrbitFormat{"CCSDS OPM (KVN)", is_opm, read_opm},
      OrbitFormat{"SP3", is_sp3, read_sp3},
  };
  return kFormats;
}

OrbitFile read_orbits(std::string_view text, const std::string& file) {
  const auto formats = orbit_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return {file, std::string(format->name), format->read(text, file)};
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const OrbitFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("an orbit in one of the formats {}", fmt::join(names, ", ")));
}

OrbitFile load_orbits(const std::filesystem::path& file) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the orbit file", file.string()));
  return read_orbits(stream.view(), file.string());
}

OrbitFile tracks_of(const OrbitFile& file, std::string_view object) {
  OrbitFile one{file.file, file.format, {}};
  std::vector<std::string> names;
  for (const Track& track : file.tracks) {
    if (object.empty() || is_named(track, object)) one.tracks.push_back(track);
    if (std::ranges::find(names, track.object) == names.end()) names.push_back(track.object);
  }
  if (one.tracks.empty())
    throw std::runtime_error(
        fmt::format("{}: has no object {}; it has {}", file.file, files::quoted(object), fmt::join(names, ", ")));
  if (object.empty() && names.size() > 1)
    throw std::runtime_error(
        fmt::format("{}: has {} objects: {}; one must be named", file.file, names.size(), fmt::join(names, ", ")));
  return one;
}

FramedState state_at(const OrbitFile& file, fsw::GpsTime time) {
  const Track* not_useable = nullptr;
  for (const Track& track : file.tracks) {
    if (time < track.states.front().time || time > track.states.back().time) continue;
    if (!track.useable || (track.useable->from <= time && time <= track.useable->to))
      return interpolated(track, time, file.file);
    not_useable = &track;
  }
  if (not_useable != nullptr)
    throw std::out_of_range(fmt::format(
        "{}: no state of {} at {}: its file permits their use from {} to {} (USEABLE_START_TIME, USEABLE_STOP_TIME)",
        file.file, not_useable->object, text_of(time), text_of(not_useable->useable->from),
        text_of(not_useable->useable->to)));
  const Track& first = file.tracks.front();
  const Track& last = file.tracks.back();
  throw std::out_of_range(fmt::format("{}: no state of {} at {}; its states reach from {} to {}", file.file,
                                      first.object, text_of(time), text_of(first.states.front().time),
                                      text_of(last.states.back().time)));
}

fsw::orbit::CartesianState gcrf_state(Frame frame, const fsw::orbit::CartesianState& state,
                                      truth::EarthRotation& rotation, double seconds) {
  if (frame == Frame::kGcrf) return state;
  constexpr double kHalf_s = 0.1;
  const fsw::Matrix3 R = rotation.R_itrf_gcrf_at(seconds);
  const fsw::Matrix3 rate =
      (rotation.R_itrf_gcrf_at(seconds + kHalf_s) - rotation.R_itrf_gcrf_at(seconds - kHalf_s)) / (2.0 * kHalf_s);
  fsw::orbit::CartesianState gcrf;
  gcrf.position_eci = R.transpose() * state.position_eci;
  gcrf.velocity_eci = R.transpose() * state.velocity_eci + rate.transpose() * state.position_eci;
  return gcrf;
}

namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;
using States = std::span<const TimedState>;

constexpr InterpolationRule kOfStates{Polynomial::kHermite, 7}, kOfPositions{Polynomial::kLagrange, 9};
constexpr std::size_t kMinPositions = 6;

/// Newton's divided differences: nodes may occur twice, with a derivative.
struct Newton {
  std::vector<double> nodes_s;
  std::vector<Vector3> coefficients;

  struct Value {
    Vector3 value, derivative;
  };
  /// By Horner's scheme, at time 0.
  [[nodiscard]] Value at_origin() const {
    Value at{coefficients.back(), Vector3::Zero()};
    for (std::size_t k = coefficients.size() - 1; k-- > 0;) {
      at.derivative = at.value - at.derivative * nodes_s[k];
      at.value = coefficients[k] - at.value * nodes_s[k];
    }
    return at;
  }
};

/// `derivatives`: empty, or one for each value.
Newton polynomial_through(const std::vector<double>& times_s, const std::vector<Vector3>& values,
                          const std::vector<Vector3>& derivatives) {
  const std::size_t copies = derivatives.empty() ? 1 : 2;
  Newton newton;
  std::vector<Vector3> column;
  for (std::size_t k = 0; k < values.size(); ++k) {
    newton.nodes_s.insert(newton.nodes_s.end(), copies, times_s[k]);
    column.insert(column.end(), copies, values[k]);
  }
  newton.coefficients.push_back(column.front());
  for (std::size_t order = 1; order < newton.nodes_s.size(); ++order) {
    for (std::size_t k = 0; k + order < newton.nodes_s.size(); ++k) {
      const double width_s = newton.nodes_s[k + order] - newton.nodes_s[k];
      column[k] = width_s == 0.0 ? derivatives[k / copies] : Vector3((column[k + 1] - column[k]) / width_s);
    }
    newton.coefficients.push_back(column.front());
  }
  return newton;
}

CartesianState by_polynomial(States nodes, fsw::GpsTime time, Polynomial polynomial, bool has_velocities) {
  std::vector<double> times_s;
  std::vector<Vector3> positions, velocities;
  for (const TimedState& node : nodes) {
    times_s.push_back(fsw::seconds(node.time - time));
    positions.push_back(node.state.position_eci);
    velocities.push_back(node.state.velocity_eci);
  }
  const bool is_hermite = polynomial == Polynomial::kHermite;
  const Newton::Value at =
      polynomial_through(times_s, positions, is_hermite ? velocities : std::vector<Vector3>()).at_origin();
  const bool has_own = has_velocities && !is_hermite;
  CartesianState state;
  state.position_eci = at.value;
  state.velocity_eci = has_own ? polynomial_through(times_s, velocities, {}).at_origin().value : at.derivative;
  return state;
}

std::size_t node_count(const InterpolationRule& rule) {
  const auto degree = static_cast<std::size_t>(rule.degree);
  return rule.polynomial == Polynomial::kHermite ? degree / 2 + 1 : degree + 1;
}

/// Index of the first state behind `time`.
std::size_t place_of(States states, fsw::GpsTime time) {
  return static_cast<std::size_t>(std::ranges::upper_bound(states, time, {}, &TimedState::time) - states.begin());
}

/// The `count` states about `time`, fewer if there are fewer.
States states_about(States states, fsw::GpsTime time, std::size_t count) {
  count = std::min(count, states.size());
  const std::size_t place = place_of(states, time);
  const std::size_t begin = place < count / 2 ? 0 : std::min(place - count / 2, states.size() - count);
  return states.subspan(begin, count);
}

double step_s(States states, std::size_t k) {
  return fsw::seconds(states[k + 1].time - states[k].time);
}

/// Whether states are missing between `k` and the next one. Files of even steps state them; in others the longer one of
/// the steps beside it decides.
bool is_gap(const Track& track, std::size_t k) {
  constexpr double kLongest = 2.0;  // the steps of an orbit of any eccentricity change less from one to the next
  const States states(track.states);
  const double step = step_s(states, k);
  if (track.largest_step_s > 0.0) return step > track.largest_step_s;
  double beside = 0.0;
  if (k > 0) beside = step_s(states, k - 1);
  if (k + 2 < states.size()) beside = std::max(beside, step_s(states, k + 1));
  return beside > 0.0 && step > kLongest * beside;
}

/// The states about `place` up to the next gap in either direction; `place` is not behind one.
States without_gap(const Track& track, std::size_t place) {
  std::size_t begin = place - 1, end = place;
  while (begin > 0 && !is_gap(track, begin - 1)) --begin;
  while (end < track.states.size() && !is_gap(track, end - 1)) ++end;
  return States(track.states).subspan(begin, end - begin);
}

/// |w| of the nodes (orbit_file.h), as a logarithm: far nodes overflow nothing.
double log_node_product(States nodes, fsw::GpsTime time, Polynomial polynomial) {
  double sum = 0.0;
  for (const TimedState& node : nodes) sum += std::log(std::abs(fsw::seconds(node.time - time)));
  return polynomial == Polynomial::kHermite ? 2.0 * sum : sum;
}

/// Largest errors of the positions and the velocities of states left out and found again.
struct Bound {
  double position_m = 0.0, velocity_mps = 0.0;
};

/// `states`: without a gap, at least three; `nodes`: those of them that interpolate at `time`.
Bound leave_one_out(States states, States nodes, fsw::GpsTime time, const InterpolationRule& rule,
                    bool has_velocities) {
  Bound bound;
  const double log_w = log_node_product(nodes, time, rule.polynomial);
  for (const TimedState& omitted : nodes) {
    if (&omitted == &states.front() || &omitted == &states.back()) continue;  // that would be an extrapolation
    const auto place = static_cast<std::size_t>(&omitted - states.data());
    const std::size_t reach = node_count(rule) + 1, begin = place > reach ? place - reach : 0;
    std::vector<TimedState> others(
        states.begin() + static_cast<std::ptrdiff_t>(begin),
        states.begin() + static_cast<std::ptrdiff_t>(std::min(place + reach, states.size())));
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(place - begin));
    const States used = states_about(others, omitted.time, node_count(rule));
    const CartesianState found = by_polynomial(used, omitted.time, rule.polynomial, has_velocities);
    const double log_ratio = log_w - log_node_product(used, omitted.time, rule.polynomial);
    const double factor = used.size() == nodes.size() ? std::exp(std::max(0.0, log_ratio)) : 1.0;
    const double missed_m = (found.position_eci - omitted.state.position_eci).norm();
    const double missed_mps = (found.velocity_eci - omitted.state.velocity_eci).norm();
    if (!(factor * missed_m <= bound.position_m)) bound.position_m = factor * missed_m;
    if (!(factor * missed_mps <= bound.velocity_mps)) bound.velocity_mps = factor * missed_mps;
  }
  return bound;
}

/// Quarter of the period of a circular orbit at the lower one of two states.
double quarter_revolution_s(const TimedState& before, const TimedState& behind) {
  const double radius_m = std::min(before.state.position_eci.norm(), behind.state.position_eci.norm());
  return 0.5 * std::numbers::pi * std::sqrt(radius_m * radius_m * radius_m / fsw::orbit::kMu);
}

}  // namespace

std::string name_of(const InterpolationRule& rule) {
  return fmt::format("{} polynomial of degree {}", rule.polynomial == Polynomial::kHermite ? "Hermite" : "Lagrange",
                     rule.degree);
}

FramedState interpolated(const Track& track, fsw::GpsTime time, const std::string& file) {
  const auto refuse = [&](const std::string& reason) {
    throw std::out_of_range(
        fmt::format("{}: no state of {} at {}: {}", file, track.object, truth::format_utc(time, 3), reason));
  };
  const States all(track.states);
  const std::size_t place = place_of(all, time);
  const bool is_exact = all[place - 1].time == time;
  if (is_exact && track.has_velocities) return {track.frame, all[place - 1].state, std::nullopt};
  if (all.size() < 2) refuse("its file has one position and no velocity");
  const std::size_t step = is_exact && place > 1 ? place - 2 : place - 1;  // that holds the time
  const double width_s = step_s(all, step);
  if (is_gap(track, step) && !is_exact)
    refuse(fmt::format("its states have a gap from {} to {}", truth::format_utc(all[step].time, 3),
                       truth::format_utc(all[step + 1].time, 3)));
  const InterpolationRule rule = track.published_rule.value_or(track.has_velocities ? kOfStates : kOfPositions);
  const States states = without_gap(track, place);
  const States nodes = states_about(states, time, node_count(rule));
  const std::size_t min_count = track.has_velocities ? 3 : kMinPositions;
  if (states.size() < min_count)
    refuse(fmt::format("{} states without a gap are too few to interpolate and to check it, accepted: {} or more",
                       states.size(), min_count));
  if (width_s > quarter_revolution_s(all[step], all[step + 1]))
    refuse(
        fmt::format("its states are {:.0f} s apart, accepted: up to a quarter of a revolution, {:.0f} s, or a time "
                    "at one of its states",
                    width_s, quarter_revolution_s(all[step], all[step + 1])));
  const Bound bound = leave_one_out(states, nodes, time, rule, track.has_velocities);
  if (!(bound.position_m <= kMaxInterpolationErrorM))
    refuse(
        fmt::format("states about it that are left out are found again from their neighbours, {:.6g} s apart, by "
                    "the {}{} with an error of {:.3g} m, accepted: up to {} m, or a time at one of its states",
                    width_s, name_of(rule), rule.is_published ? " that the file states" : "", bound.position_m,
                    kMaxInterpolationErrorM));
  InterpolationCheck check{rule, width_s, bound.position_m, std::nullopt};
  if (track.has_velocities) check.bound_mps = std::max(bound.velocity_mps, bound.position_m / width_s);
  return {track.frame, by_polynomial(nodes, time, rule.polynomial, track.has_velocities), check};
}

}  // namespace vbar::orbit_files
