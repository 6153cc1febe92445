#pragma once
// Views of the laboratory for tests, and the digital twin's image of the same scene in orbit.

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "emulators/tron/scene/lab_view.h"
#include "emulators/tron/scene/radiometry.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/photometry.h"
#include "host_sim/twins/camera/photon_image.h"
#include "host_sim/twins/camera/point_spread.h"
#include "tests/support/paths.h"

namespace vbar::tron::bench::tests {

using fsw::Matrix3;
using fsw::Vector2;
using fsw::Vector3;
namespace camera = twins::camera;

inline TestbedDesign tron_bench() {
  return read_testbed_design(vbar::tests::source_path("data/benches/tron.toml"));
}

/// Of data/cameras/tron.toml, read with 12 bits as in experiment 2.
inline camera::CameraSettings tron_camera() {
  camera::CameraSettings settings;
  settings.optics.focal_length_mm = 17.0;
  settings.optics.f_number = 4.0;
  settings.optics.distortion = {-0.22383, 0.514098, -0.000664997, -0.000214048, -0.131243};
  settings.optics.point_spread_sigma_px = 0.6;
  settings.optics.vignetting = 0.25;
  settings.region = {160, 100, 1600, 1000};
  settings.exposure_s = 470e-6;
  return settings;
}

/// The camera at `distance_m` in front of the middle of the beam, looking along +x; the body turned by `attitude` from
/// the one that shows its -x side upright.
inline LabView view_of(double distance_m, const Eigen::AngleAxisd& attitude = Eigen::AngleAxisd::Identity()) {
  LabView view;
  Matrix3 R_L_C;
  R_L_C << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.T_L_C.linear() = R_L_C;
  view.T_L_C.translation() = Vector3(6.5 - distance_m, 0.0, 1.4);
  view.T_L_T.linear() = attitude.toRotationMatrix();
  view.T_L_T.translation() = Vector3(6.5, 0.0, 1.4);
  view.lamp = {70.0 * M_PI / 180.0, 1.0};
  view.box_powers.fill(0.0);
  view.box_powers[5] = view.box_powers[6] = 0.3;
  view.camera = tron_camera();
  return view;
}

inline Eigen::AngleAxisd some_attitude() {
  return {2.0, Vector3(0.3, -0.7, 0.5).normalized()};
}

/// The digital twin's image of the scene in orbit of which `view` is the laboratory's: distance and size divided by the
/// bench's scale, exposure times the lamp's irradiance ratio, Earth as a disc of the boxes' vector of irradiance.
inline camera::PhotonImage twin_image(camera::TargetRenderer& renderer, const TestbedDesign& bench, const LabView& view,
                                      const Vector3& centre_body) {
  const double sun = camera::sun_photons(view.camera.zero_magnitude_photons, camera::kAstronomicalUnit);
  const double ratio = bench.lamp.irradiance_ratio * view.lamp.power;
  const Eigen::Isometry3d T_C_T = view.T_L_C.inverse() * view.T_L_T;
  camera::TargetView target;
  target.position_camera = T_C_T.translation() / bench.scale;
  target.R_camera_body = T_C_T.linear();
  target.sun_camera = view.T_L_C.linear().transpose() * Lamp::direction(view.lamp.azimuth_rad);
  target.sun_photons_per_m2_s = sun;
  const Vector3 earth = light_vector(box_lights(bench, view.box_powers, sun), view.T_L_T * (bench.scale * centre_body));
  target.earth_photons_per_m2_s = earth.norm() / ratio;
  if (earth.norm() > 0.0) target.nadir_camera = view.T_L_C.linear().transpose() * earth.normalized();
  target.earth_half_angle = 1.12;
  target.texel_pitch = 0.5 / view.camera.focal_length_px();
  std::vector<camera::LightSample> samples;
  renderer.render(target, samples);

  camera::CameraSettings settings = view.camera;
  settings.exposure_s *= ratio;
  const camera::Optics optics(settings);
  std::vector<camera::ImagePoint> points;
  for (const camera::LightSample& sample : samples)
    if (const auto pixel = optics.project(sample.direction_camera))
      points.push_back({*pixel, sample.photons_per_m2_s * settings.electrons_per_photon_m2() * settings.exposure_s *
                                    optics.vignetting(*pixel)});
  camera::PhotonImage image;
  image.region = settings.region;
  image.electrons.assign(static_cast<std::size_t>(settings.region.width * settings.region.height), 0.0F);
  camera::PointSpread spread(settings.optics);
  spread.add(points, Vector2::Zero(), image);
  return image;
}

}  // namespace vbar::tron::bench::tests
