// Where the body's points appear: its antenna tips against their projection, and not against a mirrored one.

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/twins/camera/model/ray_tracer.h"
#include "tests/unit/host_sim/twins/camera/model/shapes.h"

namespace vbar::twins::camera {

namespace {

using fsw::Matrix3;
using fsw::Vector3;

// Keypoints 8, 9 and 10 of the SPEED and SPEED+ data sets, body frame, m.
const std::array kTips{Vector3(-0.5427, 0.4877, 0.2535), Vector3(0.5427, 0.4877, 0.2591),
                       Vector3(0.3050, -0.5790, 0.2515)};

double flux_near(const std::vector<LightSample>& samples, const Vector3& direction, double angle) {
  double flux = 0.0;
  for (const LightSample& s : samples)
    if (s.direction_camera.cross(direction).norm() < angle) flux += s.photons_per_m2_s;
  return flux;
}

// True if neither the ray from the camera nor eight about it, 12 mm off, meet the body.
bool free_around(const CadModel& model, const Spheres& spheres, const Vector3& camera, const Vector3& ray) {
  const Vector3 direction = ray.normalized(), across = direction.unitOrthogonal();
  for (int i = 0; i < 9; ++i) {
    const Vector3 off = Eigen::AngleAxisd(i * M_PI / 4.0, direction) * across;
    const Vector3 near = i == 8 ? ray : Vector3(ray + 0.012 * off);
    if (nearest_hit(model, spheres, camera, near.normalized()).triangle != nullptr) return false;
  }
  return true;
}

TEST(TargetGeometry, AntennaTipsAppearWhereTheyProject) {
  const CadModel model = load_cad_model(vbar::tests::source_path("data/models/tango.obj"));
  const Spheres spheres(model);
  TargetRenderer renderer(model);
  std::vector<LightSample> samples;
  int seen = 0, empty = 0;
  for (int k = 0; k < 12; ++k) {
    // Off the boresight, any attitude; light from behind the camera all over the sky, so that nothing is dark.
    const double range = k % 2 == 0 ? 6.0 : 80.0;
    TargetView view;
    view.position_camera = range * Vector3(0.1 * std::cos(k), 0.15 * std::sin(2.0 * k), 1.0).normalized();
    view.R_camera_body = (Eigen::AngleAxisd(0.7 * k, Vector3::UnitX()) * Eigen::AngleAxisd(1.3 * k, Vector3::UnitY()) *
                          Eigen::AngleAxisd(0.4 + k, Vector3::UnitZ()))
                             .toRotationMatrix();
    view.nadir_camera = -view.position_camera.normalized();
    view.earth_half_angle = 1.5;
    view.earth_photons_per_m2_s = 1e20;
    const double texel_m = 0.004;  // across the line of sight
    view.texel_pitch = texel_m / range;
    renderer.render(view, samples);
    const Vector3 camera_body = -view.R_camera_body.transpose() * view.position_camera;
    for (const Vector3& tip : kTips) {
      const Vector3 to_tip = tip - camera_body;
      const Hit hit = nearest_hit(model, spheres, camera_body, to_tip.normalized());
      const bool hidden = hit.distance < to_tip.norm() - 0.03;
      const Vector3 direction = (view.R_camera_body * to_tip).normalized();
      if (!hidden) {
        // The tip is a disc of 5 mm radius about the keypoint; at least a quarter of it is within 6 mm in any view.
        EXPECT_GT(flux_near(samples, direction, 0.006 / range), 0.0) << "view " << k;
        ++seen;
      }
      // Half a decimetre beyond the tip there is nothing, unless another part of the body is behind.
      const Vector3 beyond = tip + 0.05 * (tip - model.centre).normalized() - camera_body;
      if (free_around(model, spheres, camera_body, beyond)) {
        EXPECT_EQ(flux_near(samples, (view.R_camera_body * beyond).normalized(), 0.006 / range), 0.0) << "view " << k;
        ++empty;
      }
    }
  }
  EXPECT_GT(seen, 20);
  EXPECT_GT(empty, 20);
}

TEST(TargetGeometry, IsNotMirrored) {
  // From above, the body's y to the right and x down in the picture: tip 10 is at the left, below the middle.
  TargetRenderer renderer(load_cad_model(vbar::tests::source_path("data/models/tango.obj")));
  TargetView view;
  view.R_camera_body << 0, 1, 0,  //
      1, 0, 0,                    //
      0, 0, -1;
  view.position_camera = Vector3(0.0, 0.0, 10.0);
  view.nadir_camera = -Vector3::UnitZ();
  view.earth_photons_per_m2_s = 1e20;
  view.texel_pitch = 0.004 / 10.0;
  std::vector<LightSample> samples;
  renderer.render(view, samples);
  const auto light_at = [&samples](double right_m, double down_m) {
    return flux_near(samples, Vector3(right_m, down_m, 9.75).normalized(), 0.0006);
  };
  EXPECT_GT(light_at(-0.575, 0.305), 0.0);
  EXPECT_EQ(light_at(-0.575, -0.305), 0.0);
  EXPECT_EQ(light_at(0.575, 0.305), 0.0);
  EXPECT_EQ(light_at(0.575, -0.305), 0.0);
}

// Two cameras draw in turn, with as many texels as their lenses resolve: what a picture's buffers held before, and that
// they are given up when there are too many sizes, has no effect.
TEST(TargetGeometry, PicturesOfDifferentSizesInTurnDoNotAffectEachOther) {
  const CadModel model = load_cad_model(vbar::tests::source_path("data/models/tango.obj"));
  const auto draw = [](TargetRenderer& renderer, double texel_m) {
    TargetView view;
    view.position_camera = Vector3(0.3, -0.2, 9.0);
    view.R_camera_body = Eigen::AngleAxisd(0.7, Vector3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
    view.sun_camera = Vector3(0.5, 0.3, -1.0);
    view.sun_photons_per_m2_s = 1e20;
    view.sunlit = 1.0;
    view.texel_pitch = texel_m / 9.0;
    std::vector<LightSample> samples;
    renderer.render(view, samples);
    return samples;
  };
  TargetRenderer one_after_the_other(model);
  for (const double texel_m : {0.02, 0.004, 0.01, 0.006, 0.04, 0.004, 0.02, 0.02}) {
    TargetRenderer alone(model);
    const std::vector<LightSample> expected = draw(alone, texel_m), drawn = draw(one_after_the_other, texel_m);
    ASSERT_GT(expected.size(), 100U);
    ASSERT_EQ(drawn.size(), expected.size()) << texel_m;
    for (std::size_t k = 0; k < drawn.size(); ++k)
      ASSERT_EQ(drawn[k].photons_per_m2_s, expected[k].photons_per_m2_s) << texel_m << ", sample " << k;
  }
}

}  // namespace

// The body's shadow on itself against a ray tracer.

namespace {

Matrix3 turned(double about_x, double about_y, double about_z) {
  return (Eigen::AngleAxisd(about_x, Vector3::UnitX()) * Eigen::AngleAxisd(about_y, Vector3::UnitY()) *
          Eigen::AngleAxisd(about_z, Vector3::UnitZ()))
      .toRotationMatrix();
}

// Two plates that make an L, the upright one shading the other, and wider.
CadModel l_shape() {
  std::vector<Triangle> triangles;
  shapes::add_plate(triangles, Vector3(0.0, 0.0, 0.0), Vector3(0.8, 0.0, 0.0), Vector3(0.0, 0.6, 0.0));
  shapes::add_plate(triangles, Vector3(0.0, -0.1, 0.0), Vector3(0.0, 0.8, 0.0), Vector3(0.0, 0.0, 0.5));
  return shapes::model_of(triangles, shapes::lambert(0.5));
}

TEST(TargetShadow, OfAnUprightPlateIsAsLongAsItsHeightOverTheSunsTangent) {
  // Camera straight above the middle, Sun 45 degrees high behind the plate: 0.5 m of 0.8 m of the ground are dark.
  TargetRenderer renderer(l_shape());
  TargetView view;
  const double range = 2.0e3;
  view.R_camera_body = turned(M_PI, 0.0, 0.0);
  const Vector3 under_camera(0.4, 0.3, 0.0);
  view.position_camera = Vector3(0.0, 0.0, range) - view.R_camera_body * under_camera;
  view.sun_camera = view.R_camera_body * Vector3(-1.0, 0.0, 1.0).normalized();
  view.sun_photons_per_m2_s = kSunPhotons;
  std::vector<LightSample> samples;
  for (const double pitch_m : {0.0, 0.005}) {  // in the coarsest picture and in one of 5 mm
    view.texel_pitch = pitch_m / range;
    renderer.render(view, samples);
    const double expected = kSunPhotons * std::sqrt(0.5) * 0.5 / M_PI * 0.3 * 0.6 / (range * range);
    EXPECT_NEAR(sum_of(samples).flux / expected, 1.0, 0.02) << renderer.texels();
    EXPECT_NEAR(sum_of(samples).direction.x() * range, 0.65 - 0.4, 0.005) << renderer.texels();
  }
}

TEST(TargetShadow, OfTwoPlatesIsTheRayTracers) {
  const CadModel model = l_shape();
  TargetRenderer renderer(model);
  std::vector<LightSample> samples;
  accuracy::Largest shaded;
  for (const double turn : {0.0, 0.6, 1.2}) {
    TargetView view = view_at(300.0, 0.9);
    view.R_camera_body = turned(M_PI - 0.4, -0.3 - turn, 0.4);
    const TracedLight traced = trace(model, view, 100000);
    shaded.add(1.0 - traced.flux / traced.flux_without_shadows);
    renderer.render(view, samples);
    EXPECT_NEAR(sum_of(samples).flux / traced.flux, 1.0, 0.015) << "turn " << turn;
    EXPECT_LT((sum_of(samples).direction - traced.direction).norm() * 300.0, 0.005) << "turn " << turn;
  }
  EXPECT_GT(shaded, 0.2) << "or nothing is tested";
}

TEST(TargetShadow, OfMattTangoIsTheRayTracers) {
  CadModel model = load_cad_model(vbar::tests::source_path("data/models/tango.obj"));
  for (Material& m : model.materials) m = shapes::lambert(0.4);
  for (Triangle& t : model.triangles) t.normals = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  model = make_cad_model("flat, matt tango", model.triangles, model.materials);
  TargetRenderer renderer(model);
  std::vector<LightSample> samples;
  accuracy::Largest shaded;
  for (const double turn : {0.4, 2.2, 4.0}) {
    TargetView view = view_at(30.0, 1.0);
    view.R_camera_body = turned(turn, 0.5 * turn, 0.7);
    view.texel_pitch = 0.01 / 30.0;
    const TracedLight traced = trace(model, view, 10000);
    shaded.add(1.0 - traced.flux / traced.flux_without_shadows);
    renderer.render(view, samples);
    // 10,000 rays leave the reference itself half a per cent and 2 mm uncertain.
    EXPECT_NEAR(sum_of(samples).flux / traced.flux, 1.0, 0.015) << "turn " << turn;
    EXPECT_LT((sum_of(samples).direction - traced.direction).norm() * 30.0, 0.004) << "turn " << turn;
  }
  EXPECT_GT(shaded, 0.03) << "or nothing is tested";
}

}  // namespace

}  // namespace vbar::twins::camera
