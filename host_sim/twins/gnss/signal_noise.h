#pragma once
// From transmitted power to C/N0, and from C/N0 to the noise of the loops.

#include <filesystem>
#include <vector>

#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::twins::gnss {

/// Attenuation of the receiving antenna against the angle from its boresight.
class AntennaPattern {
 public:
  /// Reads data_directory/gps/receiver_antenna_typical_patch.csv: angles from 0 to 180 deg, rising. Throws
  /// std::runtime_error naming file and line.
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

/// Returns one sigma of the code loop (m), coherent early minus late power discriminator:
///   (c/Rc) sqrt(B d/(2 C/N0) (1 + 2/((2-d) T C/N0)))   (Kaplan, Hegarty 2017, 8.4.3).
double code_noise_m(const TrackingSettings& settings, Signal signal, double cn0_dbhz);

/// Returns one sigma of the carrier loop (m): (lambda/2pi) sqrt(B/(C/N0) (1 + 1/(2 T C/N0)))   (the same, 8.3.3).
double carrier_noise_m(const TrackingSettings& settings, Signal signal, double cn0_dbhz);

/// Returns one sigma of the range rate (m/s): the change of a noisy carrier over the loop's time constant, sqrt(2)
/// sigma B.
double range_rate_noise_mps(const TrackingSettings& settings, Signal signal, double cn0_dbhz);

}  // namespace vbar::twins::gnss
