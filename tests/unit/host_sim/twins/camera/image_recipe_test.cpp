// An exposure's way through its bytes.

#include "host_sim/twins/camera/image_recipe.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

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
}  // namespace vbar::twins::camera
