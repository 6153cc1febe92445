// Tango from its CAD file in the camera's whole image, near and far.

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/scene.h"
#include "tests/support/camera_scene.h"
#include "tests/support/paths.h"

namespace {

using vbar::fsw::Vector2;
using vbar::fsw::Vector3;
using vbar::test::Blob;
using vbar::test::measure;
namespace camera = vbar::twins::camera;

const Vector2 kMiddle(959.5, 599.5);
constexpr double kFocalPx = 35.0 / 5.86e-3;

camera::CadSources source_of(const std::string& model) {
  return {{model, {.file = vbar::test::camera_data() / "models" / (model + ".obj")}}};
}

camera::SceneRenderer& renderer() {
  static camera::SceneRenderer made(camera::CameraSettings{}, vbar::test::camera_data(),
                                    camera::cad_objects(source_of("tango")));
  return made;
}

camera::Exposure with_tango(const Vector3& position_camera) {
  camera::Exposure exposure = vbar::test::quiet_exposure(Vector3(std::cos(1.4704), std::sin(1.4704), -0.03));
  exposure.rate_camera = Vector3(1.06e-3, 0.0, 0.0);
  exposure.objects.push_back(vbar::test::object_at(exposure, position_camera));
  exposure.objects[0].model = "tango";
  exposure.objects[0].q_body_eci = Eigen::Quaterniond(0.5, 0.1, -0.7, 0.4).normalized();
  return exposure;
}

camera::PhotonImage tango_alone(const Vector3& position_camera) {
  camera::Exposure exposure = with_tango(position_camera);
  camera::PhotonImage with, without;
  renderer().render(exposure, with);
  exposure.objects.clear();
  renderer().render(exposure, without);
  return vbar::test::difference(with, without);
}

// The same face in the same light: light falls with the square of the range, and its centre comes to stand, from range
// to range, where one point of the body is projected. Steps of 10 per cent from 75 km to 100 m.
TEST(SceneModel, tango_grows_from_a_point_to_a_disc_without_a_jump) {
  const Vector3 direction(0.0101, -0.0032, 1.0);
  double flux_before = 0.0;
  Vector2 offset_before = Vector2::Zero();
  for (double range = 75e3; range > 100.0; range *= 0.9) {
    const Vector2 place = kMiddle + kFocalPx * direction.head<2>();
    const Blob blob = measure(tango_alone(range * direction), place, 60.0);
    const double flux = blob.electrons * range * range;
    const Vector2 offset = (blob.centroid - place) * range / kFocalPx;  // m
    if (flux_before > 0.0) {
      EXPECT_NEAR(flux / flux_before, 1.0, 0.01) << range;  // other texels fall on its edges
      const double pixel_m = range / kFocalPx;
      EXPECT_NEAR((offset - offset_before).norm(), 0.0, 0.003 * pixel_m + 0.01) << range;
    }
    flux_before = flux;
    offset_before = offset;
    EXPECT_LT(offset.norm(), 0.4 + 0.003 * range / kFocalPx);  // within the body
  }
}

// The Earth's day side fills the image behind Tango in the dark: light and no light, and of the Earth's as much is
// missing as a plate of the hull's outline hides. Seen along z, the top panel's 0.74 m x 0.77 m is the outline but for
// the antennas and what sticks out, less than a tenth of it.
TEST(SceneModel, the_earth_does_not_shine_through_tango) {
  camera::CameraSettings settings;
  settings.optics.focal_length_mm = 8.5;  // 6 mm a pixel at 8 m and more
  settings.exposure_s = 1e-3;
  camera::SceneRenderer seen(settings, vbar::test::camera_data(), camera::cad_objects(source_of("tango")),
                             camera::cad_covers(source_of("tango")));
  camera::Exposure exposure = vbar::test::quiet_exposure(Vector3(0.0, 1.0, 0.0));
  exposure.camera_position_eci = Vector3(7.0e6, 0.0, 0.0);
  exposure.q_camera_eci = vbar::test::camera_attitude(-Vector3::UnitX(), Vector3::UnitY());
  exposure.sun_eci = vbar::test::kSunDistance * Vector3::UnitX();
  camera::PhotonImage earth, both;
  seen.render(exposure, earth);
  const double range = 8.0, pixel_m = range / settings.focal_length_px();
  exposure.objects.push_back(vbar::test::object_at(exposure, Vector3(0.0, 0.0, range)));
  exposure.objects[0].model = "tango";
  exposure.objects[0].q_body_eci = exposure.q_camera_eci;  // the side that looks away from the Earth
  exposure.objects[0].sunlit = 0.0;
  seen.render(exposure, both);
  double hidden = 0.0;
  for (std::size_t k = 0; k < both.electrons.size(); ++k)
    if (both.electrons[k] < 0.5F * earth.electrons[k]) hidden += pixel_m * pixel_m;
  EXPECT_NEAR(hidden, 0.74 * 0.77, 0.1 * 0.74 * 0.77);
}

TEST(SceneModel, a_model_that_was_not_loaded_is_refused) {
  camera::Exposure exposure = with_tango(Vector3(0.0, 0.0, 1e3));
  exposure.objects[0].model = "mango";
  camera::PhotonImage image;
  EXPECT_THROW(renderer().render(exposure, image), std::invalid_argument);
  EXPECT_THROW((void)camera::cad_objects(source_of("no_such_model")), std::runtime_error);
}

// A picture to look at where VBAR_KEEP_IMAGES is set: build/<preset>/camera_tango_<pid>.png.
TEST(SceneModel, an_example_frame_of_tango_near_and_far) {
  camera::Exposure exposure = with_tango(Vector3(-0.02, 0.035, 1.0) * 60e3);
  const std::array<Vector3, 3> positions{Vector3(0.025, 0.05, 1.0) * 2e3, Vector3(0.015, -0.045, 1.0) * 100.0,
                                         Vector3(-0.02, -0.02, 1.0) * 30.0};
  for (const Vector3& position : positions) {
    exposure.objects.push_back(vbar::test::object_at(exposure, position));
    exposure.objects.back().model = "tango";
    exposure.objects.back().q_body_eci = exposure.objects[0].q_body_eci;
  }
  camera::PhotonImage image;
  renderer().render(exposure, image);
  const std::filesystem::path file =
      std::filesystem::path(vbar::tests::build_path()) / ("camera_tango_" + std::to_string(getpid()) + ".png");
  ASSERT_TRUE(vbar::test::write_picture(image, 1e8, file));
  if (std::getenv("VBAR_KEEP_IMAGES") == nullptr) std::filesystem::remove(file);
  EXPECT_GT(measure(image, kMiddle + kFocalPx * Vector2(-0.02, -0.02), 80.0).electrons,
            5.0 * measure(image, kMiddle + kFocalPx * Vector2(0.015, -0.045), 40.0).electrons);  // 11 times in truth
}

}  // namespace
