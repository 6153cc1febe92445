// The body's shadow on itself against a ray tracer.

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/twins/camera/model/light_sums.h"
#include "tests/unit/host_sim/twins/camera/model/ray_tracer.h"
#include "tests/unit/host_sim/twins/camera/model/shapes.h"

namespace vbar::twins::camera {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

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
