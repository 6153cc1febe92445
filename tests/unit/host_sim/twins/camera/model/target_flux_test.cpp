// Light of plates and spheres against formulas, of Tango against itself: the inverse square, finer pictures,
// repetition.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/twins/camera/model/distant_body.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/twins/camera/model/ray_tracer.h"
#include "tests/unit/host_sim/twins/camera/model/shapes.h"

namespace vbar::twins::camera {

namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kPi = std::numbers::pi;

CadModel tango() {
  return load_cad_model(vbar::tests::source_path("data/models/tango.obj"));
}

CadModel sphere(double radius, double albedo) {
  std::vector<Triangle> triangles;
  shapes::add_sphere(triangles, Vector3::Zero(), radius, 48);
  return shapes::model_of(triangles, shapes::lambert(albedo));
}

// 0.8 m by 0.5 m, facing +z of the body.
CadModel plate(const Material& material) {
  std::vector<Triangle> triangles;
  shapes::add_plate(triangles, Vector3(-0.4, -0.25, 0.0), Vector3(0.8, 0.0, 0.0), Vector3(0.0, 0.5, 0.0));
  return shapes::model_of(triangles, material);
}
constexpr double kPlateArea = 0.4;

// A turn that puts every edge at an angle to the rows of the picture.
Matrix3 turned(double about_x, double about_y, double about_z) {
  return (Eigen::AngleAxisd(about_x, Vector3::UnitX()) * Eigen::AngleAxisd(about_y, Vector3::UnitY()) *
          Eigen::AngleAxisd(about_z, Vector3::UnitZ()))
      .toRotationMatrix();
}

Light light_of(TargetRenderer& renderer, const TargetView& view) {
  std::vector<LightSample> samples;
  renderer.render(view, samples);
  return sum_of(samples);
}

TEST(TargetFlux, OfALambertSphereIsTheHandFormulas) {
  // Flux = E albedo (R/d)^2 2/(3 pi) ((pi - a) cos a + sin a) at phase angle a. Its centroid lies
  // R (3 pi/16) sin a (1 + cos a) / ((pi - a) cos a + sin a) from the middle towards the Sun: both are integrals of
  // mu mu0 over the part that is lit and seen, with longitude and latitude from the scattering plane. At half phase
  // the latter is the known 3 pi/16.
  const double radius = 0.35, albedo = 0.3;
  TargetRenderer renderer(sphere(radius, albedo));
  for (const double range : {200.0, 5.0e3, 75.0e3})
    for (const double phase : {0.0, 0.5 * kPi, 0.75 * kPi}) {
      const Light light = light_of(renderer, view_at(range, phase));
      const double lune = (kPi - phase) * std::cos(phase) + std::sin(phase);
      const double expected = kSunPhotons * albedo * std::pow(radius / range, 2) * 2.0 / (3.0 * kPi) * lune;
      EXPECT_NEAR(light.flux / expected, 1.0, 0.01) << range << " m, phase " << phase;
      const double offset = radius * 3.0 * kPi / 16.0 * std::sin(phase) * (1.0 + std::cos(phase)) / lune;
      EXPECT_NEAR(light.direction.x() * range, offset, 0.005 * radius) << range << " m, phase " << phase;
      EXPECT_NEAR(light.direction.y() * range, 0.0, 0.002 * radius) << range << " m, phase " << phase;
    }
}

TEST(TargetFlux, OfALambertPlateIsTheHandFormulas) {
  // E cos(incidence) albedo/pi times area cos(emission)/d^2.
  const double albedo = 0.6;
  TargetRenderer renderer(plate(shapes::lambert(albedo)));
  for (const double range : {50.0, 3.0e3, 75.0e3})
    for (const double phase : {0.0, 0.6, 1.2}) {
      TargetView view = view_at(range, phase);
      view.R_camera_body = turned(kPi - 0.3, 0.4, 0.5);  // its front to the camera
      const Vector3 normal = view.R_camera_body.col(2);
      const double incidence = normal.dot(view.sun_camera), emission = -normal.z();
      ASSERT_GT(incidence, 0.1);
      ASSERT_GT(emission, 0.1);
      const double expected = kSunPhotons * incidence * albedo / kPi * kPlateArea * emission / (range * range);
      EXPECT_NEAR(light_of(renderer, view).flux / expected, 1.0, 0.02) << range << " m, phase " << phase;
    }
}

TEST(TargetFlux, OfASheetWithTwoCoincidentFacesIsThatOfOne) {
  // CAD programs write a thin sheet as one face to each side.
  CadModel one = plate(shapes::lambert(0.6));
  std::vector<Triangle> both = one.triangles;
  for (Triangle t : one.triangles) {
    std::swap(t.corners[0], t.corners[1]);
    for (Vector3& normal : t.normals) normal = -normal;
    both.push_back(t);
  }
  TargetRenderer single(one), twofold(shapes::model_of(both, shapes::lambert(0.6)));
  TargetView view = view_at(3.0e3, 0.6);
  view.R_camera_body = turned(kPi - 0.3, 0.4, 0.5);
  EXPECT_NEAR(light_of(twofold, view).flux / light_of(single, view).flux, 1.0, 1e-3);
}

TEST(TargetFlux, IsNoneFromThePlatesUnlitSideAndIsProportionalToTheSun) {
  TargetRenderer renderer(plate(shapes::lambert(0.5)));
  TargetView view = view_at(1.0e3, 0.0);
  view.R_camera_body = turned(0.3, 0.2, 0.1);
  const double full = light_of(renderer, view).flux;
  EXPECT_GT(full, 0.0) << "a sheet is seen from its back, too";
  view.sunlit = 0.25;
  EXPECT_NEAR(light_of(renderer, view).flux, 0.25 * full, 1e-6 * full);
  view.sunlit = 0.0;
  EXPECT_EQ(light_of(renderer, view).flux, 0.0);
  view.sunlit = 1.0;
  view.sun_camera = Vector3(0.1, 0.0, 1.0).normalized();
  EXPECT_EQ(light_of(renderer, view).flux, 0.0);
}

TEST(TargetFlux, OfTheEarthsLightIsTheIntegralOverItsDisc) {
  // Irradiance of a tilted plate: cos(incidence), where positive, summed over the disc.
  const double half_angle = 1.1, albedo = 0.5, earth = 2.0e20, range = 500.0;
  TargetRenderer renderer(plate(shapes::lambert(albedo)));
  for (const double tilt : {0.0, 0.4, 1.0, 1.4, 1.9, 2.5}) {
    TargetView view;
    view.position_camera = Vector3(0.0, 0.0, range);
    view.R_camera_body = turned(kPi, 0.0, 0.4);
    view.earth_photons_per_m2_s = earth;
    view.earth_half_angle = half_angle;
    view.nadir_camera = Vector3(std::sin(tilt), 0.0, -std::cos(tilt));
    double sum = 0.0, facing = 0.0;
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double off = half_angle * (i + 0.5) / kSteps, around = 2.0 * kPi * (j + 0.5) / kSteps;
        const double cosine = std::cos(tilt) * std::cos(off) + std::sin(tilt) * std::sin(off) * std::cos(around);
        sum += std::sin(off) * std::max(0.0, cosine);
        facing += std::sin(off) * std::cos(off);
      }
    const double expected = earth * sum / facing * albedo / kPi * kPlateArea / (range * range);
    const double whole = earth * albedo / kPi * kPlateArea / (range * range);
    EXPECT_NEAR(light_of(renderer, view).flux, expected, 0.01 * whole) << "tilt " << tilt;
  }
}

TEST(TargetFlux, FallsWithTheSquareOfTheRange) {
  TargetRenderer renderer(tango());
  TargetView view = view_at(1.0e3, 1.0);
  view.R_camera_body = turned(1.0, 0.4, 0.3);
  view.texel_pitch = 0.5 / 5972.7;
  const double near = light_of(renderer, view).flux * 1e6;
  for (const double range : {3.0e3, 10.0e3, 30.0e3, 75.0e3}) {
    view.position_camera.z() = range;
    EXPECT_NEAR(light_of(renderer, view).flux * range * range / near, 1.0, 0.005) << range;
  }
}

TEST(TargetFlux, AndCentroidStayWithFinerPictures) {
  // The coarsest one is of a distant body: no picture, but pieces of the surface. Its centroid is compared below.
  TargetRenderer renderer(tango());
  const double range = 500.0;
  for (const double turn : {0.3, 1.7, 2.9, 4.4}) {
    TargetView view = view_at(range, 0.8);
    view.R_camera_body = turned(0.9 + turn, 0.4 * turn, turn);
    const Light coarse = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), DistantBody::kTexels);
    view.texel_pitch = 2.0 * 0.75 / range / 250.0;
    const Light middle = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 256);
    view.texel_pitch *= 0.5;  // one sample a texel from here on: no more of them than in the middle picture
    const Light single = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 512);
    view.texel_pitch *= 0.5;
    const Light fine = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 1024);
    EXPECT_NEAR(coarse.flux / fine.flux, 1.0, 0.01) << turn;
    EXPECT_NEAR(middle.flux / fine.flux, 1.0, 0.005) << turn;
    EXPECT_NEAR(single.flux / fine.flux, 1.0, 0.005) << turn;
    EXPECT_LT((middle.direction - fine.direction).norm() * range, 0.001) << turn;
    EXPECT_LT((single.direction - fine.direction).norm() * range, 0.001) << turn;
  }
}

/// Attitudes over all rotations and phases up to 120 deg, evenly by the additive recurrence of Roberts (2018).
TargetView view_number(int k, double range) {
  const auto part = [k](double step) { return std::fmod(0.5 + step * k, 1.0); };
  TargetView view = view_at(range, 2.0 * kPi / 3.0 * part(0.8566749));
  const double u = part(0.7338919), v = 2.0 * kPi * part(0.6287067), w = 2.0 * kPi * part(0.5385973);
  view.R_camera_body = Eigen::Quaterniond(std::sqrt(u) * std::cos(w), std::sqrt(1.0 - u) * std::sin(v),
                                          std::sqrt(1.0 - u) * std::cos(v), std::sqrt(u) * std::sin(w))
                           .toRotationMatrix();
  view.earth_photons_per_m2_s = 0.1 * kSunPhotons;
  view.nadir_camera = Vector3(0.2, 1.0, 0.1).normalized();
  return view;
}

TEST(TargetFlux, OfADistantBodyIsThatOfAFinePictureOfAnotherRenderer) {
  // 768 texels a side by OpenGL with a shadow map of 1152, which is within 0.14 % rms of 2048 texels. With the least
  // that OpenGL draws, 128 texels of four samples each, the light differs by 0.77 % rms, at most 4.2 %, its centroid by
  // 1.9 mm rms, at most 7 mm.
  TargetRenderer renderer(tango());
  const double range = 30.0e3;
  double square = 0.0, centroid_square = 0.0;
  accuracy::Largest greatest, farthest;
  constexpr int kViews = 200;
  for (int k = 0; k < kViews; ++k) {
    TargetView view = view_number(k, range);
    view.texel_pitch = 0.5 / 5972.7;
    const Light distant = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), DistantBody::kTexels);
    view.texel_pitch = 2.0 * 0.75 / range / 760.0;
    const Light fine = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 768);
    const double error = distant.flux / fine.flux - 1.0;
    square += error * error / kViews;
    greatest.add(std::abs(error));
    const double offset = (distant.direction - fine.direction).norm() * range;
    centroid_square += offset * offset / kViews;
    farthest.add(offset);
  }
  EXPECT_LT(std::sqrt(square), 0.004);
  EXPECT_LT(greatest, 0.025);
  EXPECT_LT(std::sqrt(centroid_square), 0.001) << "m; a pixel is 5 m";
  EXPECT_LT(farthest, 0.006);
}

TEST(TargetFlux, IsTheSameBitsAgainAndInAnotherThread) {
  TargetRenderer renderer(tango());
  TargetView view = view_at(120.0, 1.1);
  view.R_camera_body = turned(0.2, 1.0, 2.0);
  view.texel_pitch = 0.5 / 5972.7;
  std::vector<LightSample> first, other, again;
  renderer.render(view, first);
  ASSERT_GT(first.size(), 1000U);
  std::thread([&] {
    TargetView far = view;
    far.position_camera.z() = 75.0e3;
    renderer.render(far, other);
    renderer.render(view, again);
  }).join();
  TargetRenderer second(tango());
  second.render(view, other);
  const auto same = [&first](const std::vector<LightSample>& samples) {
    if (samples.size() != first.size()) return false;
    for (std::size_t i = 0; i < first.size(); ++i)
      if (samples[i].direction_camera != first[i].direction_camera ||
          samples[i].photons_per_m2_s != first[i].photons_per_m2_s)
        return false;
    return true;
  };
  EXPECT_TRUE(same(again)) << "after another view, in a worker thread";
  EXPECT_TRUE(same(other)) << "by another renderer, while the first one lives";
}

TEST(TargetFlux, FollowsOtherMaterials) {
  CadModel model = sphere(0.35, 0.2);
  TargetRenderer renderer(model);
  const TargetView view = view_at(1.0e3, 1.0);
  const double dark = light_of(renderer, view).flux;
  renderer.set_materials(std::array{shapes::lambert(0.6)});
  EXPECT_NEAR(light_of(renderer, view).flux / dark, 3.0, 1e-5);
  EXPECT_THROW(renderer.set_materials(std::array{shapes::lambert(0.6), shapes::lambert(0.1)}), std::runtime_error);
  EXPECT_THROW(renderer.set_materials(std::array{shapes::lambert(1.2)}), std::runtime_error);
  EXPECT_NEAR(light_of(renderer, view).flux / dark, 3.0, 1e-5) << "bad materials change nothing";
}

TEST(TargetView, InsideTheBodyOrWithoutNumbersIsRefused) {
  TargetRenderer renderer(sphere(0.35, 0.2));
  std::vector<LightSample> samples;
  EXPECT_THROW(renderer.render(view_at(0.3, 1.0), samples), std::invalid_argument);
  EXPECT_NO_THROW(renderer.render(view_at(0.4, 1.0), samples));
  TargetView view = view_at(10.0, 1.0);
  view.R_camera_body(1, 2) = std::nan("");
  EXPECT_THROW(renderer.render(view, samples), std::invalid_argument);
}

}  // namespace

// No surface sends back more light than falls on it, and a glossy one little less than its reflectivity.

namespace {

Material material(double diffuse, double specular, double exponent) {
  return {"surface", {diffuse, diffuse, diffuse}, {specular, specular, specular}, exponent};
}

// Share of the light from `incidence` (from the normal, towards -x) that a square metre sends into all directions. The
// directions looked from are half even over the cosine and half about the mirrored ray, as its lobe is wide: exp of a
// tangent's square, weighted by the density of both.
double reflected_share(TargetRenderer& renderer, double incidence, double lobe, int count) {
  const Vector3 sun(-std::sin(incidence), 0.0, std::cos(incidence)), mirrored(-sun.x(), 0.0, sun.z());
  const double kappa = 1.0 / (lobe * lobe);  // von Mises and Fisher's distribution on the sphere
  const auto density = [&](const Vector3& v) {
    const double about =
        kappa / (2.0 * kPi * (1.0 - std::exp(-2.0 * kappa))) * std::exp(kappa * (v.dot(mirrored) - 1.0));
    return 0.5 * v.z() / kPi + 0.5 * about;
  };
  const Eigen::Quaterniond to_mirrored = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), mirrored);
  const double range = 500.0;
  std::vector<LightSample> samples;
  double sum = 0.0;
  for (int k = 0; k < count; ++k) {
    const double a = (k / 2 + 0.5) / (count / 2), around = 2.0 * kPi * std::fmod(0.618033988749895 * (k / 2), 1.0);
    const double cosine = k % 2 == 0 ? std::sqrt(a) : 1.0 + std::log(a + (1.0 - a) * std::exp(-2.0 * kappa)) / kappa;
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    Vector3 v(sine * std::cos(around), sine * std::sin(around), cosine);
    if (k % 2 == 1) v = to_mirrored * v;
    if (v.z() <= 0.005) continue;  // nearly along the surface: less than a hundredth of a per cent of any lobe's power
    TargetView view;
    const Eigen::Quaterniond q_camera_body = Eigen::Quaterniond::FromTwoVectors(v, -Vector3::UnitZ());
    view.R_camera_body = q_camera_body.toRotationMatrix();
    view.position_camera = Vector3(0.0, 0.0, range);
    view.sun_camera = q_camera_body * sun;
    view.sun_photons_per_m2_s = 1.0;
    renderer.render(view, samples);
    sum += sum_of(samples).flux * range * range / (std::cos(incidence) * density(v));
  }
  return sum / count;
}

TEST(TargetEnergy, ReflectedIsNoMoreThanReceived) {
  std::vector<Triangle> triangles;
  shapes::add_plate(triangles, Vector3(-0.5, -0.5, 0.0), Vector3::UnitX(), Vector3::UnitY());
  TargetRenderer renderer(shapes::model_of(triangles));
  struct Case {
    double diffuse, specular, exponent;
    std::array<double, 3> expected;  // at the three incidences; 0: only no more than everything
  };
  // A white mirror's are integrals of the lobe over the hemisphere by a rule of 1000 x 2000 midpoints, made elsewhere:
  // what is missing to 1 is light that microfacets keep from each other.
  for (const Case& c :
       {Case{1.0, 0.0, 0.0, {1.0, 1.0, 1.0}}, Case{0.0, 1.0, 300.0, {0.9923, 0.9879, 0.9455}},
        Case{0.0, 1.0, 0.0, {0.3099, 0.3617, 0.4842}}, Case{0.5, 0.5, 40.0, {}}, Case{0.9, 0.1, 10.0, {}}}) {
    renderer.set_materials(std::array{material(c.diffuse, c.specular, c.exponent)});
    const double lobe = std::max(0.15, 2.0 * std::sqrt(2.0 / (c.exponent + 2.0)));
    constexpr std::array kIncidences{0.2, 0.8, 1.3};
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = reflected_share(renderer, kIncidences[k], lobe, 240);
      EXPECT_LT(share, 1.015) << "Kd " << c.diffuse << " Ks " << c.specular << " Ns " << c.exponent;
      EXPECT_GT(share, 0.7 * (c.diffuse + 0.4 * c.specular)) << "Kd " << c.diffuse << " Ks " << c.specular;
      if (c.expected[k] > 0.0) {
        // The lobe is narrow, 240 directions few.
        EXPECT_NEAR(share, c.expected[k], 0.015) << "Kd " << c.diffuse << " Ks " << c.specular << " Ns " << c.exponent;
      }
    }
  }
}

TEST(TargetEnergy, TheGlintIsAtTheMirroredDirection) {
  std::vector<Triangle> triangles;
  shapes::add_plate(triangles, Vector3(-0.5, -0.5, 0.0), Vector3::UnitX(), Vector3::UnitY());
  TargetRenderer renderer(shapes::model_of(triangles, material(0.05, 0.5, 500.0)));
  const double incidence = 0.6;
  double brightest = 0.0, at = 0.0;
  std::vector<LightSample> samples;
  for (int k = -60; k <= 60; ++k) {
    const double emission = 0.02 * k;  // towards +x
    TargetView view;
    const Eigen::Quaterniond q_camera_body =
        Eigen::Quaterniond::FromTwoVectors(Vector3(std::sin(emission), 0.0, std::cos(emission)), -Vector3::UnitZ());
    view.R_camera_body = q_camera_body.toRotationMatrix();
    view.position_camera = Vector3(0.0, 0.0, 500.0);
    view.sun_camera = q_camera_body * Vector3(-std::sin(incidence), 0.0, std::cos(incidence));
    view.sun_photons_per_m2_s = 1.0;
    renderer.render(view, samples);
    if (sum_of(samples).flux > brightest) {
      brightest = sum_of(samples).flux;
      at = emission;
    }
  }
  EXPECT_NEAR(at, incidence, 0.03);
}

}  // namespace

}  // namespace vbar::twins::camera
