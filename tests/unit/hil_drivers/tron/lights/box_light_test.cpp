// Boxes as the Earth: irradiances, powers, misfit.

#include "hil_drivers/tron/lights/box_light.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "hil_drivers/tron/lights/sphere_normals.h"
#include "host_sim/twins/camera/earth_light.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

using fsw::Vector3;

BenchFile bench() {
  return read_bench_file(tests::source_path("data/benches/tron.toml"));
}

TEST(SphereNormals, Are162EvenlySpread) {
  const auto& normals = sphere_normals();
  ASSERT_EQ(normals.size(), 162U);
  Vector3 sum = Vector3::Zero();
  fsw::Matrix3 squares = fsw::Matrix3::Zero();
  accuracy::Smallest closest;
  for (std::size_t k = 0; k < normals.size(); ++k) {
    EXPECT_NEAR(normals[k].norm(), 1.0, 1e-15);
    sum += normals[k];
    squares += normals[k] * normals[k].transpose();
    for (std::size_t j = 0; j < k; ++j) closest.add((normals[k] - normals[j]).norm());
  }
  EXPECT_LT(sum.norm(), 1e-12);  // both are zero and 1/3 by the icosahedron's symmetry
  EXPECT_LT((squares - 54.0 * fsw::Matrix3::Identity()).norm(), 1e-10);
  EXPECT_GT(closest, 0.2);
}

// Integral of the cosine over a cap of the sphere: for an area that faces a disc of half angle a it is pi sin^2 a; here
// by rings and sectors of 1/400.
TEST(EarthLight, IsTheIntegralOverTheDisc) {
  const double half_angle = 1.1, sine = std::sin(half_angle);
  for (const double tilt : {0.0, 0.4, 0.9, 1.3, 1.6, 2.0, 2.5, 3.0}) {
    const Vector3 normal(std::sin(tilt), 0, std::cos(tilt));
    constexpr int kRings = 400, kAround = 800;
    double sum = 0.0;
    for (int ring = 0; ring < kRings; ++ring) {
      const double cosine = 1.0 - (1.0 - std::cos(half_angle)) * (ring + 0.5) / kRings;
      const double radius = std::sqrt(1.0 - cosine * cosine);
      for (int k = 0; k < kAround; ++k) {
        const double turn = 2.0 * std::numbers::pi * (k + 0.5) / kAround;
        sum += std::max(0.0, normal.dot(Vector3(radius * std::cos(turn), radius * std::sin(turn), cosine)));
      }
    }
    const double solid_angle = 2.0 * std::numbers::pi * (1.0 - std::cos(half_angle)) / (kRings * kAround);
    const double expected = sum * solid_angle / (std::numbers::pi * sine * sine);
    EXPECT_NEAR(twins::camera::earth_light_factor(std::cos(tilt), sine), expected, 1e-4) << tilt;
  }
}

TEST(BoxLight, ReachesTheTargetFromTheSideOfTheBoxes) {
  const BoxLight light(bench());
  const auto irradiances = light.irradiances(Vector3(6.5, 0, 1.4));
  ASSERT_EQ(irradiances.rows(), 162);
  ASSERT_EQ(irradiances.cols(), 10);
  EXPECT_TRUE((irradiances.array() >= 0.0).all());
  const auto& normals = sphere_normals();
  for (Eigen::Index box = 0; box < 10; ++box) {
    Eigen::Index brightest = 0;
    for (Eigen::Index k = 1; k < irradiances.rows(); ++k)
      if (irradiances(k, box) > irradiances(brightest, box)) brightest = k;
    const Vector3 way = bench().boxes.boxes[static_cast<std::size_t>(box)].centre_m - Vector3(6.5, 0, 1.4);
    EXPECT_GT(normals[static_cast<std::size_t>(brightest)].dot(way.normalized()), 0.9);
    // A small source far off: exitance x area x cosine at the box / (pi distance^2); the sphere's point is 0.15 m
    // nearer, the box 0.6 m wide.
    const double cosine = -bench().boxes.boxes[static_cast<std::size_t>(box)].normal.dot(way.normalized());
    const double expected = 2.5 * 0.36 * cosine / (std::numbers::pi * way.squaredNorm());
    EXPECT_NEAR(irradiances(brightest, box) / expected, 1.1, 0.2) << box;
  }
}

TEST(BoxLight, OfNoEarthIsOff) {
  const BoxPowers powers = BoxLight(bench()).powers(Vector3(6.5, 0, 1.4), {});
  for (const double power : powers.power) EXPECT_EQ(power, 0.0);
  EXPECT_EQ(powers.misfit, 0.0);
}

// Twice the Earth's light is twice the power, until a box is at its limit; all powers are in 0 to 1.
TEST(BoxLight, PowersAreInProportionToTheEarth) {
  const BoxLight light(bench());
  for (const Vector3& direction : {Vector3(0, 1, 0), Vector3(1, 0.3, 0.2), Vector3(-1, 0, 0), Vector3(0, 0, 1)}) {
    EarthLight earth{direction.normalized(), 1.1, 1e-3};
    const BoxPowers weak = light.powers(Vector3(6.5, 0, 1.4), earth);
    earth.ratio = 2e-3;
    const BoxPowers strong = light.powers(Vector3(6.5, 0, 1.4), earth);
    for (std::size_t k = 0; k < kBoxes; ++k) EXPECT_NEAR(strong.power[k], 2.0 * weak.power[k], 1e-12);
    EXPECT_NEAR(strong.misfit, weak.misfit, 1e-12);
    earth.ratio = 50.0;
    const BoxPowers most = light.powers(Vector3(6.5, 0, 1.4), earth);
    for (const double power : most.power) {
      EXPECT_GE(power, 0.0);
      EXPECT_LE(power, 1.0);
    }
    EXPECT_GT(most.misfit, weak.misfit);
  }
}

// From a side with boxes the Earth is met better than from where the room has none.
TEST(BoxLight, MisfitTellsWhereBoxesAreMissing) {
  const BoxLight light(bench());
  const Vector3 target(6.5, 0, 1.4);
  const double wall = light.powers(target, {Vector3(0, 1, 0), 1.1, 0.2}).misfit;
  const double open = light.powers(target, {Vector3(-1, 0, 0), 1.1, 0.2}).misfit;
  EXPECT_LT(wall, 0.1);
  EXPECT_GT(open, wall);
  EXPECT_LE(open, 1.0);
}

// A box that gives half its light at full power gets no power beyond that.
TEST(BoxLight, KnowsWhatABoxCanGive) {
  std::array<double, kBoxes> half{};
  half.fill(0.5);
  const Vector3 target(6.5, 0, 1.4);
  const EarthLight weak{Vector3(0, 1, 0), 1.1, 1e-3}, strong{Vector3(0, 1, 0), 1.1, 50.0};
  const auto full_powers = BoxLight(bench()).powers(target, weak).power;
  const auto half_powers = BoxLight(bench(), half).powers(target, weak).power;
  for (std::size_t k = 0; k < kBoxes; ++k) EXPECT_NEAR(half_powers[k], full_powers[k], 1e-12);
  for (const double power : BoxLight(bench(), half).powers(target, strong).power) EXPECT_LE(power, 0.5);
}

TEST(BoxLight, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)BoxLight(bench()).powers(Vector3(6.5, 0, 1.4), {Vector3(0, nan, 1), 1.1, 0.2}),
               std::invalid_argument);
  EXPECT_THROW((void)BoxLight(bench()).powers(Vector3(6.5, nan, 1.4), {Vector3(0, 0, 1), 1.1, 0.2}),
               std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron
