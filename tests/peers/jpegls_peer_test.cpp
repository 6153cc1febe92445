// The JPEG-LS data of a recorded image read by another decoder, ffmpeg's: the same pixels.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/logged_image.h"

namespace vbar::twins::camera {
namespace {

namespace fs = std::filesystem;

class JpegLsPeer : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
    folder_ = fs::path(testing::TempDir()) / ("vbar_jpegls_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

/// The detector's noise, a few stars and a saturated block.
std::vector<std::uint16_t> image(const CameraSettings& settings) {
  PhotonImage photons{settings.region, {}};
  photons.electrons.assign(
      static_cast<std::size_t>(settings.region.width) * static_cast<std::size_t>(settings.region.height), 0.5F);
  for (int star = 0; star < 60; ++star)
    photons.at(settings.region.x + 3 + (star * 7919) % (settings.region.width - 6),
               settings.region.y + 3 + (star * 104729) % (settings.region.height - 6)) =
        150.0F * static_cast<float>(star);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) photons.at(settings.region.x + 40 + x, settings.region.y + 30 + y) = 1e6F;
  Detector detector(settings, 1, "servicer/camera");
  std::vector<std::uint16_t> dn;
  detector.expose(photons, 4, dn);
  return dn;
}

TEST_P(JpegLsPeer, ReadsTheSamePixels) {
  CameraSettings settings;
  settings.detector.bits = GetParam();
  settings.region = {710, 200, 500, 800};
  const std::vector<std::uint16_t> dn = image(settings);
  const std::vector<std::uint8_t> bytes = recorded_image_of({{}, settings.region, GetParam()}, dn);
  constexpr std::size_t kDataAt = 50;  // of the LCM message recorded_image
  const fs::path coded = folder_ / "image.jls", decoded = folder_ / "image.raw";
  std::ofstream(coded, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()) + kDataAt,
             static_cast<std::streamsize>(bytes.size() - kDataAt));
  // Its own formats: 8 bits, or 12 bits aligned to the left in 16.
  const std::string format = GetParam() == 8 ? "gray" : "gray16le";
  const std::string command =
      "ffmpeg -v error -y -i " + coded.string() + " -f rawvideo -pix_fmt " + format + " " + decoded.string() + " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::ifstream stream(decoded, std::ios::binary);
  const std::string raw{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t bytes_of_pixel = GetParam() == 8 ? 1 : 2;
  ASSERT_EQ(raw.size(), bytes_of_pixel * dn.size());
  for (std::size_t k = 0; k < dn.size(); ++k) {
    const auto low = static_cast<std::uint8_t>(raw[bytes_of_pixel * k]);
    const auto value = bytes_of_pixel == 1
                           ? static_cast<unsigned>(low)
                           : (static_cast<unsigned>(static_cast<std::uint8_t>(raw[2 * k + 1])) << 8U | low) >> 4U;
    ASSERT_EQ(value, dn[k]) << "pixel " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Bits, JpegLsPeer, testing::Values(8, 12));

}  // namespace
}  // namespace vbar::twins::camera
