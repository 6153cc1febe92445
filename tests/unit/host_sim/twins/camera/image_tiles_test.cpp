// An exposure's way through its bytes.

#include "host_sim/twins/camera/image_tiles.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/twins/camera/logged_image.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::twins::camera {

namespace {

ImageRecipe some_recipe(std::size_t objects) {
  ImageRecipe recipe;
  recipe.spacecraft = 255;
  recipe.unit = 3;
  Exposure& exposure = recipe.exposure;
  exposure.time = {995'000'000'123'456'789LL};
  exposure.number = 2159;
  exposure.q_camera_eci = Eigen::Quaterniond(0.1, -0.2, 0.3, std::nextafter(0.9, 1.0));
  exposure.rate_camera = {1e-3, -2e-300, -0.0};
  exposure.camera_position_eci = {7.1e6, std::numeric_limits<double>::denorm_min(), 3.0};
  exposure.camera_velocity_eci = {1.0 / 3.0, 2.0, -3.0};
  exposure.earth_velocity_bcrs = {4.0, 5.0, 6.0};
  exposure.sun_eci = {1.5e11, 7.0, 8.0};
  exposure.moon_eci = {3.8e8, 9.0, 10.0};
  exposure.years_since_j2000 = 11.5;
  for (std::size_t k = 0; k < objects; ++k) {
    const auto number = static_cast<double>(k);
    exposure.objects.push_back({"spacecraft " + std::to_string(k),
                                std::string(63, 'm'),
                                {number, 0.1, 0.2},
                                {0.3, number, 0.4},
                                Eigen::Quaterniond(number, 0.5, 0.6, 0.7),
                                0.1 * number});
  }
  return recipe;
}

void expect_same(const Exposure& a, const Exposure& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.q_camera_eci.coeffs(), b.q_camera_eci.coeffs());
  EXPECT_EQ(a.rate_camera, b.rate_camera);
  EXPECT_EQ(a.camera_position_eci, b.camera_position_eci);
  EXPECT_EQ(a.camera_velocity_eci, b.camera_velocity_eci);
  EXPECT_EQ(a.earth_velocity_bcrs, b.earth_velocity_bcrs);
  EXPECT_EQ(a.sun_eci, b.sun_eci);
  EXPECT_EQ(a.moon_eci, b.moon_eci);
  EXPECT_EQ(a.years_since_j2000, b.years_since_j2000);
  EXPECT_EQ(a.objects, b.objects);
}

TEST(ImageRecipe, EveryNumberComesBackToTheLastBit) {
  for (const std::size_t objects : {0U, 1U, 8U}) {
    const ImageRecipe recipe = some_recipe(objects);
    const auto back = recipe_of(bytes_of(recipe));
    ASSERT_TRUE(back) << objects;
    EXPECT_EQ(back->spacecraft, 255);
    EXPECT_EQ(back->unit, 3);
    expect_same(back->exposure, recipe.exposure);
    EXPECT_TRUE(std::signbit(back->exposure.rate_camera.z()));
  }
}

TEST(ImageRecipe, WhatItCannotHoldIsRefused) {
  EXPECT_THROW(static_cast<void>(bytes_of(some_recipe(9))), std::invalid_argument);
  ImageRecipe recipe = some_recipe(1);
  recipe.exposure.objects[0].name = std::string(64, 'n');
  EXPECT_THROW(static_cast<void>(bytes_of(recipe)), std::invalid_argument);
}

TEST(ImageRecipe, DamagedBytesAreNone) {
  const std::vector<std::uint8_t> bytes = bytes_of(some_recipe(2));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(recipe_of(std::span(bytes).first(size))) << size;
  }
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(recipe_of(longer));
  std::vector<std::uint8_t> other_type = bytes;
  other_type[0] ^= 1U;
  EXPECT_FALSE(recipe_of(other_type));
  // Every byte in turn as bad as can be: a recipe or none, and never a name or a number of objects beyond its bounds.
  for (std::size_t k = 8; k < bytes.size(); ++k) {
    std::vector<std::uint8_t> damaged = bytes;
    damaged[k] = 0xFF;
    if (const auto recipe = recipe_of(damaged)) {
      EXPECT_LE(recipe->exposure.objects.size(), 8U);
      for (const ObjectInView& object : recipe->exposure.objects) EXPECT_LE(object.name.size(), 64U);
    }
  }
}

}  // namespace

// Tiles against the format that vbar.lcm states, unpacked here bit by bit.

namespace {

const ImageLabel kLabel{{995'000'000'000'000'000LL}, 5, 1, 2};

std::vector<image_tile> decode(const std::vector<Packet>& packets, const ImageLabel& label) {
  std::vector<image_tile> tiles;
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const auto view = fsw::packets::parse_packet(packets[k]);
    EXPECT_TRUE(view.ok());
    EXPECT_EQ(view.value().header.time, label.time);
    EXPECT_EQ(view.value().header.spacecraft, label.spacecraft);
    EXPECT_EQ(view.value().header.unit, label.unit);
    EXPECT_EQ(view.value().header.sequence_count,
              (static_cast<std::size_t>(label.number) * packets.size() + k) % 16384);
    const auto tile = fsw::packets::decode<image_tile>(view.value());
    EXPECT_TRUE(tile.ok());
    EXPECT_EQ(tile.value().image, label.number);
    EXPECT_EQ(tile.value().tile, static_cast<int>(k));
    EXPECT_EQ(tile.value().tiles, static_cast<int>(packets.size()));
    tiles.push_back(tile.value());
  }
  return tiles;
}

/// Pixel k of a stream of `bits` a pixel, the most significant bit first.
unsigned pixel_of(const std::uint8_t* data, std::size_t k, std::size_t bits) {
  unsigned value = 0;
  for (std::size_t bit = k * bits; bit < (k + 1) * bits; ++bit)
    value = value << 1U | (data[bit / 8] >> (7 - bit % 8) & 1U);
  return value;
}

std::vector<std::uint16_t> pattern(std::size_t pixels, unsigned most) {
  std::vector<std::uint16_t> dn(pixels);
  for (std::size_t k = 0; k < pixels; ++k) dn[k] = static_cast<std::uint16_t>((k * 2654435761U >> 7U) % (most + 1));
  return dn;
}

class ImageTiles : public testing::TestWithParam<Region> {};

TEST_P(ImageTiles, HoldEveryPixelInOrder) {
  const Region region = GetParam();
  const auto pixels = static_cast<std::size_t>(region.width * region.height);
  for (const int bits : {8, 12}) {
    const std::size_t pixels_of_tile = bits == 8 ? 1302 : 868;
    const std::vector<std::uint16_t> dn = pattern(pixels, (1U << static_cast<unsigned>(bits)) - 1);
    const std::vector<image_tile> tiles = decode(image_tiles(kLabel, region, bits, dn), kLabel);
    ASSERT_EQ(tiles.size(), (pixels + pixels_of_tile - 1) / pixels_of_tile);
    std::size_t next = 0;
    for (const image_tile& tile : tiles) {
      EXPECT_EQ(tile.width, region.width);
      EXPECT_EQ(tile.height, region.height);
      EXPECT_EQ(tile.origin_x, region.x);
      EXPECT_EQ(tile.origin_y, region.y);
      EXPECT_EQ(tile.bits, bits);
      ASSERT_EQ(static_cast<std::size_t>(tile.pixels), std::min(pixels_of_tile, pixels - next));
      for (std::size_t k = 0; k < static_cast<std::size_t>(tile.pixels); ++k, ++next)
        ASSERT_EQ(pixel_of(tile.data, k, static_cast<std::size_t>(bits)), dn[next]) << next;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Regions, ImageTiles,
                         testing::Values(Region{710, 200, 500, 800}, Region{0, 0, 868, 1}, Region{3, 4, 1303, 1},
                                         Region{1919, 1199, 1, 1}, Region{0, 0, 17, 51}));

TEST(ImageTilesOfARun, CountOnFromImageToImage) {
  const Region region{0, 0, 60, 60};
  const std::vector<std::uint16_t> dn = pattern(3600, 4095);
  ImageLabel label = kLabel;
  label.number = 4000;  // 5 tiles an image: past the 14 bits of a sequence count
  static_cast<void>(decode(image_tiles(label, region, 12, dn), label));
}

TEST(ImageTilesOfARun, WhatDoesNotFitIsRefused) {
  const std::vector<std::uint16_t> dn(100);
  EXPECT_THROW(image_tiles(kLabel, {0, 0, 10, 10}, 10, dn), std::invalid_argument);
  EXPECT_THROW(image_tiles(kLabel, {0, 0, 11, 10}, 12, dn), std::invalid_argument);
}

}  // namespace

// The kept directions are those of the lens, to the bit, also after a change of the region.

namespace {

TEST(PixelDirections, AreThoseOfTheLensInEveryRegion) {
  CameraSettings settings;
  settings.optics.distortion = {-0.12, 0.08, 1.5e-3, -7e-4, 0.02};
  const auto optics = std::make_shared<const Optics>(settings);
  PixelDirections directions(optics);
  for (const Region& region :
       {Region{10, 20, 7, 5}, Region{10, 20, 7, 5}, Region{900, 600, 5, 7}, Region{0, 0, 3, 3}}) {
    directions.prepare(region);
    for (int y = region.y; y < region.y + region.height; ++y)
      for (int x = region.x; x < region.x + region.width; ++x)
        ASSERT_EQ(directions.at(x, y), optics->direction_of(fsw::Vector2(x, y))) << x << ", " << y;
  }
}

}  // namespace

}  // namespace vbar::twins::camera
