#include "host_sim/twins/gnss/constellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fsw/gnss/constants.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/navigation_message.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {

namespace {

constexpr double kPi = std::numbers::pi;
// Parameters of the share above an altitude: peak of the electrons and scale height (Montenbruck, Gill 2002).
constexpr double kPeakAltitude_m = 420e3;
constexpr double kScaleHeight_m = 100e3;
constexpr double kMeanEarthRadius_m = 6371e3;

// The integrated profile: rises from 0 deep below the peak to e far above it.
double integrated_profile(double altitude_m) {
  return std::exp(1.0 - std::exp(-(altitude_m - kPeakAltitude_m) / kScaleHeight_m));
}

double polynomial(const std::array<double, 4>& c, double x) {
  return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

// Where the series of the cosine is taken as zero. The specification's value leaves a step of 2 % of the amplitude,
// through which two receivers some hundred metres apart pass a tenth of a second after each other: a contradiction of
// their carrier phases. Above the ground, where the model is this project's own, the series ends at its zero.
constexpr double kSpecifiedHalfWidth = 1.57;
const double kContinuousHalfWidth = std::sqrt(6.0 - std::sqrt(12.0));

// Delay at the ionospheric point (semicircles) for obliquity factor F, m.
double delay_at_point_m(const KlobucharCoefficients& coefficients, double latitude_sc, double longitude_sc,
                        double obliquity, double seconds_of_week, double half_width) {
  const double geomagnetic_sc = latitude_sc + 0.064 * std::cos((longitude_sc - 1.617) * kPi);
  double local_time_s = std::fmod(4.32e4 * longitude_sc + seconds_of_week, 86400.0);
  if (local_time_s < 0.0) local_time_s += 86400.0;
  const double amplitude_s = std::max(0.0, polynomial(coefficients.alpha, geomagnetic_sc));
  const double period_s = std::max(72000.0, polynomial(coefficients.beta, geomagnetic_sc));
  const double x = 2.0 * kPi * (local_time_s - 50400.0) / period_s;
  double delay_s = 5e-9;
  if (std::abs(x) < half_width) delay_s += amplitude_s * (1.0 - x * x / 2.0 + x * x * x * x / 24.0);
  return fsw::gnss::kSpeedOfLight * obliquity * delay_s;
}

}  // namespace

double klobuchar_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude, double elevation,
                         double azimuth, double seconds_of_week) {
  const double elevation_sc = elevation / kPi;
  const double earth_angle_sc = 0.0137 / (elevation_sc + 0.11) - 0.022;
  const double latitude_sc = std::clamp(latitude / kPi + earth_angle_sc * std::cos(azimuth), -0.416, 0.416);
  const double longitude_sc = longitude / kPi + earth_angle_sc * std::sin(azimuth) / std::cos(latitude_sc * kPi);
  const double below = 0.53 - elevation_sc;
  return delay_at_point_m(coefficients, latitude_sc, longitude_sc, 1.0 + 16.0 * below * below * below, seconds_of_week,
                          kSpecifiedHalfWidth);
}

double klobuchar_vertical_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude,
                                  double seconds_of_week) {
  return delay_at_point_m(coefficients, std::clamp(latitude / kPi, -0.416, 0.416), longitude / kPi, 1.0,
                          seconds_of_week, kContinuousHalfWidth);
}

double electron_content_above(double altitude_m) {
  const double ground = integrated_profile(0.0);
  return (std::numbers::e - integrated_profile(std::max(altitude_m, 0.0))) / (std::numbers::e - ground);
}

double shell_altitude_m(double altitude_m) {
  const double half = (std::numbers::e + integrated_profile(std::max(altitude_m, 0.0))) / 2.0;
  return kPeakAltitude_m - kScaleHeight_m * std::log(1.0 - std::log(half));
}

double klobuchar_delay_in_orbit_m(const KlobucharCoefficients& coefficients, const fsw::Vector3& position_ecef,
                                  const fsw::Vector3& line_of_sight, double seconds_of_week) {
  const double radius_m = position_ecef.norm();
  const double altitude_m = radius_m - kMeanEarthRadius_m;
  const double shell_m = kMeanEarthRadius_m + shell_altitude_m(altitude_m);
  const double along_m = position_ecef.dot(line_of_sight);  // r sin(elevation)
  const double cos_elevation_squared = 1.0 - along_m * along_m / (radius_m * radius_m);
  const double sine = radius_m * radius_m * cos_elevation_squared / (shell_m * shell_m);
  const double slant = 1.0 / std::sqrt(1.0 - sine);
  const double to_shell_m = -along_m + std::sqrt(along_m * along_m + shell_m * shell_m - radius_m * radius_m);
  const fsw::Vector3 pierce = position_ecef + to_shell_m * line_of_sight;
  // Spherical latitude is enough for a model of half the true delay.
  const double latitude = std::asin(pierce.z() / pierce.norm());
  const double longitude = std::atan2(pierce.y(), pierce.x());
  return klobuchar_vertical_delay_m(coefficients, latitude, longitude, seconds_of_week) *
         electron_content_above(altitude_m) * slant;
}

namespace {

using fsw::Vector3;

constexpr std::int64_t kDay_ns = 86400 * fsw::kNanosecondsPerSecond;

// A Walker delta pattern 24/3/1 of circular orbits whose nodes precess by J2, at its reference point at `toe`.
struct WalkerPattern {
  System system;
  double semi_major_axis_m;
  double inclination_deg;
};
constexpr WalkerPattern kNominalGalileo{System::kGalileo, 29600.318e3, 56.0};  // Galileo OS SDD 1.3, annex C
constexpr WalkerPattern kNominalBeidou{System::kBeidou, 27906.1e3, 55.0};      // BDS-OS-PS-3.0, 3.2
constexpr int kWalkerPlanes = 3;
constexpr int kWalkerPerPlane = 8;
// BeiDou's medium orbits are numbered from 19 on (1 to 5 are geostationary).
constexpr int kFirstNominalBeidou = 19;

std::vector<Ephemeris> walker_satellites(const WalkerPattern& pattern, fsw::GpsTime toe) {
  constexpr double kJ2 = 1.0826e-3;
  constexpr double kEarthRadius_m = 6378137.0;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  constexpr int kTotal = kWalkerPlanes * kWalkerPerPlane;
  std::vector<Ephemeris> satellites;
  for (int plane = 0; plane < kWalkerPlanes; ++plane) {
    for (int place = 0; place < kWalkerPerPlane; ++place) {
      Ephemeris set;
      const int first = pattern.system == System::kBeidou ? kFirstNominalBeidou : 1;
      set.satellite = {pattern.system, first + plane * kWalkerPerPlane + place};
      set.toe = toe;
      set.sqrt_a = std::sqrt(pattern.semi_major_axis_m);
      set.i0 = pattern.inclination_deg * std::numbers::pi / 180.0;
      set.node_at_toe = kTurn * plane / kWalkerPlanes;
      set.m0 = kTurn * place / kWalkerPerPlane + kTurn * plane / kTotal;
      const double ratio = kEarthRadius_m / pattern.semi_major_axis_m;
      set.omega_dot = -1.5 * kJ2 * ratio * ratio * mean_motion(set) * std::cos(set.i0);
      satellites.push_back(set);
    }
  }
  return satellites;
}

// The tilted frame of the geostationary satellites' model rotates with its reference time, so that only sets without
// harmonics and rates describe one motion. Their orbit keeps its shape; the node's rate goes into the mean motion, so
// that the satellite stays at its longitude.
Ephemeris without_rates(Ephemeris set) {
  set.delta_n += set.omega_dot * std::cos(set.i0);
  set.omega_dot = set.i_dot = 0.0;
  set.cuc = set.cus = set.cic = set.cis = set.crc = set.crs = 0.0;
  return set;
}

// Moves a set by the whole days that bring it nearest to noon of the epoch's day.
Ephemeris on_day_of(Ephemeris set, fsw::GpsTime epoch) {
  const fsw::GpsTime noon{epoch.ns / kDay_ns * kDay_ns + kDay_ns / 2};
  const double days = std::round(seconds(noon - set.toe) / 86400.0);
  set.toe = set.toe + fsw::Duration{static_cast<std::int64_t>(days) * kDay_ns};
  return set;
}

std::vector<EphemerisFile> navigation_files_of(const std::filesystem::path& data_directory,
                                               const ConstellationSettings& settings) {
  std::vector<std::filesystem::path> paths = settings.navigation_files;
  if (paths.empty()) paths = {"gps/gps_2011_10_20.csv", "gps/galileo_beidou_2013_07_19.csv"};
  std::vector<EphemerisFile> files;
  const auto is_read = [](SatelliteSet which) { return which == SatelliteSet::kBroadcast; };
  const SystemSet used{is_read(settings.gps), is_read(settings.galileo), is_read(settings.beidou)};
  for (const std::filesystem::path& path : paths) files.push_back(read_ephemeris_file(data_directory / path, used));
  return files;
}

/// Returns the corrections of the first file that has any.
BroadcastCorrections corrections_of(const std::vector<EphemerisFile>& files) {
  const auto found =
      std::ranges::find_if(files, [](const EphemerisFile& file) { return file.corrections != BroadcastCorrections{}; });
  return found == files.end() ? BroadcastCorrections{} : found->corrections;
}

std::vector<Ephemeris> satellites_of(System system, const std::vector<EphemerisFile>& files) {
  std::vector<Ephemeris> satellites;
  for (const EphemerisFile& file : files) {
    for (const Ephemeris& set : file.satellites)
      if (set.satellite.system == system) satellites.push_back(set);
    if (!satellites.empty()) return satellites;
  }
  constexpr std::array<const char*, kSystems> kKeys{"gps", "galileo", "beidou"};
  std::string notes;
  for (const EphemerisFile& file : files)
    if (!file.note.empty()) notes += " " + file.note;
  throw std::runtime_error(
      fmt::format("constellation.navigation_files: no file has a satellite of {0}; constellation.{0} = \"broadcast\" "
                  "needs one{1}{2}",
                  kKeys[static_cast<std::size_t>(system)], notes.empty() ? "" : ".", notes));
}

struct SetSchedule {
  std::int64_t period_s;
  std::int64_t toe_after_begin_s;
  int issues;  ///< numbers the message has for its sets
};
SetSchedule schedule_of(System system) {
  switch (system) {
    case System::kGps:
      return {7200, 7200, 240};
    case System::kGalileo:
      return {3600, 0, 1024};
    case System::kBeidou:
      return {3600, 0, 24};
  }
  return {};
}

void need_not_negative(const char* name, double value) {
  if (!(value >= 0.0 && value <= 1e6))
    throw std::invalid_argument(fmt::format("{} = {}: accepted is 0 to 1e6", name, value));
}

}  // namespace

void check(const ConstellationSettings& settings) {
  if (settings.gps == SatelliteSet::kNominal)
    throw std::invalid_argument("gps = nominal: GPS has no nominal set; accepted are none and broadcast");
  need_not_negative("orbit_error_radial_m", settings.orbit_error_radial_m);
  need_not_negative("orbit_error_transverse_m", settings.orbit_error_transverse_m);
  need_not_negative("orbit_error_normal_m", settings.orbit_error_normal_m);
  need_not_negative("clock_error_ns", settings.clock_error_ns);
}

double Constellation::SlowError::at(double orbit_angle) const {
  return constant + amplitude * std::sin(orbit_angle + phase);
}

Constellation::Constellation(const std::filesystem::path& data_directory, const ConstellationSettings& settings,
                             fsw::GpsTime epoch, std::uint64_t seed) {
  check(settings);
  const std::vector<EphemerisFile> files = navigation_files_of(data_directory, settings);
  corrections_ = corrections_of(files);
  for (const EphemerisFile& file : files)
    if (!file.note.empty()) notes_.push_back(file.note);

  std::vector<Ephemeris> sets;
  const auto add = [&](System system, SatelliteSet which) {
    if (which == SatelliteSet::kBroadcast)
      for (const Ephemeris& set : satellites_of(system, files))
        sets.push_back(on_day_of(is_geostationary(set.satellite) ? without_rates(set) : set, epoch));
    if (which == SatelliteSet::kNominal) {
      const WalkerPattern& pattern = system == System::kGalileo ? kNominalGalileo : kNominalBeidou;
      const fsw::GpsTime noon{epoch.ns / kDay_ns * kDay_ns + kDay_ns / 2};
      for (const Ephemeris& set : walker_satellites(pattern, noon + gps_minus_system_time(system))) sets.push_back(set);
    }
  };
  add(System::kGps, settings.gps);
  add(System::kGalileo, settings.galileo);
  add(System::kBeidou, settings.beidou);
  if (sets.empty()) throw std::invalid_argument("gps, galileo and beidou are all none: no satellite is left");

  for (const Ephemeris& set : sets) {
    engine::RandomStream stream(seed, "gnss/constellation/" + name_of(set.satellite));
    // Half of the variance in the constant; a normal amplitude at a uniform phase gives the other half.
    const auto draw = [&stream](double sigma) {
      const double constant = stream.normal() * sigma * std::numbers::sqrt2 / 2.0;
      const double amplitude = stream.normal() * sigma;
      return SlowError{constant, amplitude, stream.uniform(0.0, 2.0 * std::numbers::pi)};
    };
    Satellite satellite{.base = set,
                        .radial_m = draw(settings.orbit_error_radial_m),
                        .transverse_m = draw(settings.orbit_error_transverse_m),
                        .normal_m = draw(settings.orbit_error_normal_m),
                        .clock_s = draw(settings.clock_error_ns * 1e-9)};
    satellites_.push_back(satellite);
  }
  std::sort(satellites_.begin(), satellites_.end(),
            [](const Satellite& a, const Satellite& b) { return a.base.satellite < b.base.satellite; });
}

SatelliteState Constellation::true_state(std::size_t index, fsw::GpsTime time, double offset_s) const {
  const Satellite& satellite = satellites_[index];
  SatelliteState state = satellite_state(satellite.base, time, offset_s);
  const double angle = mean_motion(satellite.base) * (seconds(time - satellite.base.toe) + offset_s);
  const Vector3 inertial_velocity =
      state.velocity_ecef + earth_rate(satellite.base.satellite.system) * Vector3::UnitZ().cross(state.position_ecef);
  const Vector3 radial = state.position_ecef.normalized();
  const Vector3 normal = state.position_ecef.cross(inertial_velocity).normalized();
  state.position_ecef += satellite.radial_m.at(angle) * radial +
                         satellite.transverse_m.at(angle) * normal.cross(radial) +
                         satellite.normal_m.at(angle) * normal;
  state.clock_s += satellite.clock_s.at(angle);
  return state;
}

BroadcastSet Constellation::broadcast_set(std::size_t index, fsw::GpsTime time) const {
  const Ephemeris& base = satellites_[index].base;
  const System system = base.satellite.system;
  const SetSchedule schedule = schedule_of(system);
  const std::int64_t period_ns = schedule.period_s * fsw::kNanosecondsPerSecond;
  const fsw::Duration shift = gps_minus_system_time(system);
  const std::int64_t number = (time - shift).ns / period_ns;
  const fsw::GpsTime toe =
      fsw::GpsTime{number * period_ns} + shift + fsw::duration_of_seconds(schedule.toe_after_begin_s);
  return {rounded_to_message(with_reference_time(base, toe)), static_cast<int>(number % schedule.issues)};
}

}  // namespace vbar::twins::gnss
