// Exchange of pictures for images with a display and a camera that misbehave.

#include <algorithm>
#include <deque>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/imaging/image_exchange.h"

namespace vbar::optical_stimulator {
namespace {

using fsw::Vector2;
using testing::HasSubstr;
using twins::camera::Region;

constexpr int kWidth = 500, kHeight = 68;  // strip and 20 rows of image
constexpr double kFull = 2.4e6, kGain = 0.125;

/// A camera that sees the display pixel by pixel; one action before each image.
class Bench final : public Screen, public FrameCamera {
 public:
  using Action = std::function<void(Bench&)>;

  void show(const Picture& picture) override {
    ++shows;
    if (!is_frozen) shown = picture;
  }
  CameraFrame take() override {
    if (!actions.empty()) {
      const Action action = actions.front();
      actions.pop_front();
      if (action) action(*this);
    }
    CameraFrame frame;
    for (const std::uint8_t count : shown.counts)
      frame.dn.push_back(static_cast<std::uint16_t>(64.0 + kGain * brightness * kFull * light.fraction(count)));
    if (is_mirrored)
      for (auto row = frame.dn.begin(); row != frame.dn.end(); row += kWidth) std::reverse(row, row + kWidth);
    return frame;
  }
  void reopen() override {
    ++reopened;
    if (!can_reopen) throw std::runtime_error("camera 127.0.13.1 does not answer");
  }

  DisplayLight light{{2.2, 3.0, 1e5}, kWidth, kHeight, std::vector<float>(kWidth* kHeight, static_cast<float>(kFull))};
  FrameStrip strip{Region{0, 0, kWidth, kHeight}, light, [](const Vector2& pixel) { return pixel; },
                   Region{0, 0, kWidth, kHeight}, 12000.0};
  std::deque<Action> actions;
  Picture shown{kWidth, kHeight};
  double brightness = 1.0;
  bool is_frozen = false, is_mirrored = false, can_reopen = true;
  int shows = 0, reopened = 0;
};

ExchangeSettings settings_of(const Bench& bench) {
  ExchangeSettings settings;
  settings.white_electrons = bench.strip.white_electrons();
  settings.absence = std::chrono::milliseconds(0);
  return settings;
}

Picture picture_with_star() {
  Picture picture(kWidth, kHeight);
  picture.at(250, 60) = 100;
  return picture;
}

std::string failure_of(Bench& bench) {
  Exchange exchange(settings_of(bench), bench.strip, bench, bench);
  Picture picture = picture_with_star();
  try {
    static_cast<void>(exchange.take(picture));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Exchange, DeliversTheImageBelowTheStrip) {
  Bench bench;
  Exchange exchange(settings_of(bench), bench.strip, bench, bench);
  Picture picture = picture_with_star();
  for (int k = 1; k <= 3; ++k) {
    const ExchangedImage image = exchange.take(picture);
    EXPECT_EQ(image.frame, k);
    EXPECT_EQ(image.tries, 1);
    EXPECT_NEAR(image.brightness, 1.0, 1e-3);
    ASSERT_EQ(image.dn.size(), 500U * 20U);
    EXPECT_GT(image.dn[(60 - 48) * 500 + 250], 1000);
    EXPECT_EQ(image.dn[0], 64);
  }
}

TEST(Exchange, AStaleFrameCostsARetry) {
  Bench bench;
  Exchange exchange(settings_of(bench), bench.strip, bench, bench);
  Picture picture = picture_with_star();
  static_cast<void>(exchange.take(picture));
  const Picture old = bench.shown;
  bench.actions = {[&](Bench& b) { b.shown = old; }};
  const ExchangedImage image = exchange.take(picture);
  EXPECT_EQ(image.tries, 2);
  EXPECT_EQ(image.stale, 1);
  EXPECT_EQ(image.frame, 2);
}

TEST(Exchange, AFrozenCoveredOrMirroredDisplayEndsInOneSentence) {
  Bench frozen;
  frozen.strip.draw(77, frozen.shown);
  frozen.is_frozen = true;
  EXPECT_THAT(failure_of(frozen),
              AllOf(HasSubstr("does not follow"), HasSubstr("picture 77 in place of 1"), HasSubstr("4 images")));
  Bench covered;
  covered.is_frozen = true;
  EXPECT_THAT(failure_of(covered), HasSubstr("no frame strip"));
  Bench mirrored;
  mirrored.is_mirrored = true;
  EXPECT_THAT(failure_of(mirrored), HasSubstr("mirrored"));
}

TEST(Exchange, AWrongBrightnessIsRetakenOnceThenEndsWithBothFigures) {
  Bench bench;
  bench.actions = {[](Bench& b) { b.brightness = 1.1; }, [](Bench& b) { b.brightness = 1.0; }};
  EXPECT_EQ(failure_of(bench), "");
  bench.brightness = 0.9;
  EXPECT_THAT(failure_of(bench), HasSubstr("0.900 and 0.900"));
  bench.brightness = 1.04;
  EXPECT_EQ(failure_of(bench), "");
}

TEST(Exchange, ACameraThatReturnsIsOpenedAgainAndOneThatDoesNotEndsTheRun) {
  const auto away = [](Bench&) { throw std::runtime_error("camera 127.0.13.1 has not delivered"); };
  Bench bench;
  bench.actions = {away, {}};
  EXPECT_EQ(failure_of(bench), "");
  EXPECT_EQ(bench.reopened, 1);
  bench.actions = {away, away};
  EXPECT_THAT(failure_of(bench), HasSubstr("has not delivered"));
  bench.can_reopen = false;
  bench.actions = {away};
  EXPECT_THAT(failure_of(bench), AllOf(HasSubstr("has not delivered"), HasSubstr("does not answer")));
}

TEST(Exchange, EndsWhenItIsCancelled) {
  Bench bench;
  Exchange exchange(settings_of(bench), bench.strip, bench, bench);
  exchange.cancel();
  Picture picture = picture_with_star();
  EXPECT_THROW(static_cast<void>(exchange.take(picture)), std::runtime_error);
}

}  // namespace
}  // namespace vbar::optical_stimulator
