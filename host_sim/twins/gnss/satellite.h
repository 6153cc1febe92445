#pragma once
// Navigation satellites and their signals by name, and the structure of each signal as far as the emulator needs it.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>

#include "fsw/gnss/constants.h"

namespace vbar::twins::gnss {

enum class System : std::uint8_t { kGps = 0, kGalileo = 1, kBeidou = 2 };
inline constexpr std::size_t kSystems = 3;

/// Systems by their numbers, of those that a run uses.
using SystemSet = std::array<bool, kSystems>;
inline constexpr SystemSet kAllSystems{true, true, true};

/// A satellite by the number its system gives it (PRN, SVID), from 1 on.
struct SatelliteId {
  System system = System::kGps;
  int prn = 0;
  constexpr auto operator<=>(const SatelliteId&) const = default;
};

/// Returns the name "G05", "E11", "C03": RINEX names, which also name random streams.
std::string name_of(SatelliteId satellite);

/// Whether a satellite is geostationary. BeiDou's satellites 1 to 5 and 59 to 63 are geostationary
/// (BDS-SIS-ICD-B1I-3.0, 5.2.4.12): their own orbit frame and navigation message.
constexpr bool is_geostationary(SatelliteId satellite) {
  return satellite.system == System::kBeidou && (satellite.prn <= 5 || satellite.prn >= 59);
}

/// The signals of the paper's receiver, Appendix A: GPS L1/L2, GAL E1, BDS B1I.
enum class Signal : std::uint8_t { kGpsL1 = 0, kGpsL2 = 1, kGalileoE1 = 2, kBeidouB1I = 3 };
inline constexpr std::size_t kSignals = 4;

struct SignalStructure {
  System system;
  const char* name;
  double frequency_hz;
  double chip_rate_hz;
  double
      correlator_spacing_chips;  ///< early to late; narrow on wide chips, limited by the front end's bandwidth on P(Y)
  double received_power_dbw;     ///< minimum power on the ground by the interface document
};

/// Powers: IS-GPS-200N table 3-Va (L1 C/A, L2 P(Y) of blocks IIR-M and IIF); Galileo OS SIS ICD 2.1, table 11;
/// BDS-SIS-ICD-B1I-3.0, 4.2.6. Chip rates from the same documents. The E1 and B1I replicas are taken as plain BPSK.
inline constexpr std::array<SignalStructure, kSignals> kSignalStructures{{
    {System::kGps, "L1", fsw::gnss::kL1_Hz, 1.023e6, 0.1, -158.5},
    {System::kGps, "L2", fsw::gnss::kL2_Hz, 10.23e6, 0.5, -161.5},
    {System::kGalileo, "E1", fsw::gnss::kE1_Hz, 1.023e6, 0.1, -157.0},
    {System::kBeidou, "B1I", fsw::gnss::kB1I_Hz, 2.046e6, 0.2, -163.0},
}};

constexpr const SignalStructure& structure(Signal signal) {
  return kSignalStructures[static_cast<std::size_t>(signal)];
}
constexpr double wavelength_m(Signal signal) {
  return fsw::gnss::kSpeedOfLight / structure(signal).frequency_hz;
}

/// Returns the delay of code against the satellite's clock, s: the clock refers to a combination of two signals
/// (IS-GPS-200N 20.3.3.3.3.2; Galileo OS SIS ICD 2.1, 5.1.5; BDS-SIS-ICD-B1I-3.0, 5.2.4.10).
constexpr double code_delay_s(Signal signal, double group_delay_s) {
  constexpr double kGamma = (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz) * (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz);
  return signal == Signal::kGpsL2 ? kGamma * group_delay_s : group_delay_s;
}

/// Returns the delay by the ionosphere relative to that of GPS L1: group delay goes with the inverse square of the
/// frequency.
constexpr double ionosphere_scale(Signal signal) {
  const double ratio = fsw::gnss::kL1_Hz / structure(signal).frequency_hz;
  return ratio * ratio;
}

}  // namespace vbar::twins::gnss
