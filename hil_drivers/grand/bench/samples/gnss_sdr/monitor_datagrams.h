#pragma once
// Datagrams of gnss-sdr by UDP: the observables of its block Monitor (gnss_synchro.proto) and the subframes of its
// block NavDataMonitor (nav_message.proto), as far as they are used here. Field numbers are those of gnss-sdr 0.0.17.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/twins/gnss/lnav_parity.h"

namespace vbar::grand::bench {

/// Observables of one channel at one instant of the receiver's clock.
struct Observable {
  int channel = 0;
  int prn = 0;             ///< 0: the channel has no satellite
  double rx_time_s = 0.0;  ///< time of the GPS week, by the receiver's clock; 0 until it has been set
  bool valid = false;      ///< pseudorange and phase are valid
  double pseudorange_m = 0.0;
  double carrier_phase_cycles = 0.0;  ///< grows with the range
  double doppler_hz = 0.0;
  double cn0_dbhz = 0.0;
};

/// Decodes a datagram of the Monitor. Nothing for one that is malformed, has more than 64 observables, or a number that
/// is not finite or not plausible; signals other than GPS L1 C/A are left out.
std::optional<std::vector<Observable>> read_observables(std::span<const std::uint8_t> datagram);

struct ReceivedSubframe {
  int prn = 0;
  std::int64_t tow_ms = 0;  ///< time of week that gnss-sdr reports with it
  twins::gnss::TransmittedSubframe words{};
};

/// Decodes a datagram of the NavDataMonitor. Nothing for one that is malformed, of another signal, or not of 300 bits.
std::optional<ReceivedSubframe> read_subframe(std::span<const std::uint8_t> datagram);

}  // namespace vbar::grand::bench
