#include "hil_drivers/tron/lights/room_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vbar::tron {

namespace {

std::uint16_t value_of(double share) {
  if (!(share > 0.0)) return 0;
  constexpr double kFull = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(std::lround(kFull * std::min(share, 1.0)));
}

}  // namespace

LightValues light_values(const LightLevels& levels, const Lamp& lamp, const PhotometricTable& table) {
  LightValues values{};
  values[0] = value_of(table.lamp().level(levels.lamp_power));
  const double arc_rad = lamp.azimuth_high_rad - lamp.azimuth_low_rad;
  if (arc_rad > 0.0) values[1] = value_of((levels.lamp_azimuth_rad - lamp.azimuth_low_rad) / arc_rad);
  for (std::size_t k = 0; k < kBoxes; ++k) values[2 + k] = value_of(table.box(k).level(levels.box_power[k]));
  return values;
}

namespace {

std::array<double, kBoxes> full_light(const PhotometricTable& table) {
  std::array<double, kBoxes> full{};
  for (std::size_t k = 0; k < kBoxes; ++k) full[k] = table.box(k).full_light();
  return full;
}

}  // namespace

RoomLight::RoomLight(const TestbedDesign& bench, const Calibration& calibration, const PhotometricTable& table)
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
