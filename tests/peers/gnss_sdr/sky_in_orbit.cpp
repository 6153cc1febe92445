#include "tests/peers/gnss_sdr/sky_in_orbit.h"

#include <array>
#include <utility>

#include <Eigen/Dense>

#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/signal_path.h"
#include "tests/support/gnss_scene.h"

namespace vbar::test {
namespace {

using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;
using grand::bench::RangePolynomial;
using grand::bench::RfBlock;
using grand::bench::RfSignal;
using twins::gnss::Signal;
using twins::gnss::System;

constexpr int kNodes = 6;
constexpr double kBlock_s = 0.1;
constexpr double kSpacing_s = kBlock_s / (kNodes - 1);

using Nodes = Eigen::Matrix<double, kNodes, 1>;

// Through values at the nodes: the differences against the first value are interpolated, which keeps the digits.
RangePolynomial through(const Nodes& values) {
  static const Eigen::Matrix<double, kNodes, kNodes> kInverse = [] {
    Eigen::Matrix<double, kNodes, kNodes> powers;
    for (int row = 0; row < kNodes; ++row)
      for (int column = 0; column < kNodes; ++column) powers(row, column) = std::pow(row, column);
    return Eigen::Matrix<double, kNodes, kNodes>(powers.inverse());
  }();
  const Nodes scaled = kInverse * (values.array() - values[0]).matrix();
  RangePolynomial polynomial;
  double unit = 1.0;
  for (int k = 0; k < kNodes; ++k) {
    polynomial.coefficients[static_cast<std::size_t>(k)] = scaled[k] / unit;
    unit *= kSpacing_s;
  }
  polynomial.coefficients[0] += values[0];
  return polynomial;
}

}  // namespace

SkyInOrbit::SkyInOrbit(std::shared_ptr<const twins::gnss::Constellation> constellation, const Vector3& offset_rtn_m)
    : constellation_(std::move(constellation)),
      offset_rtn_m_(offset_rtn_m),
      pattern_(twins::gnss::AntennaPattern::load(data_directory())) {}

Vector3 SkyInOrbit::antenna_ecef(double t_s) const {
  const BodyTruth body = in_orbit(t_s, offset_rtn_m_);
  return body.R_ecef_eci * body.position_eci;
}

SkyInOrbit::Ranges SkyInOrbit::ranges(std::size_t index, double t_s) const {
  const BodyTruth body = in_orbit(t_s, offset_rtn_m_);
  twins::gnss::AntennaState antenna;
  antenna.time = kGnssStart;
  antenna.offset_s = t_s;
  antenna.position_ecef = body.R_ecef_eci * body.position_eci;
  antenna.boresight_ecef = antenna.position_ecef.normalized();
  const auto path = visible_path(*constellation_, index, antenna, settings_.visibility);
  if (!path) return {};
  const double ionosphere_m =
      klobuchar_delay_in_orbit_m(constellation_->corrections().klobuchar, antenna.position_ecef, path->line_of_sight,
                                 week_time(System::kGps, kGnssStart).seconds_of_week() + t_s);
  const double common_m = path->range_m + path->shapiro_m - kSpeedOfLight * path->satellite_clock_s;
  const double attenuation_db = pattern_.attenuation_db(path->line_of_sight.dot(antenna.boresight_ecef));
  return {.carrier_m = common_m - ionosphere_m,
          .code_m = common_m + ionosphere_m + kSpeedOfLight * constellation_->group_delay_s(index),
          .cn0_dbhz = carrier_to_noise_dbhz(settings_.link_budget, Signal::kGpsL1, path->range_m, attenuation_db),
          .visible = true};
}

RfBlock SkyInOrbit::block(int number) {
  const double begin_s = kBlock_s * number;
  RfBlock block{.begin = kGnssStart + fsw::nearest_duration(begin_s), .snapped = false, .signals = {}};
  for (std::size_t index = 0; index < constellation_->size(); ++index) {
    if (constellation_->id(index).system != System::kGps) continue;
    Nodes carrier_m;
    Nodes code_m;
    Ranges at;
    for (int node = 0; node < kNodes; ++node) {
      at = ranges(index, begin_s + kSpacing_s * node);
      if (!at.visible) break;
      carrier_m[node] = at.carrier_m;
      code_m[node] = at.code_m;
    }
    if (!at.visible) continue;
    RfSignal& signal = block.signals.emplace_back();
    signal.satellite = constellation_->id(index);
    signal.carrier_m = through(carrier_m);
    signal.code_m = through(code_m);
    signal.cn0_dbhz = at.cn0_dbhz;
  }
  return block;
}

}  // namespace vbar::test
