#include "host_sim/training/shard_file.h"

#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

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
}  // namespace vbar::training
