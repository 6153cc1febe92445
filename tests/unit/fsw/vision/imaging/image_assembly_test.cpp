// Tiles in every order give the same image, and what no camera sends is refused without a trace.

#include "fsw/vision/imaging/image_assembly.h"

#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/vision/imaging/image.h"
#include "tests/unit/fsw/vision/imaging/synthetic_images.h"

namespace vbar::fsw::imaging {

namespace {

using Pixels = std::vector<std::uint16_t>;

constexpr GpsTime kNow{1'000'000'000};
constexpr GpsTime kLater{61'000'000'000};

Pixels random_pixels(const ImageFrame& frame, unsigned seed) {
  std::mt19937 random(seed);
  Pixels pixels(static_cast<std::size_t>(frame.width * frame.height));
  for (std::uint16_t& pixel : pixels) pixel = static_cast<std::uint16_t>(random() & ((1U << frame.bits) - 1U));
  return pixels;
}

Pixels pixels_of(const ImageAssembly& assembly) {
  const ImageView view = assembly.view();
  return {view.pixels.begin(), view.pixels.end()};
}

class ImageAssemblyTest : public testing::Test {
 protected:
  Status take(const image_tile& tile, GpsTime time = kNow) { return assembly->take(time, 3, tile); }

  std::unique_ptr<ImageAssembly> assembly = std::make_unique<ImageAssembly>(3);
  ImageFrame small{.width = 60, .height = 50, .origin_x = 710, .origin_y = 200, .bits = 12};  // 4 tiles
};

TEST_F(ImageAssemblyTest, EveryOrderOfTilesGivesTheSameImage) {
  const Pixels pixels = random_pixels(small, 1);
  const std::vector<image_tile> tiles = tiles_of(pixels, small, 7);
  ASSERT_EQ(tiles.size(), 4u);
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  int orders = 0;
  do {
    assembly = std::make_unique<ImageAssembly>(3);
    for (const std::size_t k : order) EXPECT_EQ(take(tiles[k]), Status::kOk);
    EXPECT_TRUE(assembly->has_image());
    EXPECT_EQ(assembly->tiles_missing(), 0);
    EXPECT_EQ(assembly->image_number(), 7);
    EXPECT_EQ(assembly->image_time(), kNow);
    EXPECT_EQ(assembly->view().frame, small);
    EXPECT_EQ(pixels_of(*assembly), pixels);
    ++orders;
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(orders, 24);
}

TEST_F(ImageAssemblyTest, TheLargestImagesOfBothDepths) {
  std::mt19937 random(2);
  for (const int bits : {8, 12}) {
    const ImageFrame frame{.width = 500, .height = 800, .origin_x = 710, .origin_y = 200, .bits = bits};
    const Pixels pixels = random_pixels(frame, 3);
    std::vector<image_tile> tiles = tiles_of(pixels, frame, 0);
    EXPECT_EQ(tiles.size(), bits == 12 ? 461u : 308u);
    std::shuffle(tiles.begin(), tiles.end(), random);
    assembly = std::make_unique<ImageAssembly>(3);
    for (const image_tile& tile : tiles) EXPECT_EQ(take(tile), Status::kOk);
    EXPECT_EQ(pixels_of(*assembly), pixels);
  }
}

TEST_F(ImageAssemblyTest, AllTilesHaveOneExposure) {
  std::vector<image_tile> tiles = tiles_of(random_pixels(small, 1), small, 7);
  for (image_tile& tile : tiles) tile.exposure_s = 0.25F;
  EXPECT_EQ(take(tiles[0]), Status::kOk);
  EXPECT_EQ(assembly->exposure_s(), 0.25);
  tiles[1].exposure_s = 0.5F;
  EXPECT_EQ(take(tiles[1]), Status::kInvalidArgument);
  EXPECT_FALSE(assembly->has_image()) << "spoiled: neither can be trusted";
  for (const float impossible : {-1.0F, 1e9F, std::numeric_limits<float>::quiet_NaN()}) {
    image_tile tile = tiles[0];
    tile.exposure_s = impossible;
    EXPECT_EQ(take(tile, kLater), Status::kInvalidArgument) << impossible;
  }
}

TEST_F(ImageAssemblyTest, OddNumbersOfPixelsAndASingleOne) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 1}, {1, 869}, {31, 29}, {4096, 97}}) {
    const ImageFrame frame{.width = width, .height = height, .bits = 12};
    const Pixels pixels = random_pixels(frame, 4);
    assembly = std::make_unique<ImageAssembly>(3);
    for (const image_tile& tile : tiles_of(pixels, frame, 0)) EXPECT_EQ(take(tile), Status::kOk);
    EXPECT_EQ(pixels_of(*assembly), pixels);
  }
}

TEST_F(ImageAssemblyTest, AMissingTileLeavesMissingPixels) {
  const Pixels pixels = random_pixels(small, 5);
  const std::vector<image_tile> tiles = tiles_of(pixels, small, 0);
  for (const std::size_t k : {3, 0, 1}) EXPECT_EQ(take(tiles[k]), Status::kOk);
  EXPECT_EQ(assembly->tiles_missing(), 1);
  Pixels expected = pixels;
  std::fill(expected.begin() + 2 * 868, expected.begin() + 3 * 868, kMissingPixel);
  EXPECT_EQ(pixels_of(*assembly), expected);
}

TEST_F(ImageAssemblyTest, ALaterTimeStartsANewImageAndAnEarlierIsRefusedWhateverTheOrder) {
  const Pixels first = random_pixels(small, 6);
  const Pixels second = random_pixels(small, 7);
  std::vector<std::pair<GpsTime, image_tile>> all;
  for (const image_tile& tile : tiles_of(first, small, 0)) all.emplace_back(kNow, tile);
  for (const image_tile& tile : tiles_of(second, small, 1)) all.emplace_back(kLater, tile);
  std::mt19937 random(8);
  for (int trial = 0; trial < 50; ++trial) {
    std::shuffle(all.begin(), all.end(), random);
    assembly = std::make_unique<ImageAssembly>(3);
    for (const auto& [time, tile] : all) static_cast<void>(take(tile, time));
    EXPECT_EQ(assembly->image_time(), kLater);
    EXPECT_EQ(assembly->image_number(), 1);
    EXPECT_EQ(pixels_of(*assembly), second);
    EXPECT_EQ(assembly->counts().tiles_refused, 4);
  }
}

TEST_F(ImageAssemblyTest, AnAbandonedImageIsCounted) {
  const std::vector<image_tile> tiles = tiles_of(random_pixels(small, 6), small, 0);
  EXPECT_EQ(take(tiles[0]), Status::kOk);
  EXPECT_EQ(take(tiles[1]), Status::kOk);
  EXPECT_EQ(take(tiles[2], kLater), Status::kOk);
  EXPECT_EQ(take(tiles[3]), Status::kBadSequence);
  EXPECT_EQ(assembly->counts().images_abandoned, 1);
  EXPECT_EQ(assembly->counts().tiles_refused, 3);
  EXPECT_EQ(assembly->tiles_missing(), 3);
}

TEST_F(ImageAssemblyTest, ADuplicateChangesNothing) {
  const Pixels pixels = random_pixels(small, 9);
  for (const image_tile& tile : tiles_of(pixels, small, 0)) {
    EXPECT_EQ(take(tile), Status::kOk);
    EXPECT_EQ(take(tile), Status::kBadSequence);
  }
  EXPECT_EQ(pixels_of(*assembly), pixels);
  EXPECT_EQ(assembly->counts().tiles_duplicated, 4);
}

/// Two tiles of one time that say different things of the same: no order of them makes an image.
TEST_F(ImageAssemblyTest, ContradictionsSpoilTheImageWhateverTheOrder) {
  const std::vector<image_tile> good = tiles_of(random_pixels(small, 10), small, 0);
  std::vector<image_tile> bad(5, good[1]);
  bad[0].data[17] ^= 1U;  // other content of the same tile
  bad[1].image = 9;       // another exposure
  bad[2].origin_x = 711;  // another region
  bad[3] = tiles_of(random_pixels({.width = 50, .height = 60, .bits = 12}, 1), {.width = 50, .height = 60, .bits = 12},
                    0)[1];
  bad[4] = tiles_of(Pixels(3000, 9), {.width = 60, .height = 50, .origin_x = 710, .origin_y = 200, .bits = 8}, 0)[1];
  std::mt19937 random(11);
  for (const image_tile& wrong : bad) {
    for (int trial = 0; trial < 10; ++trial) {
      std::vector<image_tile> tiles = good;
      tiles.push_back(wrong);
      std::shuffle(tiles.begin(), tiles.end(), random);
      assembly = std::make_unique<ImageAssembly>(3);
      for (const image_tile& tile : tiles) static_cast<void>(take(tile));
      EXPECT_FALSE(assembly->has_image());
      EXPECT_TRUE(assembly->view().pixels.empty());
      EXPECT_EQ(assembly->counts().images_spoiled, 1);
      EXPECT_EQ(assembly->counts().tiles_refused, 5);
      EXPECT_EQ(take(good[0], kLater), Status::kOk);
      EXPECT_TRUE(assembly->has_image());
    }
  }
}

TEST_F(ImageAssemblyTest, ATileFromTheFutureIsRefused) {
  const std::vector<image_tile> tiles = tiles_of(random_pixels(small, 12), small, 0);
  assembly->accept_until(kNow);
  EXPECT_EQ(take(tiles[0], {kNow.ns + 1}), Status::kOutOfRange);
  EXPECT_EQ(take(tiles[0]), Status::kOk);
  EXPECT_EQ(assembly->image_time(), kNow);
}

TEST_F(ImageAssemblyTest, AfterUseTheImageIsGoneAndLateTilesStayOut) {
  const std::vector<image_tile> tiles = tiles_of(random_pixels(small, 13), small, 0);
  EXPECT_EQ(take(tiles[0]), Status::kOk);
  assembly->clear();
  EXPECT_FALSE(assembly->has_image());
  EXPECT_EQ(take(tiles[1]), Status::kBadSequence);
  EXPECT_FALSE(assembly->has_image());
  EXPECT_EQ(assembly->counts().images_abandoned, 0);
  EXPECT_EQ(take(tiles[1], kLater), Status::kOk);
  EXPECT_TRUE(assembly->has_image());
}

TEST_F(ImageAssemblyTest, AnotherCameraIsRefused) {
  const image_tile tile = tiles_of(random_pixels(small, 14), small, 0)[0];
  EXPECT_EQ(assembly->take(kNow, 4, tile), Status::kWrongType);
  EXPECT_FALSE(assembly->has_image());
}

TEST_F(ImageAssemblyTest, FieldsThatDisagreeAreRefused) {
  const image_tile good = tiles_of(random_pixels(small, 15), small, 0)[3];
  ASSERT_EQ(good.pixels, 396);
  const auto status_with = [&](auto change) {
    image_tile tile = good;
    change(tile);
    const Status status = take(tile);
    EXPECT_FALSE(assembly->has_image());
    return status;
  };
  using T = image_tile;
  EXPECT_EQ(status_with([](T& t) { t.bits = 10; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.bits = 8; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.image = -1; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.tile = 4; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.tile = -1; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.tile = 2; }), Status::kInvalidArgument);  // too few pixels for that one
  EXPECT_EQ(status_with([](T& t) { t.tiles = 5; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.tiles = 0; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.width = 0; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.height = -50; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.width = 61; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.origin_x = -1; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.origin_y = -1; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.pixels = 397; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.pixels = -1; }), Status::kInvalidArgument);
  EXPECT_EQ(status_with([](T& t) { t.width = 4097; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](T& t) { t.width = t.height = 32767; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](T& t) { t.width = 4001, t.height = 100; }), Status::kOutOfRange);
  EXPECT_EQ(take(good), Status::kOk);
}

/// Whatever the fields say, nothing is read or written outside (the sanitizers watch) and the image there is one that
/// such tiles can make.
TEST_F(ImageAssemblyTest, RandomFieldsDoNoHarm) {
  std::mt19937 random(16);
  const std::array<std::int16_t, 12> values{-1, 0, 1, 2, 3, 4, 50, 60, 396, 868, 1302, 32767};
  int taken = 0;
  for (int trial = 0; trial < 200'000; ++trial) {
    const auto value = [&](std::int16_t usual) { return random() % 4 == 0 ? values[random() % values.size()] : usual; };
    image_tile tile{};
    tile.image = value(0);
    tile.tile = value(static_cast<std::int16_t>(random() % 4));
    tile.tiles = value(4);
    tile.width = value(60);
    tile.height = value(50);
    tile.origin_x = value(0);
    tile.origin_y = value(0);
    tile.pixels = value(tile.tile == 3 ? 396 : 868);
    tile.bits = static_cast<std::int8_t>(random() % 8 == 0 ? random() % 256 : 12);
    if (take(tile, {static_cast<std::int64_t>(trial / 8)}) == Status::kOk) ++taken;
    const ImageView view = assembly->view();
    EXPECT_EQ(view.pixels.size(), static_cast<std::size_t>(view.frame.width * view.frame.height));
    EXPECT_EQ(view.pixels.empty(), !assembly->has_image());
  }
  EXPECT_GT(taken, 1000);
}

}  // namespace

// Bytes written out by hand from the layout in vbar.lcm, and back.

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes packed(const Pixels& pixels, int bits) {
  Bytes out(packed_size(pixels.size(), bits));
  EXPECT_EQ(pack_pixels(pixels, bits, out), out.size());
  return out;
}

TEST(TilePacking, TwelveBitsAreBigEndianPairs) {
  EXPECT_EQ(packed({0xABC, 0x123}, 12), (Bytes{0xAB, 0xC1, 0x23}));
  EXPECT_EQ(packed({0xABC, 0x123, 0xFED}, 12), (Bytes{0xAB, 0xC1, 0x23, 0xFE, 0xD0}));
  EXPECT_EQ(packed({0xFFF}, 12), (Bytes{0xFF, 0xF0}));
}

TEST(TilePacking, EightBitsAreBytes) {
  EXPECT_EQ(packed({0, 1, 255}, 8), (Bytes{0, 1, 255}));
}

TEST(TilePacking, AFullTileFillsItsBytes) {
  EXPECT_EQ(packed_size(kTilePixels12, 12), 1302u);
  EXPECT_EQ(packed_size(kTilePixels8, 8), 1302u);
}

TEST(TilePacking, ComesBackAsItWas) {
  std::mt19937 random(1);
  for (const int bits : {8, 12}) {
    for (std::size_t size = 1; size < 40; ++size) {
      Pixels pixels(size);
      for (std::uint16_t& pixel : pixels) pixel = static_cast<std::uint16_t>(random() & ((1U << bits) - 1U));
      Pixels back(size);
      const Bytes bytes = packed(pixels, bits);
      EXPECT_EQ(unpack_pixels(bytes, bits, back), bytes.size());
      EXPECT_EQ(back, pixels);
    }
  }
}

TEST(TilePacking, RefusesWhatDoesNotFit) {
  Bytes out(3, 0x55);
  EXPECT_EQ(pack_pixels(Pixels{1, 2, 3}, 12, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{1, 2, 3, 4}, 8, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{0x1000}, 12, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{0x100}, 8, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{1}, 10, out), 0u);
  EXPECT_EQ(out, Bytes(3, 0x55));
  Pixels pixels(3, 7);
  EXPECT_EQ(unpack_pixels(Bytes(4), 12, pixels), 0u);
  EXPECT_EQ(unpack_pixels(Bytes(2), 8, pixels), 0u);
  EXPECT_EQ(unpack_pixels(Bytes(9), 16, pixels), 0u);
  EXPECT_EQ(pixels, Pixels(3, 7));
}

}  // namespace

}  // namespace vbar::fsw::imaging
