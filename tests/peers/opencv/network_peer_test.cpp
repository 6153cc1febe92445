// The keypoint network against OpenCV's dnn, put together layer by layer from the same weights file.

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "fsw/vision/pose/keypoint_network.h"
#include "tests/unit/fsw/vision/pose/network_file.h"
#ifdef VBAR_HAVE_OPENCV
#include "tests/support/figures.h"
#include "tests/support/opencv_network.h"
#endif

namespace {

TEST(KeypointNetworkPeer, OpencvGivesTheSameMaps) {
#ifndef VBAR_HAVE_OPENCV
  GTEST_SKIP() << "OpenCV's dnn is not installed";
#else
  using namespace vbar::fsw::pose;
  cv::setNumThreads(1);
  const vbar::test::WeightsFile file = vbar::test::random_file(3);
  const auto network = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(network->load(file), vbar::fsw::Status::kOk);
  vbar::test::OpencvNetwork opencv(file);
  for (const vbar::test::Crop& crop : {vbar::test::random_crop(4), vbar::test::structured_crop()}) {
    ASSERT_EQ(network->run(crop), vbar::fsw::Status::kOk);
    const cv::Mat maps = opencv.run(crop);
    ASSERT_EQ(maps.size[1], kMapChannels);
    vbar::accuracy::Largest largest, difference;
    for (int k = 0; k < kKeypoints; ++k) {
      const std::span<const float> logits = network->logits(k);
      for (std::size_t cell = 0; cell < kMapCells; ++cell) {
        const float expected = maps.ptr<float>(0, k)[cell];
        largest.add(std::abs(expected));
        difference.add(std::abs(logits[cell] - expected));
      }
    }
    // Both round to single precision, in different orders: some 1e-6 (keypoint_network_test.cpp).
    EXPECT_LT(difference, 1e-5 * largest);
  }
#endif
}

}  // namespace
