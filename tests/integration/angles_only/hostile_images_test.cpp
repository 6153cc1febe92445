// Images that no star tracker wants: each gives a status that says so or a right answer, never a wrong bearing, and the
// next good image is as good as ever.

#include <algorithm>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "tests/integration/angles_only/image_chain.h"

namespace vbar::test {
namespace {

using fsw::Vector3;
using fsw::angles_only::ObjectKind;
using fsw::angles_only::Sighting;
using fsw::angles_only::SightingStatus;

constexpr double kRange_m = 30e3;

class HostileImages : public testing::Test {
 protected:
  void SetUp() override {
    for (int k = 0; k < 10; ++k) chain_.look(scenes_.next(kRange_m));
    expect_good(scenes_.next(kRange_m));
  }

  void expect_good(const Scene& scene) {
    const Sighting& sighting = chain_.look(scene);
    ASSERT_EQ(sighting.status, SightingStatus::kBearing);
    expect_right(scene, sighting);
  }

  /// If there is a bearing it is the target's.
  static void expect_right(const Scene& scene, const Sighting& sighting) {
    if (sighting.status != SightingStatus::kBearing) return;
    EXPECT_LT((sighting.bearing.direction_eci - scene.target_direction()).norm(), 30.0 * kArcsec);
  }

  SceneMaker scenes_;
  ImageChain chain_;
};

TEST_F(HostileImages, AllBlack) {
  EXPECT_EQ(chain_.look_at_uniform(scenes_.next(kRange_m), 0).status, SightingStatus::kBlank);
  expect_good(scenes_.next(kRange_m));
}

TEST_F(HostileImages, AllWhite) {
  EXPECT_EQ(chain_.look_at_uniform(scenes_.next(kRange_m), 4095).status, SightingStatus::kBlank);
  expect_good(scenes_.next(kRange_m));
}

TEST_F(HostileImages, MissingTile) {
  const Scene scene = scenes_.next(kRange_m);
  const Sighting& sighting =
      chain_.look(scene, [](std::vector<image_tile>& tiles) { tiles.erase(tiles.begin() + 100); });
  EXPECT_EQ(sighting.tiles_missing, 1);
  EXPECT_GT(sighting.stars, 3);
  expect_right(scene, sighting);
}

TEST_F(HostileImages, HalfMissing) {
  const Scene scene = scenes_.next(kRange_m);
  const Sighting& sighting = chain_.look(scene, [](std::vector<image_tile>& tiles) { tiles.resize(tiles.size() / 2); });
  EXPECT_EQ(sighting.tiles_missing, 231);
  expect_right(scene, sighting);
  expect_good(scenes_.next(kRange_m));
}

TEST_F(HostileImages, EverySecondTileMissing) {
  const Scene scene = scenes_.next(kRange_m);
  const Sighting& sighting = chain_.look(scene, [](std::vector<image_tile>& tiles) {
    std::erase_if(tiles, [](const image_tile& tile) { return tile.tile % 2 == 1; });
  });
  expect_right(scene, sighting);
  expect_good(scenes_.next(kRange_m));
}

// Two tiles that stand in each other's place: their pixels are elsewhere, and stars with them.
TEST_F(HostileImages, SwappedTiles) {
  const Scene scene = scenes_.next(kRange_m);
  const Sighting& sighting =
      chain_.look(scene, [](std::vector<image_tile>& tiles) { std::swap(tiles[50].tile, tiles[300].tile); });
  EXPECT_EQ(sighting.tiles_missing, 0);
  EXPECT_GT(sighting.stars, 3);
  expect_right(scene, sighting);
}

TEST_F(HostileImages, TilesOfAnotherCamera) {
  const Scene scene = scenes_.next(kRange_m);
  const Sighting& sighting = chain_.look(scene, [](std::vector<image_tile>& tiles) {
    for (image_tile& tile : tiles) tile.origin_x = 0;
  });
  EXPECT_EQ(sighting.status, SightingStatus::kWrongFrame);
  expect_good(scenes_.next(kRange_m));
}

// The Sun, the Moon, the Earth's limb in the middle of the image, the target beside them.
TEST_F(HostileImages, SunInTheField) {
  const Vector3 servicer = SceneMaker::servicer_at(11).position_eci;
  const Vector3 sun = (SceneMaker::sun_eci(11) - servicer).normalized();
  const Vector3 beside = Eigen::AngleAxisd(0.02, servicer.normalized()) * sun;
  const Scene scene = scenes_.looking(11, sun, beside, kRange_m);
  EXPECT_NE(chain_.look(scene).status, SightingStatus::kBearing);
  expect_good(scenes_.next(kRange_m));
}

TEST_F(HostileImages, MoonInTheField) {
  const Vector3 servicer = SceneMaker::servicer_at(11).position_eci;
  const Vector3 moon = (SceneMaker::moon_eci(11) - servicer).normalized();
  const Vector3 beside = Eigen::AngleAxisd(0.02, servicer.normalized()) * moon;
  const Scene scene = scenes_.looking(11, moon, beside, kRange_m);
  expect_right(scene, chain_.look(scene));
  expect_good(scenes_.next(kRange_m));
}

TEST_F(HostileImages, EarthLimbInTheField) {
  // The limb stands 26 degrees below the horizontal.
  const auto servicer = SceneMaker::servicer_at(11);
  const Vector3 back = -servicer.velocity_eci.normalized();
  const Vector3 normal = servicer.position_eci.cross(servicer.velocity_eci).normalized();
  const Vector3 limb = Eigen::AngleAxisd(-std::acos(6378e3 / servicer.position_eci.norm()), normal) * back;
  ASSERT_LT(limb.dot(servicer.position_eci), 0.0);
  const Vector3 above = Eigen::AngleAxisd(0.02, normal) * limb;
  const Scene scene = scenes_.looking(11, limb, above, kRange_m);
  expect_right(scene, chain_.look(scene));
  expect_good(scenes_.next(kRange_m));
}

TEST_F(HostileImages, TargetBehindAStar) {
  // The target before the brightest identified star of the image: one object, and a star.
  const Scene clear = scenes_.next(kRange_m);
  const Sighting& seen = chain_.look(clear);
  ASSERT_GT(seen.stars, 3);
  std::size_t star = 0;
  while (seen.kind[star] != ObjectKind::kStar) ++star;
  fsw::imaging::CameraModel model;
  model.focal_length_px.setConstant(chain_.camera().focal_length_px());
  model.principal_point_px = {959.5, 599.5};
  const Vector3 direction_camera = fsw::imaging::direction_of(model, chain_.objects()[star].centroid_px).value();
  const Vector3 direction = clear.R_camera_eci.transpose() * direction_camera;
  const Scene scene = scenes_.looking(12, clear.R_commanded_eci.row(2).transpose(), direction, kRange_m);
  expect_right(scene, chain_.look(scene));
}

TEST_F(HostileImages, TargetOutOfTheField) {
  const Scene near = scenes_.next(kRange_m);
  const Vector3 away = Eigen::AngleAxisd(0.15, near.servicer.position_eci.normalized()) * near.target_direction();
  const Scene scene = scenes_.looking(12, away, near.target_direction(), kRange_m);
  const Sighting& sighting = chain_.look(scene);
  EXPECT_GT(sighting.stars, 3);
  EXPECT_EQ(sighting.status, SightingStatus::kNoTarget);
  expect_good(scenes_.next(kRange_m));
}

}  // namespace
}  // namespace vbar::test
