// Writes what two emulated receivers send, for RTKLIB's programs to read, and the truth beside it.
//
//   vbar_gnss_tool FOLDER orbit|ground EPOCHS PERIOD_S
//
// FOLDER gets servicer.gps and target.gps (OEM binary logs) and truth.csv: at each epoch of the clock the true antenna
// of both, ECEF, m. "orbit": two spacecraft 10 m apart on a circular orbit at 709 km, antennas to the zenith; "ground":
// two antennas 8 m apart on the equator. The Earth turns uniformly here: RTKLIB never sees the inertial frame.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/gnss/system_time.h"

namespace {

using namespace vbar;
using namespace vbar::twins::gnss;
using fsw::Vector3;

// 2011-07-19 16:00:00 GPS, near the start of the third experiment.
constexpr fsw::GpsTime kStart = gps_time_of(System::kGps, 1645, 2 * 86400 + 57600);
constexpr std::uint64_t kSeed = 7;

struct Motion {
  Vector3 position_eci;
  Vector3 velocity_eci;
};

// Circular orbit, inclined 98 deg, `ahead_m` along the track and `up_m` and `across_m` beside the reference.
Motion in_orbit(double t, const Vector3& offset_rtn) {
  constexpr double kRadius = 7087.3e3;
  const double rate = std::sqrt(fsw::gnss::kGmGps / (kRadius * kRadius * kRadius));
  const double u = rate * t + offset_rtn.y() / kRadius;
  const double i = 98.18 * std::numbers::pi / 180.0;
  const Vector3 p(std::cos(u), std::sin(u) * std::cos(i), std::sin(u) * std::sin(i));
  const Vector3 q(-std::sin(u), std::cos(u) * std::cos(i), std::cos(u) * std::sin(i));
  const Vector3 w = p.cross(q);
  const double radius = kRadius + offset_rtn.x();
  return {radius * p + offset_rtn.z() * w, radius * rate * q};
}

Motion on_ground(double turn, const Vector3& position_ecef) {
  const Vector3 position = Eigen::AngleAxisd(turn, Vector3::UnitZ()) * position_ecef;
  return {position, fsw::gnss::kEarthRateGps * Vector3::UnitZ().cross(position)};
}

CarrierTruth truth_of(const Motion& motion, fsw::GpsTime time, double turn) {
  CarrierTruth truth;
  truth.time = time;
  truth.position_eci = motion.position_eci;
  truth.velocity_eci = motion.velocity_eci;
  truth.R_ecef_eci = Eigen::AngleAxisd(-turn, Vector3::UnitZ()).toRotationMatrix();
  // Body z to the zenith, x along the velocity's horizontal part.
  const Vector3 z = motion.position_eci.normalized();
  const Vector3 y = z.cross(motion.velocity_eci).normalized();
  fsw::Matrix3 R_eci_body;
  R_eci_body << y.cross(z), y, z;
  truth.q_body_eci = Eigen::Quaterniond(R_eci_body.transpose());
  truth.rate_body_eci = motion.position_eci.cross(motion.velocity_eci) / motion.position_eci.squaredNorm();
  return truth;
}

void write(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  for (const std::uint8_t byte : bytes) out.put(static_cast<char>(byte));
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

int run(const std::filesystem::path& folder, bool orbit, int epochs, double period_s) {
  const std::filesystem::path data = std::filesystem::path(VBAR_SOURCE_DIR) / "data";
  const auto constellation = std::make_shared<const Constellation>(data, ConstellationSettings{}, kStart, kSeed);
  GnssReceiverSettings settings;
  // RTKLIB's kinematic solution follows neither: slips flagged are theirs to handle, but the phase must be one phase.
  GnssReceiver servicer(settings, constellation, data, kSeed, "servicer");
  GnssReceiver target(settings, constellation, data, kSeed, "target");
  const Vector3 ground(6378137.0, 0.0, 0.0);
  std::vector<std::uint8_t> servicer_bytes;
  std::vector<std::uint8_t> target_bytes;
  std::ofstream truth(folder / "truth.csv");
  truth << "time_of_week_s,servicer_x,servicer_y,servicer_z,target_x,target_y,target_z\n";
  for (int k = 0; k < epochs; ++k) {
    const double t = k * period_s;
    const fsw::GpsTime time = kStart + fsw::nearest_duration(t);
    const double turn = fsw::gnss::kEarthRateGps * t;
    const Vector3 separation = orbit ? Vector3(1.2, -7.9, 0.5) : Vector3(0.0, 6.0, 5.0);
    const Motion first = orbit ? in_orbit(t, Vector3::Zero()) : on_ground(turn, ground);
    const Motion second = orbit ? in_orbit(t, separation) : on_ground(turn, ground + separation);
    for (const auto& [receiver, motion, bytes] :
         {std::tuple{&servicer, &first, &servicer_bytes}, std::tuple{&target, &second, &target_bytes}}) {
      const std::vector<std::uint8_t> sent = receiver->bytes_at(truth_of(*motion, time, turn));
      // Logging begins with the first satellite: RTKLIB takes a RANGE without observations for the last one it saw.
      if (!receiver->observations().empty() || !bytes->empty()) bytes->insert(bytes->end(), sent.begin(), sent.end());
    }
    const Vector3& a = servicer.truth().antenna_ecef;
    const Vector3& b = target.truth().antenna_ecef;
    truth << fmt::format("{:.3f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n",
                         week_time(System::kGps, time).seconds_of_week(), a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
  }
  write(folder / "servicer.gps", servicer_bytes);
  write(folder / "target.gps", target_bytes);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: vbar_gnss_tool FOLDER orbit|ground EPOCHS PERIOD_S\n", stderr);
    return 2;
  }
  try {
    return run(argv[1], std::string(argv[2]) == "orbit", std::atoi(argv[3]), std::atof(argv[4]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
