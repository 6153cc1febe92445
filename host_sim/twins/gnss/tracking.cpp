#include "host_sim/twins/gnss/tracking.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace vbar::twins::gnss {
namespace {

// Initial integers of a count of cycles: large enough not to be guessed.
constexpr double kLargestAmbiguity_cycles = 0x1p22;
constexpr double kLargestSlip_cycles = 100.0;

std::string stream_name(std::string_view receiver, SatelliteId satellite) {
  return "gnss/" + std::string(receiver) + "/" + name_of(satellite);
}

// Uniform on -largest ... largest without 0.
std::int64_t nonzero_integer(engine::RandomStream& stream, double largest) {
  const auto magnitude = static_cast<std::int64_t>(stream.uniform(0.0, largest)) + 1;
  return stream.uniform() < 0.5 ? -magnitude : magnitude;
}

}  // namespace

SatelliteTracking::SatelliteTracking(SatelliteId satellite, const StartSettings& start,
                                     const TrackingSettings& tracking, std::uint64_t seed, std::string_view receiver)
    : satellite_(satellite), start_(start), tracking_(tracking), stream_(seed, stream_name(receiver, satellite)) {
  for (std::size_t k = 0; k < kSignals; ++k) {
    if (kSignalStructures[k].system != satellite.system) continue;
    const std::string name = stream_name(receiver, satellite) + "/" + kSignalStructures[k].name;
    signals_.emplace_back(static_cast<Signal>(k), engine::RandomStream(seed, name),
                          engine::GaussMarkov(1e-3 * tracking.carrier_wander_sigma_mm, tracking.carrier_wander_time_s,
                                              engine::RandomStream(seed, name + "/carrier_wander")));
  }
}

void SatelliteTracking::update(fsw::GpsTime now, bool first, const std::vector<double>& cn0_dbhz) {
  const double elapsed_s = first ? 0.0 : seconds(now - last_update_);
  last_update_ = now;
  for (std::size_t k = 0; k < cn0_dbhz.size(); ++k) signals_[k].cn0_dbhz = cn0_dbhz[k];
  // All signals depend on the first one: it is acquired by its code, and aids the loops of the others.
  SignalTrack& leader = signals_.front();
  const double needed = leader.tracking ? tracking_.loss_threshold_dbhz : tracking_.acquisition_threshold_dbhz;
  if (cn0_dbhz.empty() || leader.cn0_dbhz < needed) {
    lose();
    return;
  }
  if (!found_) search(now, first);
  if (now < *found_) {
    commanded_.clear();
    return;
  }

  for (SignalTrack& track : signals_) {
    const double threshold = track.tracking ? tracking_.loss_threshold_dbhz : tracking_.acquisition_threshold_dbhz;
    if (track.cn0_dbhz < threshold) {
      track.tracking = false;
    } else if (!track.tracking) {
      begin(track, std::max(*found_, first ? now : now - fsw::nearest_duration(elapsed_s)));
    } else {
      slip_by_chance(track, now, elapsed_s);
    }
  }
  for (const CommandedSlip& command : commanded_)
    for (SignalTrack& track : signals_)
      if (track.signal == command.signal && track.tracking) slip(track, now, command.cycles, command.seen);
  commanded_.clear();
}

void SatelliteTracking::search(fsw::GpsTime now, bool first) {
  const bool cold = first && start_.mode == StartMode::kCold;
  const double delay_s = cold ? stream_.uniform(start_.cold_search_min_s, start_.cold_search_max_s)
                              : stream_.uniform(start_.reacquisition_min_s, start_.reacquisition_max_s);
  found_ = now + fsw::nearest_duration(delay_s);
  heard_since_ = found_;
}

void SatelliteTracking::lose() {
  for (SignalTrack& track : signals_) track.tracking = false;
  found_.reset();
  heard_since_.reset();
  commanded_.clear();
}

void SatelliteTracking::begin(SignalTrack& track, fsw::GpsTime since) {
  track.tracking = true;
  track.lock_since = since;
  track.ambiguity_cycles = nonzero_integer(track.stream, kLargestAmbiguity_cycles);
}

void SatelliteTracking::slip(SignalTrack& track, fsw::GpsTime now, std::int64_t cycles, bool seen) {
  track.ambiguity_cycles += cycles;
  ++track.slips;
  if (seen) track.lock_since = now;
}

void SatelliteTracking::slip_by_chance(SignalTrack& track, fsw::GpsTime now, double elapsed_s) {
  const double probability = -std::expm1(-tracking_.cycle_slips_per_hour / 3600.0 * elapsed_s);
  if (track.stream.uniform() >= probability) return;
  const std::int64_t cycles = nonzero_integer(track.stream, kLargestSlip_cycles);
  slip(track, now, cycles, track.stream.uniform() >= tracking_.undetected_slip_fraction);
}

void SatelliteTracking::command_slip(Signal signal, std::int64_t cycles, bool seen) {
  commanded_.push_back({signal, cycles, seen});
}

}  // namespace vbar::twins::gnss
