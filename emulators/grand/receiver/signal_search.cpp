#include "emulators/grand/receiver/signal_search.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace vbar::grand::bench {
namespace {

using twins::gnss::Signal;
using twins::gnss::System;

constexpr double kBlock_s = 0.1;
constexpr double kCn0Noise_db = 1.0;           ///< noise of the short integration that decides
constexpr double kRateGrowth_hz_per_s = 60.0;  ///< Doppler of a signal that is no longer tracked, in orbit
constexpr double kMinElevation = -0.53;        ///< rad, -30 deg: an orbit sees below the horizontal

Signal first_signal(System system) {
  switch (system) {
    case System::kGps:
      return Signal::kGpsL1;
    case System::kGalileo:
      return Signal::kGalileoE1;
    case System::kBeidou:
      return Signal::kBeidouB1I;
  }
  return Signal::kGpsL1;
}

}  // namespace

SignalSearch::SignalSearch(const SearchSettings& settings,
                           std::shared_ptr<const twins::gnss::Constellation> constellation, std::uint64_t seed,
                           std::string_view vehicle)
    : settings_(settings),
      constellation_(std::move(constellation)),
      stream_(seed, "grand/receiver/" + std::string(vehicle) + "/search"),
      engines_(static_cast<std::size_t>(settings.engines)),
      memory_(constellation_->size()),
      above_(constellation_->size()) {}

void SignalSearch::restart() {
  std::ranges::fill(engines_, Sweep{});
  std::ranges::fill(memory_, Memory{});
  std::ranges::fill(above_, Above::kUnknown);
  next_ = 0;
}

void SignalSearch::lost(std::size_t satellite, double range_rate_mps) {
  memory_[satellite] = {0, range_rate_mps};
}

int SignalSearch::busy_engines() const {
  return static_cast<int>(std::ranges::count_if(engines_, [](const Sweep& sweep) { return sweep.blocks_left > 0; }));
}

bool SignalSearch::is_searched(std::size_t satellite) const {
  return std::ranges::any_of(
      engines_, [satellite](const Sweep& sweep) { return sweep.blocks_left > 0 && sweep.satellite == satellite; });
}

bool SignalSearch::worth_searching(std::size_t satellite, fsw::GpsTime time, const SearchKnowledge& knowledge) {
  if (!knowledge.position_ecef) return true;
  if (above_[satellite] != Above::kUnknown) return above_[satellite] == Above::kYes;
  const fsw::Vector3 transmitter =
      twins::gnss::satellite_state(constellation_->broadcast_set(satellite, time).ephemeris, time).position_ecef;
  const fsw::Vector3& receiver = *knowledge.position_ecef;
  const double sin_elevation = (transmitter - receiver).normalized().dot(receiver.normalized());
  const bool above = sin_elevation > std::sin(std::max(kMinElevation, knowledge.elevation_cutoff));
  above_[satellite] = above ? Above::kYes : Above::kNo;
  return above;
}

SignalSearch::Sweep SignalSearch::sweep(std::size_t satellite, const RfSignal* signal, double oscillator_rate_mps,
                                        double cn0_offset_db, bool velocity_known) {
  const double wavelength = twins::gnss::wavelength_m(first_signal(constellation_->id(satellite).system));
  double window_hz =
      velocity_known ? std::min(settings_.known_window_hz, settings_.blind_window_hz) : settings_.blind_window_hz;
  double centre_hz = 0.0;
  const double rate_hz = signal != nullptr ? (signal->carrier_m.rate_at(0.0) + oscillator_rate_mps) / wavelength : 0.0;
  const Memory& memory = memory_[satellite];
  const double memory_window_hz =
      settings_.reacquisition_window_hz + kRateGrowth_hz_per_s * kBlock_s * memory.blocks_since_lost;
  if (memory.blocks_since_lost >= 0 && memory_window_hz < window_hz) {
    window_hz = memory_window_hz;
    centre_hz = memory.range_rate_mps / wavelength;
  } else if (velocity_known) {
    centre_hz = rate_hz + stream_.uniform(-0.5, 0.5) * window_hz;
  }
  const double cn0_dbhz = signal != nullptr ? signal->cn0_dbhz + cn0_offset_db + kCn0Noise_db * stream_.normal() : 0.0;
  const bool inside = std::abs(rate_hz - centre_hz) <= window_hz;
  Sweep result;
  result.satellite = satellite;
  result.will_be_found = signal != nullptr && inside && cn0_dbhz >= settings_.threshold_dbhz;
  const double swept_hz = result.will_be_found ? rate_hz - centre_hz + window_hz : 2.0 * window_hz;
  result.blocks_left = std::max(1, static_cast<int>(std::ceil(swept_hz / settings_.sweep_hz_per_s / kBlock_s)));
  return result;
}

void SignalSearch::advance(fsw::GpsTime time, const std::vector<const RfSignal*>& signals, double oscillator_rate_mps,
                           double cn0_offset_db, const std::vector<bool>& tracked, const SearchKnowledge& knowledge,
                           std::vector<std::size_t>& found) {
  found.clear();
  above_[next_predicted_] = Above::kUnknown;
  next_predicted_ = (next_predicted_ + 1) % above_.size();
  for (Memory& memory : memory_)
    if (memory.blocks_since_lost >= 0) ++memory.blocks_since_lost;
  for (Sweep& engine : engines_) {
    if (engine.blocks_left > 0 && --engine.blocks_left == 0 && engine.will_be_found &&
        signals[engine.satellite] != nullptr && !tracked[engine.satellite])
      found.push_back(engine.satellite);
  }
  for (Sweep& engine : engines_) {
    if (engine.blocks_left > 0) continue;
    for (std::size_t tried = 0; tried < memory_.size(); ++tried) {
      const std::size_t satellite = next_;
      next_ = (next_ + 1) % memory_.size();
      if (tracked[satellite] || is_searched(satellite) || std::ranges::find(found, satellite) != found.end() ||
          !worth_searching(satellite, time, knowledge))
        continue;
      engine = sweep(satellite, signals[satellite], oscillator_rate_mps, cn0_offset_db, knowledge.velocity);
      break;
    }
  }
}

}  // namespace vbar::grand::bench
