#pragma once
// Measurements of a receiver at one instant of its own clock: code, carrier, Doppler of every signal it tracks.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/gnss/constants.h"

namespace vbar::fsw::gnss {

enum class Constellation : std::uint8_t { kGps = 0, kGalileo = 1, kBeidou = 2 };
inline constexpr std::size_t kConstellations = 3;

/// One navigation satellite; prn as in its system's interface document, from 1 on.
struct SatelliteId {
  Constellation constellation = Constellation::kGps;
  std::uint8_t prn = 0;
  constexpr auto operator<=>(const SatelliteId&) const = default;
};

/// The signals used on board.
enum class Signal : std::uint8_t { kGpsL1 = 0, kGpsL2 = 1, kGalileoE1 = 2, kBeidouB1I = 3 };
inline constexpr std::size_t kSignals = 4;

constexpr double frequency_hz(Signal signal) {
  constexpr std::array<double, kSignals> kFrequencies{kL1_Hz, kL2_Hz, kE1_Hz, kB1I_Hz};
  return kFrequencies[static_cast<std::size_t>(signal)];
}
constexpr double wavelength(Signal signal) {
  return kSpeedOfLight / frequency_hz(signal);
}

struct Observation {
  SatelliteId satellite;
  Signal signal = Signal::kGpsL1;
  /// Code by which the signal is tracked, as numbered by the receiver (GPS L2: 9 P(Y), 5 P, 17 C). Phases of different
  /// codes differ by fractions of a cycle: an arc, and a difference between receivers, is of one code.
  std::uint8_t code = 0;
  bool phase_usable = false;  ///< phase lock, and no half-cycle ambiguity (parity known)
  double pseudorange_m = 0.0;
  double carrier_phase_cycles = 0.0;  ///< grows with the range (the opposite sign of NovAtel's ADR)
  double doppler_hz = 0.0;            ///< positive when approaching
  double pseudorange_sigma_m = 0.0;   ///< the receiver's own estimates
  double phase_sigma_cycles = 0.0;
  double cn0_dbhz = 0.0;
  double lock_time_s = 0.0;  ///< duration of continuous carrier tracking: decreases after a slip
};

/// Largest number of observations: 24 satellites of two GPS signals, 16 each of Galileo and BeiDou.
inline constexpr std::size_t kMaxObservations = 80;

struct ObservationEpoch {
  GpsTime receiver_time;  ///< by the receiver's clock: pseudoranges are this minus the time of transmission, times c
  std::size_t count = 0;
  std::array<Observation, kMaxObservations> observations{};  ///< in order of satellite and signal, none twice
};

}  // namespace vbar::fsw::gnss
