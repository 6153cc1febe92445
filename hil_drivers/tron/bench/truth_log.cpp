#include "hil_drivers/tron/bench/truth_log.h"

#include <numbers>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace vbar::tron::bench {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr std::array<const char*, kMountedThings> kMountedNames{"target", "board", "patch"};

std::string header() {
  std::string line =
      "image,cycle,bench_s,exposure_s,mounted,C_x_m,C_y_m,C_z_m,q_C_T_w,q_C_T_x,q_C_T_y,q_C_T_z,carriage_m";
  for (std::size_t k = 1; k <= kJoints; ++k) line += fmt::format(",camera_A{}_deg", k);
  for (std::size_t k = 1; k <= kJoints; ++k) line += fmt::format(",target_A{}_deg", k);
  line += ",lamp_power,lamp_azimuth_deg";
  for (std::size_t k = 1; k <= kBoxes; ++k) line += fmt::format(",box{}_power", k);
  return line + ",markers_of_camera,markers_of_target";
}

}  // namespace

TruthLog::TruthLog(const std::filesystem::path& file) : file_(file) {
  if (!file_) throw std::runtime_error(fmt::format("{}: cannot be made", file.string()));
  file_ << header() << std::endl;
}

void TruthLog::write(const TrueExposure& exposure) {
  const fsw::Vector3 r = exposure.T_C_mounted.translation();
  Eigen::Quaterniond q(exposure.T_C_mounted.rotation());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  std::string line =
      fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", exposure.image, exposure.cycle, exposure.bench_s,
                  exposure.exposure_s, kMountedNames[static_cast<std::size_t>(exposure.mounted)], r.x(), r.y(), r.z(),
                  q.w(), q.x(), q.y(), q.z(), exposure.posture.carriage_m);
  for (const double rad : exposure.posture.camera_rad) line += fmt::format(",{}", rad * kDegreesPerRadian);
  for (const double rad : exposure.posture.target_rad) line += fmt::format(",{}", rad * kDegreesPerRadian);
  line += fmt::format(",{},{}", exposure.lamp_power, exposure.lamp_azimuth_rad * kDegreesPerRadian);
  for (const double power : exposure.box_power) line += fmt::format(",{}", power);
  line += fmt::format(",{},{}", exposure.markers_of_camera, exposure.markers_of_target);
  file_ << line << std::endl;
}

}  // namespace vbar::tron::bench
