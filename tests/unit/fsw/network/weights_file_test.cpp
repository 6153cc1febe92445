#include "fsw/network/weights_file.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/fsw/network/network_file.h"

namespace {

using namespace vbar::fsw::network;
using vbar::fsw::Status;
using vbar::test::WeightsFile;

TEST(WeightsFile, CutShortAnywhereIsTooShort) {
  const WeightsFile whole = vbar::test::random_file(1);
  ASSERT_EQ(check_weights_file(whole), Status::kOk);
  EXPECT_EQ(check_weights_file({}), Status::kTooShort);
  EXPECT_EQ(check_weights_file(std::span(whole).first(kMagicBytes)), Status::kTooShort);
  EXPECT_EQ(check_weights_file(std::span(whole).first(kCalibrationOffset)), Status::kTooShort);
  for (int layer = 0; layer <= kLayerCount; ++layer) {
    EXPECT_EQ(check_weights_file(std::span(whole).first(offset_of_layer(layer))), Status::kTooShort) << layer;
  }
  EXPECT_EQ(check_weights_file(std::span(whole).first(kFileBytes - 1)), Status::kTooShort);
}

}  // namespace
