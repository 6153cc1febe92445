// Hot pixels are learned by their constancy, the target is not.

#include "fsw/tracking/hot_pixel_map.h"

#include <gtest/gtest.h>

namespace {

using vbar::fsw::Vector2;
using vbar::fsw::imaging::DetectedObject;
using vbar::fsw::tracking::HotPixelMap;

DetectedObject object_at(double x, double y, int pixels) {
  DetectedObject object;
  object.centroid_px = Vector2(x, y);
  object.pixels = pixels;
  object.sharpness = 1.0 / pixels;
  return object;
}

TEST(HotPixelMap, KnowsAPixelAfterFourSightings) {
  HotPixelMap map;
  for (int image = 0; image < 4; ++image) {
    map.begin_image();
    EXPECT_FALSE(map.see(object_at(900.0, 600.0, 1))) << image;
  }
  map.begin_image();
  EXPECT_TRUE(map.see(object_at(900.1, 599.9, 2)));
  EXPECT_EQ(map.known(), 1U);
  EXPECT_FALSE(map.see(object_at(902.0, 600.0, 1)));  // another pixel
}

TEST(HotPixelMap, NeverLearnsWhatHasTheShapeOfLight) {
  HotPixelMap map;
  for (int image = 0; image < 100; ++image) {
    map.begin_image();
    EXPECT_FALSE(map.see(object_at(900.0, 600.0, 9)));
  }
  EXPECT_EQ(map.known(), 0U);
}

// The target in front of a hot pixel is larger than it.
TEST(HotPixelMap, LetsALargerObjectOnAKnownPixelPass) {
  HotPixelMap map;
  for (int image = 0; image < 10; ++image) {
    map.begin_image();
    map.see(object_at(900.0, 600.0, 1));
  }
  map.begin_image();
  EXPECT_FALSE(map.see(object_at(900.0, 600.0, 12)));
}

TEST(HotPixelMap, DoesNotLearnASmallObjectThatMoves) {
  HotPixelMap map;
  for (int image = 0; image < 50; ++image) {
    map.begin_image();
    EXPECT_FALSE(map.see(object_at(900.0 + 1.5 * image, 600.0, 2)));
  }
}

TEST(HotPixelMap, ForgetsAPixelThatCooledDown) {
  HotPixelMap map;
  for (int image = 0; image < 10; ++image) {
    map.begin_image();
    map.see(object_at(900.0, 600.0, 1));
  }
  for (int image = 0; image < 61; ++image) map.begin_image();
  EXPECT_FALSE(map.see(object_at(900.0, 600.0, 1)));
}

// Twenty hot pixels among more noise than the map has places for.
TEST(HotPixelMap, KeepsKnownPixelsWhenNoiseFillsTheMap) {
  HotPixelMap map;
  int noise = 0;
  for (int image = 0; image < 40; ++image) {
    map.begin_image();
    for (int k = 0; k < 20; ++k) {
      EXPECT_EQ(map.see(object_at(720.0 + 7.0 * k, 300.0, 1)), image > 3) << image;
    }
    for (int k = 0; k < 30; ++k, ++noise) map.see(object_at(710.0 + noise % 499, 400.0 + noise / 499, 1));
  }
  EXPECT_EQ(map.known(), 20U);
}

TEST(HotPixelMap, RefusesAPlaceThatIsNoNumber) {
  HotPixelMap map;
  for (int image = 0; image < 10; ++image) {
    map.begin_image();
    EXPECT_FALSE(map.see(object_at(__builtin_nan(""), 600.0, 1)));
  }
  EXPECT_EQ(map.known(), 0U);
}

}  // namespace
