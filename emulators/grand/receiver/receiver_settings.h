#pragma once
// Settings of one emulated receiver, as the emulator's scenario file gives them. Defaults: NovAtel OEM628; the
// constants of its firmware are not public.

#include <cstdint>

#include "host_sim/mission/table_reader.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::grand::bench {

/// Loops of one channel, updated every 10 ms.
struct LoopSettings {
  int carrier_order = 3;  ///< 2 or 3
  double carrier_bandwidth_hz = 15.0;
  double code_bandwidth_hz = 0.25;
  double code_bandwidth_l2_hz = 0.1;
  double smoothing_s = 100.0;         ///< smoothing of the pseudorange by the carrier; the command CSMOOTH changes it
  double phase_lock_threshold = 0.4;  ///< mean of cos 2x over 1 s
  double code_lock_threshold_dbhz = 24.0;
  double code_bias_sigma_m = 0.0;  ///< constant code delay of each signal in the receiver
  friend bool operator==(const LoopSettings&, const LoopSettings&) = default;
};

/// Search for signals: engines that sweep the Doppler of one satellite after the other.
struct SearchSettings {
  double threshold_dbhz = 33.0;
  int engines = 4;
  double sweep_hz_per_s = 60e3;          ///< rate of one engine
  double blind_window_hz = 50e3;         ///< +-; without knowledge of the receiver's own velocity
  double known_window_hz = 2e3;          ///< +-; with a point solution and an ephemeris or almanac
  double reacquisition_window_hz = 500;  ///< +-; about the Doppler of a signal lost less than a minute ago
  friend bool operator==(const SearchSettings&, const SearchSettings&) = default;
};

struct LineSettings {
  unsigned baud = 115200;             ///< rate saved in the receiver: after power-up
  int buffer_bytes = 16384;           ///< buffer of a port's output
  double computing_ms = 40.0;         ///< from epoch to first byte, mean
  double computing_spread_ms = 10.0;  ///< +-, uniform
  double boot_s = 2.0;                ///< from power-up to prompt
  friend bool operator==(const LineSettings&, const LineSettings&) = default;
};

/// Content of the receiver's permanent memory at power-up. With kAlmanac, time and position by command (SETAPPROXTIME,
/// SETAPPROXPOS) make a warm start, with kEphemerides a hot one; without them every start searches blindly.
enum class StoredData : std::uint8_t { kNothing, kAlmanac, kEphemerides };

struct ReceiverSettings {
  LoopSettings loops;
  SearchSettings search;
  LineSettings line;
  /// Clock of the digital twin except for the white frequency noise, which there describes seconds: at 10 ms it would
  /// be 3e-9, and loops of 15 Hz would slip every few seconds (0.3 rad after Kaplan, Hegarty 2017, 8.3.3.2). This one
  /// is 3e-10.
  twins::gnss::ClockSettings clock{.h0_s = 2e-21};
  double steering_bandwidth_hz = 0.03;
  StoredData stored = StoredData::kAlmanac;
  int week_shift = 0;    ///< added to every week that the receiver reports (fault: 1024)
  int time_shift_s = 0;  ///< added to every time tag that the receiver reports (fault: 1)
  friend bool operator==(const ReceiverSettings&, const ReceiverSettings&) = default;
};

/// Reads the keys of the section (tables loops, search, line, clock); a missing key has its default. Throws
/// mission::MissionError naming file, line, key, value and what is accepted. The caller calls finish().
ReceiverSettings read_receiver_settings(const mission::TableReader& section);

}  // namespace vbar::grand::bench
