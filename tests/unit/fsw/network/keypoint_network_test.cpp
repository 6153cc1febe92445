#include "fsw/network/keypoint_network.h"

#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/fsw/network/network_file.h"
#include "tests/unit/fsw/network/plain_network.h"

namespace {

using namespace vbar::fsw::network;
using vbar::fsw::Status;
using vbar::test::Crop;

/// Largest difference of the logits from the definition's, over the largest logit.
double relative_difference(const KeypointNetwork& network, vbar::test::PlainMap maps) {
  double largest = 0.0;
  double difference = 0.0;
  for (int k = 0; k < kKeypoints; ++k) {
    const auto logits = network.logits(k);
    for (int cell = 0; cell < kMapSide * kMapSide; ++cell) {
      const double expected = maps.at(cell / kMapSide, cell % kMapSide, k);
      largest = std::max(largest, std::abs(expected));
      difference =
          std::max(difference, std::abs(static_cast<double>(logits[static_cast<std::size_t>(cell)]) - expected));
    }
  }
  return difference / largest;
}

// Thirteen layers of single-precision sums of up to 1152 products: each rounds to 6e-8 of the running sum, at random,
// so some sqrt(1152) of that a layer: 2e-6. A product in the wrong place is off by a hundredth and more.
constexpr double kRoundingOfTheNetwork = 1e-5;

TEST(KeypointNetwork, GivesWhatItsDefinitionGivesInDoublePrecision) {
  const vbar::test::WeightsFile file = vbar::test::random_file(1);
  const auto network = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(network->load(file), Status::kOk);
  const vbar::test::PlainNetwork plain(file);
  for (const Crop& crop : {vbar::test::random_crop(2), vbar::test::structured_crop()}) {
    ASSERT_EQ(network->run(crop), Status::kOk);
    const double difference = relative_difference(*network, plain.run(crop));
    EXPECT_LT(difference, kRoundingOfTheNetwork);
    RecordProperty("relative_difference", std::to_string(difference));
  }
}

TEST(KeypointNetwork, WeightsOnBoardGiveWhatTheirDefinitionGives) {
  const auto network = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(network->load(weights_on_board()), Status::kOk);
  const Crop crop = vbar::test::structured_crop();
  ASSERT_EQ(network->run(crop), Status::kOk);
  EXPECT_LT(relative_difference(*network, vbar::test::PlainNetwork(weights_on_board()).run(crop)),
            kRoundingOfTheNetwork);
}

}  // namespace
