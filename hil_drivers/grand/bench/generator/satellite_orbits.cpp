#include "hil_drivers/grand/bench/generator/satellite_orbits.h"

#include <cmath>
#include <utility>

#include "fsw/gnss/constants.h"

namespace vbar::grand::bench {
namespace {

/// Value and two derivatives of a polynomial of degree five.
struct Values {
  double value, first, second;
};

Values values_of(const double (&c)[truth::kNodePoints], double x) {
  return {c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))),
          c[1] + x * (2.0 * c[2] + x * (3.0 * c[3] + x * (4.0 * c[4] + x * 5.0 * c[5]))),
          2.0 * c[2] + x * (6.0 * c[3] + x * (12.0 * c[4] + x * 20.0 * c[5]))};
}

}  // namespace

SatelliteOrbits::SatelliteOrbits(std::shared_ptr<const twins::gnss::Constellation> constellation, fsw::GpsTime start)
    : constellation_(std::move(constellation)), start_(start), satellites_(constellation_->size()) {}

SatelliteMotion SatelliteOrbits::at(std::size_t index, double time_s) {
  const double intervals = time_s / kInterval_s;
  const double interval = std::floor(intervals);
  const Piece& p = piece(index, static_cast<std::int64_t>(interval));
  const double x = intervals - interval;
  constexpr double kPerSecond = 1.0 / kInterval_s;
  SatelliteMotion motion;
  for (int axis = 0; axis < 3; ++axis) {
    const Values v = values_of(p.coefficients[axis], x);
    motion.position[axis] = v.value;
    motion.velocity[axis] = v.first * kPerSecond;
    motion.acceleration[axis] = v.second * (kPerSecond * kPerSecond);
  }
  const Values clock = values_of(p.coefficients[3], x);
  motion.clock_m = clock.value;
  motion.clock_rate_mps = clock.first * kPerSecond;
  return motion;
}

const SatelliteOrbits::Piece& SatelliteOrbits::piece(std::size_t index, std::int64_t interval) {
  Piece& p = satellites_[index].pieces[static_cast<std::size_t>(interval & 1)];
  if (p.interval == interval) return p;
  double values[kQuantities][truth::kNodePoints];
  for (int k = 0; k < truth::kNodePoints; ++k) {
    const Node& n = node(index, interval + truth::kFirstNode + k);
    for (std::size_t q = 0; q < kQuantities; ++q) values[q][k] = n[q];
  }
  for (std::size_t q = 0; q < kQuantities; ++q) truth::fit_node_polynomial(values[q], p.coefficients[q]);
  p.interval = interval;
  return p;
}

const SatelliteOrbits::Node& SatelliteOrbits::node(std::size_t index, std::int64_t number) {
  Satellite& satellite = satellites_[index];
  const auto slot = static_cast<std::size_t>(number & 7);
  if (satellite.node_numbers[slot] != number) {
    const twins::gnss::SatelliteState state =
        constellation_->true_state(index, start_, static_cast<double>(number) * kInterval_s);
    satellite.nodes[slot] = {state.position_ecef.x(), state.position_ecef.y(), state.position_ecef.z(),
                             fsw::gnss::kSpeedOfLight * state.clock_s};
    satellite.node_numbers[slot] = number;
  }
  return satellite.nodes[slot];
}

}  // namespace vbar::grand::bench
