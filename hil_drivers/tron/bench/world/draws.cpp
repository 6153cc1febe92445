#include "hil_drivers/tron/bench/world/draws.h"

#include <cmath>
#include <numbers>

#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {

using fsw::Vector3;

Eigen::Isometry3d drawn_pose(std::uint64_t seed, const std::string& stream, double rotation_deg,
                             double translation_mm) {
  engine::RandomStream random(seed, stream);
  Vector3 turn, shift;
  for (double& component : turn) component = random.normal() * rotation_deg * std::numbers::pi / 180.0;
  for (double& component : shift) component = random.normal() * 1e-3 * translation_mm;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double angle = turn.norm();
  if (angle > 0.0) pose.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  pose.translation() = shift;
  return pose;
}

Wave::Wave(std::uint64_t seed, const std::string& stream, double sigma, double wavelength_low, double wavelength_high) {
  engine::RandomStream random(seed, stream);
  const double share = sigma / std::sqrt(static_cast<double>(parts_.size()));
  for (Part& part : parts_) {
    part.wavenumber = 2.0 * std::numbers::pi / random.uniform(wavelength_low, wavelength_high);
    part.sine = share * random.normal();
    part.cosine = share * random.normal();
  }
}

double Wave::at(double place) const {
  double sum = 0.0;
  for (const Part& part : parts_) {
    const double angle = part.wavenumber * place;
    sum += part.sine * std::sin(angle) + part.cosine * std::cos(angle);
  }
  return sum;
}

}  // namespace vbar::tron::bench
