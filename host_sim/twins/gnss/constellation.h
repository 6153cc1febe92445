#pragma once
// The broadcast ionosphere of GPS (Klobuchar 1987; IS-GPS-200N 20.3.3.5.2.5) and its part above a low orbit.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::twins::gnss {

struct KlobucharCoefficients {
  std::array<double, 4> alpha{};  ///< s, s/semicircle, ...
  std::array<double, 4> beta{};
  friend bool operator==(const KlobucharCoefficients&, const KlobucharCoefficients&) = default;
};

/// Returns the delay of an L1 signal on the ground, m. Latitude, longitude (geodetic), elevation, azimuth in rad; time
/// of GPS week.
double klobuchar_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude, double elevation,
                         double azimuth, double seconds_of_week);

/// Returns the vertical delay at a point of the ionosphere (latitude, longitude of the piercing point), m.
double klobuchar_vertical_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude,
                                  double seconds_of_week);

/// Returns the share of the electron content that lies above `altitude_m` (1 at the ground): a Chapman-like profile
/// with its peak at 420 km and a scale height of 100 km (Montenbruck, Gill 2002: "Ionospheric correction for GPS
/// tracking of LEO satellites"). Altitudes below the ground count as the ground.
double electron_content_above(double altitude_m);

/// Returns the altitude of the thin shell that represents the electrons above `altitude_m`: half of them lie below it,
/// m (the same source).
double shell_altitude_m(double altitude_m);

/// Returns the delay of an L1 signal at a point in or above the ionosphere, m: the model's vertical delay where the
/// line of sight pierces that shell, the share above the point, slant by the shell's geometry, which holds for
/// elevations below the horizontal too. Both vectors in ECEF; `line_of_sight` is the unit vector to the satellite.
double klobuchar_delay_in_orbit_m(const KlobucharCoefficients& coefficients, const fsw::Vector3& position_ecef,
                                  const fsw::Vector3& line_of_sight, double seconds_of_week);

// The navigation satellites of a run: true motion and broadcast messages. One object serves every receiver.
//
// The true motion of a satellite follows one set of real broadcast elements, plus an error in radial, transverse and
// normal direction and of its clock, each a constant and a sine of the orbit's period, drawn per satellite and seed:
// the "uncorrected broadcast" of the paper's table. The broadcast sets of all reference times describe that same motion
// without the error, rounded to the bits of the navigation message: so the difference steps by centimetres where a new
// set begins, as that of real ones does by decimetres. The elements' day is moved to the mission's by whole days with
// Earth-fixed geometry kept: at the same time of day each satellite is above the same point. Real elements are fitted
// to four hours; here they define the motion for as long as the run lasts.

/// Satellites of a system that fly. kBroadcast: those of the system's real broadcast file (GPS 31 of 2011-10-20; 4
/// Galileo, 14 BeiDou of 2013-07-19). kNominal: the full constellation by its definition (Galileo: Walker 24/3/1 at 56
/// deg, 29600.318 km; BeiDou-3: Walker 24/3/1 at 55 deg, 27906.1 km, its medium orbits only); GPS has none.
enum class SatelliteSet : std::uint8_t { kNone, kBroadcast, kNominal };

struct ConstellationSettings {
  SatelliteSet gps = SatelliteSet::kBroadcast;
  SatelliteSet galileo = SatelliteSet::kBroadcast;
  SatelliteSet beidou = SatelliteSet::kBroadcast;
  /// Files of kBroadcast: absolute, or from the data folder; empty: those of the data folder. The satellites of a
  /// system come from the first file that has any.
  std::vector<std::filesystem::path> navigation_files{};
  // True minus broadcast, one sigma. Sizes of 2011: signal-in-space range error about 1 m.
  double orbit_error_radial_m = 0.4;
  double orbit_error_transverse_m = 1.5;
  double orbit_error_normal_m = 1.0;
  double clock_error_ns = 1.5;
  friend bool operator==(const ConstellationSettings&, const ConstellationSettings&) = default;
};

/// Throws std::invalid_argument naming the setting, what was found and what is accepted.
void check(const ConstellationSettings& settings);

/// Ionosphere and UTC parameters that the satellites broadcast.
struct BroadcastCorrections {
  KlobucharCoefficients klobuchar;
  double utc_a0_s = 0.0;
  double utc_a1 = 0.0;
  friend bool operator==(const BroadcastCorrections&, const BroadcastCorrections&) = default;
};

/// A broadcast set and the number that identifies it (IODE, IODnav, AODE).
struct BroadcastSet {
  Ephemeris ephemeris;  ///< rounded to the message's bits
  int issue = 0;
};

class Constellation {
 public:
  /// Reads the navigation files, by default those of data_directory/gps. `epoch` gives the day that the elements are
  /// moved to. Errors are drawn from the streams "gnss/constellation/<satellite>" of `seed`. Throws std::runtime_error
  /// naming file and line, std::invalid_argument for settings.
  Constellation(const std::filesystem::path& data_directory, const ConstellationSettings& settings, fsw::GpsTime epoch,
                std::uint64_t seed);

  /// Returns the number of satellites, which are in order of system and number.
  [[nodiscard]] std::size_t size() const { return satellites_.size(); }
  [[nodiscard]] SatelliteId id(std::size_t index) const { return satellites_[index].base.satellite; }

  /// Returns the true state and clock of the satellite, `offset_s` after `time`. The errors' own velocity (0.2 mm/s) is
  /// included in position only.
  [[nodiscard]] SatelliteState true_state(std::size_t index, fsw::GpsTime time, double offset_s) const;

  /// Returns the true group delay of the satellite's first signal, s; broadcast values are taken as true.
  [[nodiscard]] double group_delay_s(std::size_t index) const { return satellites_[index].base.group_delay_s; }

  /// Returns the set that the satellite transmits at `time`. GPS: a new one every two hours, with toe at their end;
  /// Galileo and BeiDou: every hour, with toe at its beginning.
  [[nodiscard]] BroadcastSet broadcast_set(std::size_t index, fsw::GpsTime time) const;

  [[nodiscard]] const BroadcastCorrections& corrections() const { return corrections_; }

  /// Returns the notes on the content of the navigation files that is not used.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  // Constant plus a sine of the orbit's period.
  struct SlowError {
    double constant = 0.0;
    double amplitude = 0.0;
    double phase = 0.0;
    [[nodiscard]] double at(double orbit_angle) const;
  };
  struct Satellite {
    Ephemeris base;
    SlowError radial_m, transverse_m, normal_m, clock_s;
  };

  std::vector<Satellite> satellites_;
  BroadcastCorrections corrections_;
  std::vector<std::string> notes_;
};

}  // namespace vbar::twins::gnss
