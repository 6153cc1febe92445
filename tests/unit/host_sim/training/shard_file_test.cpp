#include "host_sim/training/shard_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/mission/data_file.h"
#include "host_sim/training/circumstances.h"
#include "host_sim/training/crop_maker.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::training {

namespace {

float float_at(const std::string& bytes, std::size_t at) {
  float value = 0.0F;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

LabelledCrop crop() {
  LabelledCrop made;
  made.samples.fill(10.0F);
  made.samples[1] = 63.4F;
  made.samples[128] = 100.0F;
  for (std::size_t k = 0; k < 11; ++k) {
    made.cells[k] = fsw::Vector2(static_cast<double>(k), 0.5);
    made.counts[k] = k != 3;
  }
  made.circumstances.centre_of_mass_camera = {1.0, 2.0, 9.0};
  made.circumstances.region = {{400.0, 250.0}, 200.0};
  made.circumstances.exposure = 2.0;
  return made;
}

TEST(ShardFile, CropsBytesAreAsDescribed) {
  static_assert(std::endian::native == std::endian::little);
  twins::camera::CameraSettings camera;
  std::string bytes;
  append_crop(crop(), camera, bytes);
  ASSERT_EQ(bytes.size(), 128U * 128U + 56U * 4U);
  EXPECT_EQ(static_cast<unsigned char>(bytes[0]), 40);
  EXPECT_EQ(static_cast<unsigned char>(bytes[1]), 254);    // 253.6
  EXPECT_EQ(static_cast<unsigned char>(bytes[128]), 255);  // no more than a byte holds
  const std::size_t numbers = 128U * 128U;
  EXPECT_FLOAT_EQ(float_at(bytes, numbers + 4U * 4U), 2.0F);  // x of keypoint 2
  EXPECT_FLOAT_EQ(float_at(bytes, numbers + 4U * 5U), 0.5F);
  EXPECT_FLOAT_EQ(float_at(bytes, numbers + 4U * 25U), 0.0F);  // keypoint 3 does not count
  EXPECT_FLOAT_EQ(float_at(bytes, numbers + 4U * 36U), 1.0F);  // w of no turn
  EXPECT_FLOAT_EQ(float_at(bytes, numbers + 4U * 39U), 9.0F);
  EXPECT_FLOAT_EQ(float_at(bytes, numbers + 4U * 42U), 200.0F);
  EXPECT_FLOAT_EQ(float_at(bytes, numbers + 4U * 53U), 2.0F);
}

TEST(ShardFile, HasItsNameOnlyWhole) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("vbar_shard_{}", getpid());
  std::filesystem::create_directories(folder);
  std::string bytes;
  append_crop(crop(), twins::camera::CameraSettings(), bytes);
  const auto file = folder / "training_9_0000005.crops";
  write_shard(file, 9, 5, 1, bytes);
  std::ifstream in(file, std::ios::binary);
  const std::string read((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  ASSERT_EQ(read.size(), 48U + bytes.size());
  EXPECT_EQ(read.substr(0, 12), "vbar crops 1");
  std::uint32_t header[4];
  std::memcpy(header, read.data() + 16, sizeof header);
  EXPECT_EQ(header[0], 1U);
  EXPECT_EQ(header[1], 128U);
  EXPECT_EQ(header[2], 11U);
  EXPECT_EQ(header[3], 56U);
  std::int64_t first = 0;
  std::memcpy(&first, read.data() + 40, 8);
  EXPECT_EQ(first, 5);
  EXPECT_EQ(read.substr(48), bytes);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  EXPECT_THROW(write_shard(folder / "none" / "x.crops", 9, 5, 1, bytes), std::runtime_error);
  std::filesystem::remove_all(folder);
}

}  // namespace

namespace {

using fsw::Vector3;

TEST(SoftPicture, KeepsLightAndSpreadsItAsTold) {
  constexpr int kWidth = 61, kHeight = 41, kX = 30, kY = 20;
  for (const double sigma : {0.8, 1.5, 4.0}) {
    std::vector<float> picture(kWidth * kHeight, 0.0F);
    picture[kY * kWidth + kX] = 1000.0F;
    soften(sigma, kWidth, kHeight, picture);
    double sum = 0.0, across = 0.0, down = 0.0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double light = static_cast<double>(picture[static_cast<std::size_t>(y * kWidth + x)]);
        sum += light;
        across += light * (x - kX) * (x - kX);
        down += light * (y - kY) * (y - kY);
      }
    EXPECT_NEAR(sum, 1000.0, 0.01);
    // Cut off at three and a half deviations a Gaussian has lost 1 to 2 % of its variance.
    EXPECT_NEAR(across / sum, sigma * sigma, 0.02 * sigma * sigma);
    EXPECT_NEAR(down / sum, sigma * sigma, 0.02 * sigma * sigma);
  }
}

TEST(SoftPicture, WithoutSpreadNothingChanges) {
  std::vector<float> picture{1.0F, 2.0F, 3.0F, 4.0F};
  soften(0.0, 2, 2, picture);
  EXPECT_EQ(picture, (std::vector<float>{1.0F, 2.0F, 3.0F, 4.0F}));
}

twins::camera::CadModel plate(double width_m, double height_m) {
  const Vector3 a(-0.5 * width_m, -0.5 * height_m, 0.0), b(0.5 * width_m, -0.5 * height_m, 0.0);
  const std::array<Vector3, 3> flat{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  return twins::camera::make_cad_model("plate", {{{a, b, -a}, flat, 0}, {{a, -a, -b}, flat, 0}},
                                       {{"white", {}, {}, 0.0}});
}

// A plate square to the boresight: its size in pixels is focal length times size over range.
TEST(Silhouette, PlateCoversWhatItShould) {
  auto camera = close_range_camera(mission::data_directory());
  camera.optics.distortion = {};
  const twins::camera::Optics optics(camera);
  twins::camera::Silhouette silhouette(plate(0.8, 0.4));
  const twins::camera::Region region{380, 200, 200, 200};
  std::vector<float> covered;
  silhouette.draw(optics, Vector3(0.0, 0.0, 8.0), fsw::Matrix3::Identity(), region, covered);
  double area = 0.0, x_sum = 0.0, y_sum = 0.0;
  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x) {
      const double share = static_cast<double>(covered[static_cast<std::size_t>(y * region.width + x)]);
      area += share;
      x_sum += share * (region.x + x);
      y_sum += share * (region.y + y);
    }
  const double f = camera.focal_length_px();
  // Edges are found to half a point of the grid, a quarter of a pixel.
  EXPECT_NEAR(area, f * f * 0.8 * 0.4 / 64.0, 0.25 * 2.0 * f * (0.8 + 0.4) / 8.0);
  EXPECT_NEAR(x_sum / area, 479.5, 0.25);
  EXPECT_NEAR(y_sum / area, 299.5, 0.25);
}

}  // namespace

}  // namespace vbar::training
