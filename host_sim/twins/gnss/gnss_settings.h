#pragma once
// Settings of one receiver and its antenna in a mission. Defaults are those of the paper's Appendix A (marked A), the
// others those of a NovAtel OEM628 and a typical patch antenna.

#include <cstdint>
#include <filesystem>

#include "fsw/core/types.h"

namespace vbar::twins::gnss {

/// Limits of the signals that can reach the receiver.
struct VisibilitySettings {
  double transmit_aperture_deg = 170.0;   ///< A, "GNSS aperture": full cone about the satellite's nadir
  double receiver_mask_deg = 190.0;       ///< A: full cone about the antenna's boresight
  double horizon_mask_deg = -20.0;        ///< A: minimum elevation above the local horizontal
  double occultation_altitude_km = 50.0;  ///< a line of sight that dips below this altitude is blocked
  friend bool operator==(const VisibilitySettings&, const VisibilitySettings&) = default;
};

/// Link budget from transmitted power to C/N0. The antennas of the satellites are isotropic (A: spherical gain).
struct LinkBudgetSettings {
  double boresight_gain_dbi = 4.0;  ///< with the pattern of the file below it
  /// File of AntennaPattern, seen from the data folder.
  std::filesystem::path antenna_pattern = "gps/receiver_antenna_typical_patch.csv";
  double antenna_temperature_k = 130.0;
  double lna_gain_db = 33.0;  ///< A
  double lna_noise_figure_db = 2.0;
  double receiver_noise_figure_db = 8.0;  ///< behind the amplifier
  double losses_db = 2.0;                 ///< polarisation, cable, quantisation
  friend bool operator==(const LinkBudgetSettings&, const LinkBudgetSettings&) = default;
};

/// Code of GPS L1 that is tracked.
enum class L1Code : std::uint8_t { kCa, kP };

/// One sigma of a code error that is correlated in time, m, at the zenith and at the horizon:
///   sigma^2 = (zenith sin E)^2 + (horizon cos E)^2.
struct CodeWander {
  double zenith_m = 0.0, horizon_m = 0.0;
  [[nodiscard]] double sigma_m(double sin_elevation) const;
  [[nodiscard]] bool is_none() const { return zenith_m == 0.0 && horizon_m == 0.0; }
  friend bool operator==(const CodeWander&, const CodeWander&) = default;
};

/// Tracking loops. Noise: formulas of the coherent early-late and Costas loops.
struct TrackingSettings {
  bool thermal_noise = true;
  double code_loop_bandwidth_hz = 0.25;
  double carrier_loop_bandwidth_hz = 15.0;
  double integration_s = 0.02;
  double acquisition_threshold_dbhz = 33.0;
  double loss_threshold_dbhz = 28.0;
  double cycle_slips_per_hour =
      0.02;  ///< rate of each signal; every slip is seen by the receiver: the lock time restarts
  double undetected_slip_fraction = 0.0;  ///< fraction of these slips that the receiver does not detect
  double code_bias_sigma_m = 0.0;         ///< constant code delay of each signal in the receiver
  double carrier_wander_sigma_mm = 0.0;   ///< first-order Gauss-Markov error of each satellite's and signal's carrier
  double carrier_wander_time_s = 60.0;    ///< its correlation time
  L1Code l1_code = L1Code::kCa;           ///< code of pseudoranges of L1; its carrier is that of C/A
  double w_code_rate_khz = 0.0;           ///< P(Y) without its encryption W of this chip rate; 0: W is known
  CodeWander code_wander_l1{};            ///< first-order Gauss-Markov error of each satellite's code: multipath;
  CodeWander code_wander_l2{};            ///< L1 with E1 and B1I, and L2
  double code_wander_time_s = 300.0;      ///< their correlation time
  friend bool operator==(const TrackingSettings&, const TrackingSettings&) = default;
};

enum class StartMode : std::uint8_t {
  kCold,  ///< no a-priori information: searches satellite by satellite
  kWarm,  ///< A: approximate time, position and almanac available
  kHot,   ///< the same, and ephemerides from before
};

/// Start of tracking. Each satellite's delay is uniform in its interval.
struct StartSettings {
  StartMode mode = StartMode::kWarm;
  double cold_search_min_s = 20.0;
  double cold_search_max_s = 60.0;
  double reacquisition_min_s = 1.0;  ///< warm, hot, and every satellite that rises later
  double reacquisition_max_s = 8.0;
  double ephemeris_decoding_s = 30.0;  ///< time in lock until a message's set has been received
  friend bool operator==(const StartSettings&, const StartSettings&) = default;
};

/// Two-state crystal oscillator, not steered (CLOCKADJUST DISABLE: the harder case; a steering receiver stays within
/// nanoseconds). Where the offset passes half a millisecond the receiver sets its clock by whole milliseconds.
struct ClockSettings {
  double initial_offset_ms = 0.4;  ///< uniform in [-x, x]
  double initial_drift_sigma_ns_per_s = 100.0;
  double h0_s = 2e-19;             ///< Allan coefficients of white frequency noise
  double h_minus2_per_s = 2e-20;   ///< and of random-walk frequency noise
  double jump_threshold_ms = 0.5;  ///< at least 0.5: a smaller one would jump back and forth
  friend bool operator==(const ClockSettings&, const ClockSettings&) = default;
};

/// True position of the antenna (A, second table). Vectors in the body frame.
struct BodyFrameSettings {
  fsw::Vector3 antenna_in_body_m = fsw::Vector3(0.0, 0.0, 0.3);  ///< from the nominal centre of mass
  fsw::Vector3 boresight_in_body = fsw::Vector3::UnitZ();
  double com_radius_mm = 3.0;               ///< A: centre of mass uniform in a ball
  double pco_bias_mm = 5.0;                 ///< A: length of a constant vector of random direction
  double pco_noise_mm = 1.0;                ///< A: each axis, each epoch, all signals alike
  double antenna_direction_arcsec = 30.0;   ///< A: each axis
  double attitude_knowledge_arcsec = 20.0;  ///< A: each axis; true minus known attitude of the body
  friend bool operator==(const BodyFrameSettings&, const BodyFrameSettings&) = default;
};

enum class GpsEphemerisLog : std::uint8_t { kRawEphem, kGpsEphem };

/// Logs requested from the receiver.
struct OutputSettings {
  double period_s = 10.0;               ///< period of RANGE, BESTXYZ, TIME: 0.1 to 60, whole milliseconds
  double ephemeris_period_s = 300.0;    ///< each ephemeris again; new ones at once
  double corrections_period_s = 300.0;  ///< IONUTC
  GpsEphemerisLog gps_ephemeris = GpsEphemerisLog::kRawEphem;
  friend bool operator==(const OutputSettings&, const OutputSettings&) = default;
};

struct GnssReceiverSettings {
  VisibilitySettings visibility;
  LinkBudgetSettings link_budget;
  TrackingSettings tracking;
  StartSettings start;
  ClockSettings clock;
  BodyFrameSettings body_frame;
  OutputSettings output;
  bool ionosphere = true;  ///< A: Klobuchar, delay of code and advance of phase
  friend bool operator==(const GnssReceiverSettings&, const GnssReceiverSettings&) = default;
};

/// Throws std::invalid_argument: one sentence with the setting, what was found and what is accepted.
void check(const GnssReceiverSettings& settings);

}  // namespace vbar::twins::gnss
