// Parts of the laboratory against closed forms: light of a rectangle, beam, room, focus, surfaces.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "emulators/tron/scene/facets.h"
#include "emulators/tron/scene/lab_renderer.h"
#include "tests/support/figures.h"
#include "tests/unit/emulators/tron/scene/lab_scenes.h"

namespace vbar::tron::bench::tests {
namespace {

// Configuration factor of an element that faces a rectangle a x b at distance c below one of its corners (Howell, A
// Catalog of Radiation Configuration Factors, B-3).
double corner_factor(double a, double b, double c) {
  const double x = a / c, y = b / c, p = std::sqrt(1.0 + x * x), q = std::sqrt(1.0 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2.0 * M_PI);
}

TEST(LabLight, ABoxIsARectangleOfEvenRadiance) {
  BoxLight box{Vector3(0, 0, 0), Vector3::UnitY(), Vector3::UnitX(), Vector3::UnitZ(), 0.3, 1.0};
  for (const double distance : {1.0, 1.5, 2.5}) {
    const double expected = M_PI * 4.0 * corner_factor(0.3, 0.3, distance);
    EXPECT_NEAR(irradiance_of(box, Vector3(0, distance, 0), -Vector3::UnitY()) / expected, 1.0,
                0.005 / std::pow(distance, 4.0));  // of four points: with the fourth power of side over distance
    // Beside: below a corner of a rectangle twice as far, less the part that is not there.
    const double beside = M_PI * 2.0 * (corner_factor(0.9, 0.3, distance) - corner_factor(0.3, 0.3, distance));
    EXPECT_NEAR(irradiance_of(box, Vector3(0.6, distance, 0), -Vector3::UnitY()) / beside, 1.0, 2e-3);
  }
  EXPECT_EQ(irradiance_of(box, Vector3(0, -1, 0), Vector3::UnitY()), 0.0);  // behind it
  EXPECT_EQ(irradiance_of(box, Vector3(0, 1, 0), Vector3::UnitY()), 0.0);   // on the far side of the area
}

TEST(LabLight, BeamIsUnevenByATenthAndEndsAtItsWidth) {
  const TestbedDesign bench = tron_bench();
  LabView view = view_of(2.5);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const LampBeam beam = lamp_beam(bench, {}, seed, view, 1.0);
    EXPECT_NEAR(beam.irradiance, 0.1, 0.1 * 4.01 * kFlicker);
    EXPECT_NEAR(beam.irradiance_at(bench.lamp.centre_m), beam.irradiance, 1e-12);
    accuracy::Smallest low;
    accuracy::Largest high;
    for (int k = 0; k < 720; ++k) {
      const double turn = 2.0 * M_PI * (k % 36) / 36.0, radius = 0.53 * (k / 36) / 19.0;
      const Vector3 place = bench.lamp.centre_m + radius * (std::cos(turn) * beam.across + std::sin(turn) * beam.up);
      const Vector3 way = beam.direction - beam.inverse_distance * (place - bench.lamp.centre_m);
      const double relative = beam.irradiance_at(place) / beam.irradiance * way.squaredNorm();
      low.add(relative);
      high.add(relative);
    }
    EXPECT_GE(low, 1.0 - kBeamUnevenness - 1e-9);
    EXPECT_LE(high, 1.0 + kBeamUnevenness + 1e-9);
    EXPECT_GT(high - low, 0.05);
    EXPECT_EQ(beam.irradiance_at(bench.lamp.centre_m + 0.6 * beam.across), 0.0);
    // Rays at the edge diverge by 2 deg.
    const Vector3 edge = bench.lamp.centre_m + 0.55 * beam.up;
    EXPECT_NEAR(std::acos(beam.direction_at(edge).dot(beam.direction)), 2.0 * M_PI / 180.0, 1e-6);
  }
}

TEST(LabLight, FlickerIsOnePercentAndOfTheFrame) {
  LabView view = view_of(2.5);
  double sum = 0.0, squares = 0.0;
  constexpr int kFrames = 2000;
  for (view.frame = 0; view.frame < kFrames; ++view.frame) {
    const double light = lamp_beam(tron_bench(), {}, 3, view, 10.0).irradiance;
    sum += light;
    squares += (light - 1.0) * (light - 1.0);
  }
  EXPECT_NEAR(sum / kFrames, 1.0, 1e-3);                      // 4 sigma of a mean
  EXPECT_NEAR(std::sqrt(squares / kFrames), kFlicker, 7e-4);  // likewise
}

TEST(LabRoom, OneOrTwoPercentOfTheLampComeBack) {
  const TestbedDesign bench = tron_bench();
  const LabView view = view_of(2.5);
  const auto boxes = box_lights(bench, {}, 1.0);
  for (const double azimuth : {45.0, 90.0, 135.0}) {
    LabView lit = view;
    lit.lamp.azimuth_rad = azimuth * M_PI / 180.0;
    const LampBeam beam = lamp_beam(bench, {}, 1, lit, 1.0);
    const std::array<double, 6> back = Room(bench).reflected(beam, boxes, Vector3(6.5, 0.0, 1.4));
    const double mean = std::accumulate(back.begin(), back.end(), 0.0) / 6.0 / beam.irradiance;
    EXPECT_GT(mean, 0.01);
    EXPECT_LT(mean, 0.02);
  }
}

// A thin lens of 17 mm at f/4 focused at 3.5 m, pixels of 5.86 um: the figures of the design.
TEST(LabFocus, DefocusOfTheDesign) {
  const camera::CameraSettings settings = tron_camera();
  EXPECT_NEAR(defocus_diameter_px(settings, 2.5), 1.4, 0.05);
  EXPECT_NEAR(defocus_diameter_px(settings, 5.0), 1.1, 0.05);
  EXPECT_EQ(defocus_diameter_px(settings, 3.5), 0.0);
}

TEST(LabFocus, BlurOfAPoint) {
  for (const double defocus : {0.0, 1.4, 2.5}) {
    Plane plane{81, 81, std::vector<float>(81 * 81)};
    plane.values[40 * 81 + 40] = 1.0F;
    camera::OpticsSettings optics = tron_camera().optics;
    LensBlur lens;
    optics.halo_fraction = 0.0;
    lens.blur(optics, defocus, plane);
    double sum = 0.0, mean = 0.0, square = 0.0;
    for (int y = 0; y < 81; ++y)
      for (int x = 0; x < 81; ++x) {
        const auto light = static_cast<double>(plane.values[static_cast<std::size_t>(y * 81 + x)]);
        sum += light;
        mean += light * x;
        square += light * (x - 40) * (x - 40);
      }
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_NEAR(mean, 40.0, 1e-4);
    EXPECT_NEAR(square, 0.36 + defocus * defocus / 16.0, 1e-4);  // variances add
  }
}

TEST(LabFocus, HaloKeepsLightAndWidth) {
  Plane plane{161, 161, std::vector<float>(161 * 161)};
  // A square of 8 px, in which the halo's cells begin at every phase.
  for (int y = 77; y < 85; ++y)
    for (int x = 77; x < 85; ++x) plane.values[static_cast<std::size_t>(y * 161 + x)] = 1.0F / 64.0F;
  camera::OpticsSettings optics = tron_camera().optics;
  optics.halo_fraction = 1.0;
  LensBlur lens;
  lens.blur(optics, 0.0, plane);
  double sum = 0.0, square = 0.0;
  for (int y = 0; y < 161; ++y)
    for (int x = 0; x < 161; ++x) {
      const auto light = static_cast<double>(plane.values[static_cast<std::size_t>(y * 161 + x)]);
      sum += light;
      square += light * (x - 80.5) * (x - 80.5);
    }
  EXPECT_NEAR(sum, 1.0, 1e-3);
  EXPECT_NEAR(square, 16.0 + 63.0 / 12.0, 0.5);
}

TEST(LabSurfaces, NoiseHasUnitVarianceAndIsTheSameEverywhere) {
  double sum = 0.0, squares = 0.0;
  constexpr int kPlaces = 40000;
  for (int k = 0; k < kPlaces; ++k) {
    const double value = smooth_noise(Vector3(0.0137 * k, 0.0071 * (k % 911), -0.0093 * (k % 307)), 0.02, 5);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kPlaces, 0.0, 0.03);
  EXPECT_NEAR(squares / kPlaces, 1.0, 0.05);
  EXPECT_NE(hashed(1, 2, 3, 4), hashed(3, 2, 1, 4));
  EXPECT_NE(hashed(1, 2, 3, 4), hashed(1, 2, 3, 5));
}

TEST(LabSurfaces, CornersOfTheMockUpAreHalfAMillimetreOff) {
  const camera::CadModel model = camera::load_cad_model(vbar::tests::source_path("data/models/tango_mockup.obj"));
  const std::vector<Facet> designed = scaled_facets(model, 0.5);
  double squares = 0.0, count = 0.0;
  accuracy::Largest largest;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    std::vector<Facet> made = designed;
    move_corners(made, seed);
    for (std::size_t f = 0; f < made.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const double off = (made[f].corners[k] - designed[f].corners[k]).norm();
        squares += off * off;
        count += 1.0;
        largest.add(off);
      }
  }
  EXPECT_NEAR(std::sqrt(squares / count), kCornerErrorM, 0.1e-3);
  EXPECT_LT(largest, 4.0 * kCornerErrorM);
}

TEST(LabSurfaces, SubdivisionKeepsAreaAndOpensNoGaps) {
  const camera::CadModel model = camera::load_cad_model(vbar::tests::source_path("data/models/tango_mockup.obj"));
  const std::vector<Facet> coarse = scaled_facets(model, 0.5), fine = subdivided(coarse, 0.02);
  const auto area = [](const std::vector<Facet>& facets) {
    double sum = 0.0;
    for (const Facet& f : facets) sum += 0.5 * (f.corners[1] - f.corners[0]).cross(f.corners[2] - f.corners[0]).norm();
    return sum;
  };
  EXPECT_NEAR(area(fine), area(coarse), 1e-9);
  for (const Facet& f : fine)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LE((f.corners[k] - f.corners[(k + 1) % 3]).norm(), 0.02 + 1e-12);
}

TEST(LabSurfaces, MockUpDiffersFromTheFlightModelsMaterials) {
  const camera::CadModel flight = camera::load_cad_model(vbar::tests::source_path("data/models/tango.obj"));
  const camera::CadModel mock_up = camera::load_cad_model(vbar::tests::source_path("data/models/tango_mockup.obj"));
  std::set<std::string> found;
  for (const camera::Material& made : mock_up.materials)
    for (const camera::Material& designed : flight.materials) {
      if (made.name != designed.name) continue;
      found.insert(made.name);
      EXPECT_LE(made.grey_diffuse() / designed.grey_diffuse(), 1.61);
      EXPECT_GE(made.grey_diffuse() / designed.grey_diffuse(), 0.59);
      EXPECT_LE(made.grey_specular() / designed.grey_specular(), 1.61);
    }
  EXPECT_EQ(found.size(), flight.materials.size());
  EXPECT_EQ(mock_up.materials.size(), flight.materials.size() + 2);
}

TEST(LabMounts, RodEndsAtTheFaceAndTheCamerasHousingIsNotInItsView) {
  const TestbedDesign bench = tron_bench();
  LabView view = view_of(2.5);
  view.arms = {{view.T_L_C.translation() - Vector3(0.2, 0, 0), view.T_L_C.translation(), 0.05},
               {Vector3(6.0, 0.0, 0.5), Vector3(6.5, 0.0, 0.5), 0.08}};
  const std::vector<Limb> limbs = limbs_in_view(bench, view);
  ASSERT_EQ(limbs.size(), 3U);
  // Held by its bottom, upright: the rod comes from below and ends within 5 cm of the bottom plane.
  EXPECT_NEAR(limbs[1].to_m.z(), 1.4, 0.05);
  EXPECT_NEAR(limbs[1].from_m.z(), 1.4 - bench.target.stand_off_m, 1e-9);
}

}  // namespace
}  // namespace vbar::tron::bench::tests
