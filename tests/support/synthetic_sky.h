#pragma once
// A radio field without a generator: what an antenna on the circular orbit of gnss_scene.h (or on the ground) hears,
// ranges interpolated over 10 s (error below 0.1 mm). C/N0 is the same for all satellites of a signal.

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "emulators/grand/radio_field/rf_block.h"
#include "host_sim/twins/gnss/signal_path.h"
#include "tests/support/gnss_scene.h"

namespace vbar::test {

class SyntheticSky {
 public:
  explicit SyntheticSky(std::shared_ptr<const twins::gnss::Constellation> constellation,
                        fsw::Vector3 offset_rtn_m = fsw::Vector3::Zero())
      : constellation_(std::move(constellation)), offset_rtn_m_(offset_rtn_m), arcs_(constellation_->size()) {}

  std::array<double, twins::gnss::kSignals> cn0_dbhz{45.0, 42.0, 45.0, 45.0};

  [[nodiscard]] fsw::Vector3 position_ecef(double t_s) const { return antenna(t_s).position_ecef; }
  [[nodiscard]] fsw::Vector3 velocity_ecef(double t_s) const { return antenna(t_s).velocity_ecef; }

  /// The block that begins at kGnssStart + number * 100 ms.
  grand::bench::RfBlock block(std::int64_t number) {
    grand::bench::RfBlock block;
    block.begin = kGnssStart + fsw::Duration{number * grand::bench::RfBlock::kLength.ns};
    const std::int64_t knot = number / kBlocksPerArc;
    const double begin_s = static_cast<double>(number % kBlocksPerArc) * 0.1;
    for (std::size_t k = 0; k < arcs_.size(); ++k) {
      refresh(k, knot);
      if (!arcs_[k].visible) continue;
      const auto carrier = shifted(arcs_[k].cubic, begin_s);
      const twins::gnss::SatelliteId id = constellation_->id(k);
      for (std::size_t s = 0; s < twins::gnss::kSignals; ++s) {
        const auto signal = static_cast<twins::gnss::Signal>(s);
        if (twins::gnss::structure(signal).system != id.system) continue;
        auto code = carrier;
        code.coefficients[0] += fsw::gnss::kSpeedOfLight * group_delay_s(k, signal);
        block.signals.push_back({id, signal, carrier, code, cn0_dbhz[s]});
      }
    }
    return block;
  }

 private:
  static constexpr std::int64_t kBlocksPerArc = 100;
  static constexpr double kArc_s = 10.0;

  struct Arc {
    std::int64_t knot = -1;
    bool visible = false;
    std::array<double, 4> cubic{};
  };

  [[nodiscard]] double group_delay_s(std::size_t k, twins::gnss::Signal signal) const {
    constexpr double kGamma = (77.0 / 60.0) * (77.0 / 60.0);
    return constellation_->group_delay_s(k) * (signal == twins::gnss::Signal::kGpsL2 ? kGamma : 1.0);
  }

  [[nodiscard]] twins::gnss::AntennaState antenna(double t_s) const {
    const BodyTruth body = in_orbit(t_s, offset_rtn_m_);
    twins::gnss::AntennaState antenna;
    antenna.time = body.time;
    antenna.position_ecef = body.R_ecef_eci * body.position_eci;
    antenna.velocity_ecef = body.R_ecef_eci * body.velocity_eci -
                            fsw::gnss::kEarthRateGps * fsw::Vector3::UnitZ().cross(antenna.position_ecef);
    antenna.boresight_ecef = antenna.position_ecef.normalized();
    return antenna;
  }

  void refresh(std::size_t k, std::int64_t knot) {
    Arc& arc = arcs_[k];
    if (arc.knot == knot) return;
    arc.knot = knot;
    const double t = static_cast<double>(knot) * kArc_s;
    const twins::gnss::VisibilitySettings visibility;
    const auto from = twins::gnss::visible_path(*constellation_, k, antenna(t), visibility);
    const auto to = twins::gnss::visible_path(*constellation_, k, antenna(t + kArc_s), visibility);
    arc.visible = from && to;
    if (!arc.visible) return;
    const auto range = [](const twins::gnss::SignalPath& path) {
      return path.range_m + path.shapiro_m - fsw::gnss::kSpeedOfLight * path.satellite_clock_s;
    };
    const auto rate = [](const twins::gnss::SignalPath& path) {
      return path.range_rate_mps - fsw::gnss::kSpeedOfLight * path.satellite_clock_drift;
    };
    const double d = range(*to) - range(*from);
    const double h = kArc_s;
    arc.cubic = {range(*from), rate(*from), (3.0 * d / h - 2.0 * rate(*from) - rate(*to)) / h,
                 (rate(*from) + rate(*to) - 2.0 * d / h) / (h * h)};
  }

  static grand::bench::RangePolynomial shifted(const std::array<double, 4>& c, double s) {
    return {{c[0] + s * (c[1] + s * (c[2] + s * c[3])), c[1] + s * (2.0 * c[2] + 3.0 * s * c[3]), c[2] + 3.0 * s * c[3],
             c[3], 0.0, 0.0}};
  }

  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  fsw::Vector3 offset_rtn_m_;
  std::vector<Arc> arcs_;
};

}  // namespace vbar::test
