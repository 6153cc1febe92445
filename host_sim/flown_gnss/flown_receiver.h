#pragma once
// A recorded receiver, or the twin on the same orbit, through the own-orbit navigation of the flight software.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host_sim/flown_gnss/given_orbit.h"
#include "host_sim/flown_gnss/orbit_errors.h"
#include "host_sim/flown_gnss/own_orbit.h"
#include "host_sim/flown_gnss/signal_statistics.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::flown_gnss {

// The receiver of a run by its packet log: what the flight software got from an emulated testbed, for example.

class LoggedReceiver final : public twins::gnss::ReceiverBytes {
 public:
  /// Reads the receiver's bytes of spacecraft `number` (in packet headers) from a packet log. `period`: between calls
  /// of output_at(). Throws as twins::read_packet_log(), and std::runtime_error for a log without such bytes.
  LoggedReceiver(const std::filesystem::path& log, std::uint8_t number, fsw::Duration period);

  /// Returns all bytes that were delivered from this call until the next one: a device delivers after its epoch.
  twins::gnss::ReceiverOutput output_at(const twins::gnss::BodyTruth& truth) override;

 private:
  fsw::Duration period_;
  std::map<fsw::GpsTime, std::vector<std::uint8_t>> bytes_;  ///< by the time of their delivery
};

struct FlownSettings {
  fsw::filter::AbsoluteOrbitSettings filter;
  fsw::gnss::RangeErrors range_errors;
  double antenna_up_m = 0.0;  ///< from the centre of mass to the zenith
  double period_s = 10.0;     ///< between epochs
  double begin_s = 0.0;       ///< of the first epoch, after the first state of the orbit
  double duration_s = 86400.0;
};

struct FlownResult {
  explicit FlownResult(fsw::GpsTime first, double interval_s) : errors(first), signals(interval_s) {}
  OrbitErrors errors;
  SignalStatistics signals;
  ElevationBins ranges{};  ///< range as the single point uses it, less that to the satellite and the epoch's mean, m
  fsw::measurements::OwnGnssCounters counters;
  std::size_t epochs = 0;
  std::size_t satellites = 0;  ///< sum over the epochs
};

/// Flies from `begin_s` on. Throws what receiver and orbit throw.
[[nodiscard]] FlownResult fly(GivenOrbit& orbit, twins::gnss::ReceiverBytes& receiver, const FlownSettings& settings);

// The figures of a flown receiver beside those of its twin on the same orbit.

struct ComparedFigure {
  std::string name;  ///< with its unit
  double flown = 0.0, twin = 0.0;
  std::size_t count = 0;  ///< values of the flown receiver behind it
  [[nodiscard]] double ratio() const { return twin / flown; }
};

/// Returns errors of the orbit over all hours, satellites of an epoch, noise by elevation and correlation of code.
/// Elevations at which either has fewer than a hundred values are left out.
[[nodiscard]] std::vector<ComparedFigure> compare(const FlownResult& flown, const FlownResult& twin);

}  // namespace vbar::flown_gnss
