// Writes what two emulated receivers send, for RTKLIB's programs to read, and the truth beside it.
//
//   vbar_gnss_tool FOLDER orbit|week_end|ground EPOCHS PERIOD_S
//
// FOLDER gets servicer.gps and target.gps (OEM binary logs), ephemerides.csv (what the satellites say) and truth.csv:
// at each epoch of the clock the true antenna of both, ECEF, m. "orbit": two spacecraft 10 m apart on a circular orbit
// at 709 km, antennas to the zenith; "week_end": the same from half an hour before a GPS week ends; "ground": two
// antennas 8 m apart on the equator. The Earth turns uniformly here: RTKLIB never sees the inertial frame.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>

#include <fmt/format.h>

#include "host_sim/twins/gnss/navigation_message.h"
#include "tests/support/gnss_scene.h"

namespace {

using namespace vbar;
using namespace vbar::twins::gnss;
using fsw::Vector3;

constexpr std::uint64_t kSeed = 7;

// Standing on the turning Earth.
BodyTruth on_ground(double t, const Vector3& position_ecef) {
  const Vector3 position = Eigen::AngleAxisd(fsw::gnss::kEarthRateGps * t, Vector3::UnitZ()) * position_ecef;
  return test::zenith_pointing(position, fsw::gnss::kEarthRateGps * Vector3::UnitZ().cross(position), t);
}

void write(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  for (const std::uint8_t byte : bytes) out.put(static_cast<char>(byte));
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

std::size_t satellites(const GnssReceiver& receiver) {
  std::set<SatelliteId> tracked;
  for (const oem::RangeRecord& record : receiver.observations()) tracked.insert(record.satellite);
  return tracked.size();
}

// What the satellites broadcast at the start, angles and times as their messages have them.
void write_ephemerides(const std::filesystem::path& file, const Constellation& constellation, fsw::GpsTime time) {
  std::ofstream out(file);
  out << "satellite,toe_of_week_s,issue,sqrt_a,e,m0,delta_n,omega0,omega_dot,i0,i_dot,omega,cuc,cus,cic,cis,crc,crs,"
         "af0,af1,af2,group_delay_s\n";
  for (std::size_t k = 0; k < constellation.size(); ++k) {
    const BroadcastSet set = constellation.broadcast_set(k, time);
    const Ephemeris& e = set.ephemeris;
    out << fmt::format("{},{:.0f},{}", name_of(e.satellite), week_time(e.satellite.system, e.toe).seconds_of_week(),
                       set.issue);
    for (const double value : {e.sqrt_a, e.e, e.m0, e.delta_n, node_at_week_begin(e), e.omega_dot, e.i0, e.i_dot,
                               e.omega, e.cuc, e.cus, e.cic, e.cis, e.crc, e.crs, e.af0, e.af1, e.af2, e.group_delay_s})
      out << fmt::format(",{:.15e}", value);
    out << '\n';
  }
}

int run(const std::filesystem::path& folder, const std::string& scene, int epochs, double period_s) {
  const bool orbit = scene != "ground";
  // From Tuesday 16:00 to Saturday 23:30.
  const fsw::Duration later = fsw::duration_of_seconds(scene == "week_end" ? 4 * 86400 + 27000 : 0);
  const auto constellation = test::constellation(kSeed);
  GnssReceiverSettings settings;
  settings.ionosphere = orbit;
  GnssReceiver servicer(settings, constellation, test::data_directory(), kSeed, "servicer");
  GnssReceiver target(settings, constellation, test::data_directory(), kSeed, "target");
  const Vector3 ground(6378137.0, 0.0, 0.0);
  const Vector3 separation = orbit ? Vector3(1.2, -7.9, 0.5) : Vector3(0.0, 6.0, 5.0);
  std::vector<std::uint8_t> servicer_bytes;
  std::vector<std::uint8_t> target_bytes;
  std::ofstream truth(folder / "truth.csv");
  truth << "time_of_week_s,servicer_x,servicer_y,servicer_z,target_x,target_y,target_z,servicer_satellites,"
           "target_satellites\n";
  for (int k = 0; k < epochs; ++k) {
    const double t = k * period_s;
    const auto take = [later](GnssReceiver& receiver, BodyTruth body, std::vector<std::uint8_t>& bytes) {
      body.time = body.time + later;
      const std::vector<std::uint8_t> sent = receiver.bytes_at(body);
      // Logging begins with the first satellite: RTKLIB takes a RANGE without observations for the last one it saw.
      if (!receiver.observations().empty() || !bytes.empty()) bytes.insert(bytes.end(), sent.begin(), sent.end());
    };
    take(servicer, orbit ? test::in_orbit(t) : on_ground(t, ground), servicer_bytes);
    take(target, orbit ? test::in_orbit(t, separation) : on_ground(t, ground + separation), target_bytes);
    const WeekTime time = week_time(System::kGps, test::kGnssStart + later + fsw::nearest_duration(t));
    const Vector3& a = servicer.truth().antenna_ecef;
    const Vector3& b = target.truth().antenna_ecef;
    truth << fmt::format("{:.3f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{},{}\n", time.seconds_of_week(), a.x(),
                         a.y(), a.z(), b.x(), b.y(), b.z(), satellites(servicer), satellites(target));
  }
  write(folder / "servicer.gps", servicer_bytes);
  write(folder / "target.gps", target_bytes);
  write_ephemerides(folder / "ephemerides.csv", *constellation, test::kGnssStart + later);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: vbar_gnss_tool FOLDER orbit|week_end|ground EPOCHS PERIOD_S\n", stderr);
    return 2;
  }
  try {
    return run(argv[1], argv[2], std::atoi(argv[3]), std::atof(argv[4]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
