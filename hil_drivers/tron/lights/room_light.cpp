#include "hil_drivers/tron/lights/room_light.h"

#include <algorithm>

namespace vbar::tron {
namespace {

std::array<double, kBoxes> full_light(const PhotometricTable& table) {
  std::array<double, kBoxes> full{};
  for (std::size_t k = 0; k < kBoxes; ++k) full[k] = table.box(k).full_light();
  return full;
}

}  // namespace

RoomLight::RoomLight(const BenchFile& bench, const Calibration& calibration, const PhotometricTable& table)
    : calibration_(calibration),
      boxes_(bench, full_light(table)),
      centre_T_(0.5 * bench.scale * (bench.target.body_low_m + bench.target.body_high_m)) {}

LightLevels RoomLight::levels(const Scene& scene, const Place& place) {
  LightLevels levels;
  levels.lamp_power = std::clamp(scene.sunlit, 0.0, 1.0);
  levels.lamp_azimuth_rad = place.lamp_azimuth_rad;
  if (!(scene.earth_to_sun > 0.0)) return levels;
  const Eigen::Isometry3d T_L_T = T_L_T_of_arm(calibration_, place.posture);
  // The laboratory as the target sees it: its attitude to the light counts, not the camera's small error.
  const fsw::Matrix3 R_L_C = T_L_T.linear() * scene.T_C_T.linear().transpose();
  const EarthLight earth{R_L_C * scene.earth_C.normalized(), scene.earth_half_angle, scene.earth_to_sun};
  const BoxPowers boxes = boxes_.powers(T_L_T * centre_T_, earth);
  levels.box_power = boxes.power;
  levels.earth_misfit = boxes.misfit;
  return levels;
}

}  // namespace vbar::tron
