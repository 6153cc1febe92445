#include "host_sim/twins/gnss/constellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/navigation_message.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {
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
