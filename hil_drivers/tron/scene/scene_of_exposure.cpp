#include "hil_drivers/tron/scene/scene_of_exposure.h"

#include <algorithm>

#include "host_sim/twins/camera/earth_disc.h"

namespace vbar::tron {

using fsw::Matrix3;
using fsw::Vector3;

std::optional<Scene> scene_of(const twins::camera::Exposure& exposure, const std::string& model, double scale) {
  const auto object = std::ranges::find(exposure.objects, model, &twins::camera::ObjectInView::model);
  if (object == exposure.objects.end()) return std::nullopt;
  const Matrix3 R_camera_eci = exposure.q_camera_eci.normalized().toRotationMatrix();
  Scene scene;
  scene.T_C_T.linear() = R_camera_eci * object->q_body_eci.normalized().toRotationMatrix().transpose();
  scene.T_C_T.translation() = scale * (R_camera_eci * object->position_eci);
  scene.sun_C = (R_camera_eci * (exposure.sun_eci - exposure.camera_position_eci)).normalized();
  const twins::camera::EarthDisc earth(exposure.camera_position_eci, exposure.sun_eci);
  const Vector3 light_C = R_camera_eci * earth.light_eci(1.0);
  scene.earth_to_sun = light_C.norm();
  if (scene.earth_to_sun > 0.0) scene.earth_C = light_C.normalized();
  scene.earth_half_angle = earth.angular_radius();
  scene.sunlit = object->sunlit;
  return scene;
}

}  // namespace vbar::tron
