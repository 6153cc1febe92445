#pragma once
// From transmitted power to C/N0, and from C/N0 to the noise of the loops.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::twins::gnss {

/// Attenuation of the receiving antenna against the angle from its boresight.
class AntennaPattern {
 public:
  /// Reads a file of angles (deg, from 0 to 180, rising) and attenuations (dB). Throws std::runtime_error naming file
  /// and line.
  static AntennaPattern read(const std::filesystem::path& file);
  /// Reads the one of the default settings in a data folder likewise.
  static AntennaPattern load(const std::filesystem::path& data_directory);

  /// Returns the attenuation, dB below boresight at `cosine` of the angle, linear between the file's angles.
  [[nodiscard]] double attenuation_db(double cosine) const;

 private:
  struct Node {
    double angle_deg;
    double attenuation_db;
  };
  std::vector<Node> nodes_;
};

/// Returns C/N0 (dB-Hz) at `distance_m` from a satellite with the specified power on the ground at 5 deg elevation
/// (25,240 km for GPS), spread by free space; noise of antenna and amplifier chain after Friis.
double carrier_to_noise_dbhz(const LinkBudgetSettings& settings, Signal signal, double distance_m,
                             double antenna_attenuation_db);

/// Returns C/N0 (dB-Hz) with which P(Y) is tracked where its encryption W is unknown and each of its chips is estimated
/// from the other frequency, whose C/N0 is `other_cn0_dbhz`:
///   (C/N0) / (1 + R/(2 (C/N0)_other)),   R the chip rate of W, 0 if it is known.
/// What multiplies C/N0 is the squaring loss of a loop (Kaplan, Hegarty 2017, 8.3.3) that integrates over one chip of W
/// only. With weak signals it falls by 2 dB with each dB, as models of semicodeless tracking do (Betz, Cerruti 2020,
/// Navigation 67, 109).
double semicodeless_cn0_dbhz(double cn0_dbhz, double other_cn0_dbhz, double w_code_rate_khz);

/// C/N0 of the signals of a satellite, dB-Hz, in their order.
struct SignalStrengths {
  std::vector<double> carrier;  ///< with which they are acquired, tracked and reported
  std::vector<double> code;     ///< of the code of pseudoranges
};

/// Returns the strengths of signals whose C/N0 by the link budget is `cn0_dbhz`. The two differ for L1 with
/// pseudoranges of P(Y), which is transmitted with 3 dB less than C/A (IS-GPS-200N table 3-Va).
SignalStrengths signal_strengths(const TrackingSettings& settings, System system, std::vector<double> cn0_dbhz);

/// Returns one sigma of the code loop (m), coherent early minus late power discriminator:
///   (c/Rc) sqrt(B d/(2 C/N0) (1 + 2/((2-d) T C/N0)))   (Kaplan, Hegarty 2017, 8.4.3).
/// Rc and d are those of the signal; L1 with P(Y) (settings.l1_code) has those of L2.
double code_noise_m(const TrackingSettings& settings, Signal signal, double cn0_dbhz);

/// Returns the sigma of the correlated error of a signal's code.
const CodeWander& code_wander_of(const TrackingSettings& settings, Signal signal);

/// Returns one sigma of the carrier loop (m): (lambda/2pi) sqrt(B/(C/N0) (1 + 1/(2 T C/N0)))   (the same, 8.3.3).
double carrier_noise_m(const TrackingSettings& settings, Signal signal, double cn0_dbhz);

/// Returns one sigma of the range rate (m/s): the change of a noisy carrier over the loop's time constant, sqrt(2)
/// sigma B.
double range_rate_noise_mps(const TrackingSettings& settings, Signal signal, double cn0_dbhz);

// The tracking of one satellite: when its signals are acquired and lost, the initial integer of their carriers' count,
// cycle slips, and which navigation messages have been received.

/// One signal's loops.
struct SignalTrack {
  SignalTrack(Signal of, const engine::RandomStream& draws, const engine::GaussMarkov& of_carrier_m,
              const engine::GaussMarkov& of_code)
      : signal(of), stream(draws), carrier_wander_m(of_carrier_m), code_wander(of_code) {}

  Signal signal;
  engine::RandomStream stream;           ///< stream of its slips, ambiguities and noise
  engine::GaussMarkov carrier_wander_m;  ///< continues whether the signal is tracked or not
  engine::GaussMarkov code_wander;       ///< likewise, in units of its sigma
  bool tracking = false;
  fsw::GpsTime lock_since;            ///< start of the continuous count, as the receiver reports it
  std::int64_t ambiguity_cycles = 0;  ///< added to the true phase
  int slips = 0;                      ///< detected and undetected, since the start
  double cn0_dbhz = 0.0;              ///< C/N0 of the last update
};

class SatelliteTracking {
 public:
  /// Draws from the streams "gnss/<receiver>/<satellite>", "gnss/<receiver>/<satellite>/<signal>", and, of the latter,
  /// ".../carrier_wander" and ".../code_wander" of `seed`.
  SatelliteTracking(SatelliteId satellite, const StartSettings& start, const TrackingSettings& tracking,
                    std::uint64_t seed, std::string_view receiver);

  /// Updates the tracking by one epoch. `cn0_dbhz` has one value for each of signals(), in order; empty if the
  /// satellite is not visible. `first` is the epoch at which the receiver was switched on.
  void update(fsw::GpsTime now, bool first, const std::vector<double>& cn0_dbhz);

  /// Loses all signals: they are searched at the next update.
  void lose();

  /// Adds a slip at the next update, if the signal is tracked then; its whole cycles as given, not zero.
  void command_slip(Signal signal, std::int64_t cycles, bool seen);

  [[nodiscard]] SatelliteId satellite() const { return satellite_; }
  [[nodiscard]] std::vector<SignalTrack>& signals() { return signals_; }
  [[nodiscard]] const std::vector<SignalTrack>& signals() const { return signals_; }

  /// Returns the start of the continuous reception of the navigation message; empty without reception.
  [[nodiscard]] std::optional<fsw::GpsTime> heard_since() const { return heard_since_; }

 private:
  struct CommandedSlip {
    Signal signal;
    std::int64_t cycles;
    bool seen;
  };

  void search(fsw::GpsTime now, bool first);
  void begin(SignalTrack& track, fsw::GpsTime since);
  void slip(SignalTrack& track, fsw::GpsTime now, std::int64_t cycles, bool seen);
  void slip_by_chance(SignalTrack& track, fsw::GpsTime now, double elapsed_s);

  SatelliteId satellite_;
  StartSettings start_;
  TrackingSettings tracking_;
  engine::RandomStream stream_;
  std::vector<SignalTrack> signals_;
  std::optional<fsw::GpsTime> found_;  ///< when the search for it ends or ended
  std::optional<fsw::GpsTime> heard_since_;
  fsw::GpsTime last_update_;
  std::vector<CommandedSlip> commanded_;
};

}  // namespace vbar::twins::gnss
