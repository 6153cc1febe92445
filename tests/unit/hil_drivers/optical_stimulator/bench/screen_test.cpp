// The framebuffer file of the X server, and the pictures of an exposure.

#include <cmath>
#include <cstring>
#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/bench/screen/screen_watch.h"
#include "hil_drivers/optical_stimulator/bench/screen/xwd.h"

namespace vbar::optical_stimulator::bench {
namespace {

void set_word(std::vector<std::uint8_t>& file, std::size_t index, std::uint32_t value) {
  for (std::size_t k = 0; k < 4; ++k) file[4 * index + k] = static_cast<std::uint8_t>(value >> (8 * (3 - k)));
}

/// As Xvfb writes it for a screen of 24 bits: header of 160 bytes, 256 colours (X11/XWDFile.h).
std::vector<std::uint8_t> dump_of(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> file(160 + 256 * 12 + 4 * width * height, 0);
  const std::uint32_t words[] = {160, 7,  2,         24, width,    height, 0,    0, 32,  0,
                                 32,  32, 4 * width, 4,  0xff0000, 0xff00, 0xff, 8, 256, 256};
  for (std::size_t k = 0; k < std::size(words); ++k) set_word(file, k, words[k]);
  return file;
}

TEST(Xwd, PixelsBeginBehindHeaderAndColours) {
  std::vector<std::uint8_t> file = dump_of(3, 2);
  const XwdLayout layout = read_xwd_layout(file);
  EXPECT_EQ(layout.width, 3);
  EXPECT_EQ(layout.height, 2);
  EXPECT_EQ(layout.pixels, 160U + 256U * 12U);
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t byte = 0; byte < 3; ++byte) file[layout.pixels + 4 * k + byte] = static_cast<std::uint8_t>(51 * k);
  file[layout.pixels + 1] = 255;  // green alone
  std::vector<std::uint8_t> grey;
  read_grey(file, layout, grey);
  EXPECT_THAT(grey, ::testing::ElementsAre(182, 51, 102, 153, 204, 255));  // 0.7152 * 255 = 182.4
}

TEST(Xwd, HostileHeadersAreOneError) {
  const std::vector<std::uint8_t> good = dump_of(8, 8);
  for (const auto& [word, value] : std::vector<std::pair<std::size_t, std::uint32_t>>{{0, 0xffffffff},
                                                                                      {1, 6},
                                                                                      {2, 1},
                                                                                      {4, 0},
                                                                                      {4, 0xffffffff},
                                                                                      {5, 9},
                                                                                      {7, 1},
                                                                                      {11, 16},
                                                                                      {12, 31},
                                                                                      {14, 0xff},
                                                                                      {19, 0x7fffffff}}) {
    std::vector<std::uint8_t> file = good;
    set_word(file, word, value);
    EXPECT_THROW((void)read_xwd_layout(file), std::runtime_error) << word;
  }
  for (std::size_t size = 0; size < good.size(); size += 37)
    EXPECT_THROW((void)read_xwd_layout(std::span(good).first(size)), std::runtime_error) << size;
}

std::deque<TimedPicture> three_pictures() {
  std::deque<TimedPicture> shown;
  for (const double begin_s : {0.0, 1.0, 1.5})
    shown.push_back(
        {begin_s, std::make_shared<const std::vector<std::uint8_t>>(1, static_cast<std::uint8_t>(shown.size()))});
  return shown;
}

TEST(Pictures, ShareTheExposureByTime) {
  const Pictures pictures = pictures_of(three_pictures(), 0.8, 1.8, 0.0);
  ASSERT_EQ(pictures.size(), 3U);
  EXPECT_NEAR(pictures[0].fraction, 0.2, 1e-12);
  EXPECT_NEAR(pictures[1].fraction, 0.5, 1e-12);
  EXPECT_NEAR(pictures[2].fraction, 0.3, 1e-12);
  const Pictures later = pictures_of(three_pictures(), 5.0, 5.2, 0.0);
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(later[0].counts->front(), 2);
}

TEST(Pictures, FollowTheResponseOfThePixels) {
  // A step from picture 0 to 1 at 1.0 s with a time constant of 0.1 s, seen from 1.0 to 1.2 s: the first keeps
  // tau (1 - exp(-2)) of the light.
  std::deque<TimedPicture> shown = three_pictures();
  shown.pop_back();
  const Pictures pictures = pictures_of(shown, 1.0, 1.2, 0.1);
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_NEAR(pictures[0].fraction, 0.1 * (1.0 - std::exp(-2.0)) / 0.2, 1e-12);
  EXPECT_NEAR(pictures[0].fraction + pictures[1].fraction, 1.0, 1e-12);
}

}  // namespace
}  // namespace vbar::optical_stimulator::bench
