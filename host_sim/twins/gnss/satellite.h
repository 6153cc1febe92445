#pragma once
// Navigation satellites and their signals by name, and the structure of each signal as far as the emulator needs it.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
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

// The orbit and clock model of the broadcast ephemerides: the motion that a satellite broadcasts, and, here, its true
// motion up to the errors of constellation.h.
// IS-GPS-200N 20.3.3.4.3 and 20.3.3.3.3.1; Galileo OS SIS ICD 2.1, 5.1; BDS-SIS-ICD-B1I-3.0, 5.2.4.9 to 5.2.4.12.

/// Set of elements. Unlike the broadcast one it names the node by its Earth-fixed longitude at toe, so that
/// it depends on no week and can be moved to another day; omega0 = node_at_toe + Earth rate * (seconds of week of toe).
/// The clock's reference time is toe.
struct Ephemeris {
  SatelliteId satellite;
  fsw::GpsTime toe;     ///< GPS time for every system
  double sqrt_a = 0.0;  ///< m^(1/2)
  double e = 0.0;
  double m0 = 0.0;           ///< rad, as all angles
  double delta_n = 0.0;      ///< rad/s
  double node_at_toe = 0.0;  ///< rad; that of geostationary BeiDou satellites is in the frame of their model
  double omega_dot = 0.0;    ///< rad/s
  double i0 = 0.0;
  double i_dot = 0.0;  ///< rad/s
  double omega = 0.0;  ///< argument of perigee
  double cuc = 0.0, cus = 0.0, cic = 0.0, cis = 0.0;
  double crc = 0.0, crs = 0.0;             ///< m
  double af0 = 0.0, af1 = 0.0, af2 = 0.0;  ///< s, s/s, s/s^2
  double group_delay_s = 0.0;              ///< GPS TGD, Galileo BGD(E1,E5b), BeiDou TGD1
};

struct SatelliteState {
  fsw::Vector3 position_ecef = fsw::Vector3::Zero();  ///< in the Earth-fixed frame of the same instant
  fsw::Vector3 velocity_ecef = fsw::Vector3::Zero();  ///< relative to that frame
  double clock_s = 0.0;      ///< satellite clock minus system time, relativity of the eccentric orbit included
  double clock_drift = 0.0;  ///< s/s, the same
};

/// Return the gravitational parameter (m^3/s^2) and Earth rate (rad/s) of a system's model.
double gravitational_parameter(System system);
double earth_rate(System system);

/// Returns the mean motion, delta_n included, rad/s.
double mean_motion(const Ephemeris& ephemeris);

/// Returns the state `offset_s` after `time`. The model is evaluated at any distance from toe.
SatelliteState satellite_state(const Ephemeris& ephemeris, fsw::GpsTime time, double offset_s = 0.0);

/// Returns the set of elements with reference time `toe` that describes the same motion. Exact: every term of the model
/// is constant or linear in time. (Sets of geostationary BeiDou satellites must have no harmonic terms or rates, as
/// constellation.h makes them: their tilted frame rotates with toe.)
Ephemeris with_reference_time(const Ephemeris& ephemeris, fsw::GpsTime toe);

}  // namespace vbar::twins::gnss
