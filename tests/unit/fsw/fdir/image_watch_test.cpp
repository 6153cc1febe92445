// Cameras that fall silent or repeat themselves.

#include "fsw/fdir/image_watch.h"

#include <array>
#include <cstdint>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::fdir {
namespace {

constexpr std::uint8_t kServicer = 1;
constexpr int kSide = 8;

class ImageWatchTest : public ::testing::Test {
 protected:
  /// An image of 8 bits and one tile whose pixels depend on `seed`.
  void take(int s, int seed, std::uint8_t unit = 0) {
    image_tile tile{};
    tile.image = image_++;
    tile.tiles = 1;
    tile.width = tile.height = kSide;
    tile.pixels = kSide * kSide;
    tile.bits = 8;
    for (int k = 0; k < kSide * kSide; ++k)
      tile.data[k] = static_cast<std::uint8_t>(seed == 0 ? 7 : (seed * 31 + k * k) % 251);
    inbox_->clear(at(s + 1));
    ASSERT_EQ(inbox_->receive(gnc::test::packet_of(at(s), tile, sequence_++, kServicer, unit)), Status::kOk);
  }
  /// The faults that the step raised.
  std::int32_t step(int s) {
    faults_.clear(at(s), ~0);
    faults_.forget_transitions();
    watch_.update(at(s), *inbox_, faults_);
    std::int32_t raised = 0;
    for (const faults::Transition& transition : faults_.transitions()) raised |= transition.fault;
    inbox_has_image_ = inbox_->image(0).has_image();
    inbox_->clear(at(s + 1000));
    return raised;
  }
  static GpsTime at(int s) { return GpsTime{} + duration_of_seconds(1000 + s); }

  std::unique_ptr<messaging::Inbox> inbox_ = std::make_unique<messaging::Inbox>(kServicer);
  faults::FaultMonitor faults_;
  ImageWatch watch_;
  bool inbox_has_image_ = false;
  std::int32_t image_ = 0;
  std::uint16_t sequence_ = 0;
};

TEST_F(ImageWatchTest, ImagesThatDifferAreKept) {
  for (int k = 0; k < 5; ++k) {
    take(20 * k, k + 1);
    EXPECT_EQ(step(20 * k), 0);
    EXPECT_TRUE(inbox_has_image_);
  }
}

TEST_F(ImageWatchTest, AnImageThatIsTheLastOneAgainIsDiscarded) {
  take(0, 1);
  EXPECT_EQ(step(0), 0);
  for (int k = 1; k < 4; ++k) {
    take(20 * k, 1);
    EXPECT_EQ(step(20 * k), telemetry_health::kFaultImageFrozen) << k;
    EXPECT_FALSE(inbox_has_image_);
  }
  take(80, 2);
  EXPECT_EQ(step(80), 0);
  EXPECT_TRUE(inbox_has_image_);
}

TEST_F(ImageWatchTest, AnImageWithoutVariationProvesNothing) {
  take(0, 0);
  step(0);
  take(20, 0);
  EXPECT_EQ(step(20), 0);
  EXPECT_TRUE(inbox_has_image_);
}

TEST_F(ImageWatchTest, SilenceIsReportedAfterThreePeriods) {
  take(0, 1);
  step(0);
  take(20, 2);
  EXPECT_EQ(step(20), 0);
  EXPECT_EQ(step(80), 0);
  EXPECT_EQ(step(81), telemetry_health::kFaultImagesMissing);
  take(100, 3);
  EXPECT_EQ(step(100), 0);
}

TEST_F(ImageWatchTest, BeforeTheSecondImageThereIsNoPeriod) {
  take(0, 1);
  step(0);
  EXPECT_EQ(step(5000), 0);
}

TEST_F(ImageWatchTest, CamerasAreWatchedByThemselves) {
  take(0, 1, 0);
  step(0);
  take(5, 1, 1);
  EXPECT_EQ(step(5), 0) << "the same image of another camera";
}

}  // namespace
}  // namespace vbar::fsw::fdir
