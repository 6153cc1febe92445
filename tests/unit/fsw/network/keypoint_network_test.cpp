#include "fsw/network/keypoint_network.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/unit/fsw/network/network_file.h"
#include "tests/unit/fsw/network/plain_network.h"

namespace {

using namespace vbar::fsw::network;
using vbar::fsw::Status;
using vbar::test::Crop;

/// Largest difference of the logits from the definition's, over the largest logit.
double relative_difference(const KeypointNetwork& network, vbar::test::PlainMap maps) {
  vbar::accuracy::Largest largest;
  vbar::accuracy::Largest difference;
  for (int k = 0; k < kKeypoints; ++k) {
    const auto logits = network.logits(k);
    for (int cell = 0; cell < kMapSide * kMapSide; ++cell) {
      const double expected = maps.at(cell / kMapSide, cell % kMapSide, k);
      largest.add(std::abs(expected));
      difference.add(std::abs(static_cast<double>(logits[static_cast<std::size_t>(cell)]) - expected));
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

TEST(KeypointNetwork, DoesNotRunWithoutWeights) {
  const auto network = std::make_unique<KeypointNetwork>();
  EXPECT_FALSE(network->is_loaded());
  EXPECT_EQ(network->run(vbar::test::random_crop(1)), Status::kNotReady);
  ASSERT_EQ(network->load(weights_on_board()), Status::kOk);
  EXPECT_TRUE(network->is_loaded());
  EXPECT_EQ(network->run(vbar::test::random_crop(1)), Status::kOk);
  // A file that is refused leaves none, not the one before.
  EXPECT_EQ(network->load(weights_on_board().first(1000)), Status::kTooShort);
  EXPECT_FALSE(network->is_loaded());
  EXPECT_EQ(network->run(vbar::test::random_crop(1)), Status::kNotReady);
}

TEST(KeypointNetwork, TellsTheCalibrationOfItsFile) {
  const vbar::test::WeightsFile file = vbar::test::blank_file();
  const auto network = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(network->load(file), Status::kOk);
  EXPECT_EQ(network->calibration().covariance_scale, 1.25F);
  EXPECT_EQ(network->calibration().covariance_floor, 0.0625F);
  EXPECT_EQ(network->calibration().target_sigma_cells, 1.5F);
  EXPECT_EQ(network->calibration().least_peak, 0.125F);
  EXPECT_EQ(network->calibration().stretch, 0.03125F);
}

TEST(KeypointNetwork, RefusesSamplesThatAreNoNumbers) {
  const auto network = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(network->load(weights_on_board()), Status::kOk);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -0x1.1p20F}) {
    Crop crop = vbar::test::random_crop(1);
    crop[12345] = bad;
    EXPECT_EQ(network->run(crop), Status::kNotFinite) << bad;
  }
}

TEST(KeypointNetwork, RefusesMapsThatAreNoNumbers) {
  // The largest weights there can be: after a few layers, numbers are infinite.
  const vbar::test::WeightsFile file = vbar::test::file_of([](const Layer&, std::size_t) { return 0x1.8p19; });
  const auto network = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(network->load(file), Status::kOk);
  EXPECT_EQ(network->run(vbar::test::structured_crop()), Status::kNotFinite);
}

TEST(KeypointNetwork, LeavesNothingBehindFromRunToRun) {
  const vbar::test::WeightsFile file = vbar::test::random_file(5);
  const auto used = std::make_unique<KeypointNetwork>();
  const auto fresh = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(used->load(file), Status::kOk);
  ASSERT_EQ(fresh->load(file), Status::kOk);
  ASSERT_EQ(used->run(vbar::test::random_crop(6)), Status::kOk);
  ASSERT_EQ(used->run(vbar::test::structured_crop()), Status::kOk);
  ASSERT_EQ(fresh->run(vbar::test::structured_crop()), Status::kOk);
  for (int k = 0; k < kKeypoints; ++k) {
    EXPECT_EQ(std::memcmp(used->logits(k).data(), fresh->logits(k).data(), sizeof(float) * kMapCells), 0) << k;
  }
}

// A file may lie anywhere in memory, also at an odd address.
TEST(KeypointNetwork, TakesWeightsFromAnyAddress) {
  const vbar::test::WeightsFile file = vbar::test::random_file(5);
  vbar::test::WeightsFile moved(1);
  moved.insert(moved.end(), file.begin(), file.end());
  const auto one = std::make_unique<KeypointNetwork>();
  const auto other = std::make_unique<KeypointNetwork>();
  ASSERT_EQ(one->load(file), Status::kOk);
  ASSERT_EQ(other->load(std::span(moved).subspan(1)), Status::kOk);
  ASSERT_EQ(one->run(vbar::test::structured_crop()), Status::kOk);
  ASSERT_EQ(other->run(vbar::test::structured_crop()), Status::kOk);
  EXPECT_EQ(std::memcmp(one->logits(0).data(), other->logits(0).data(), sizeof(float) * kMapCells), 0);
}

// The room that it takes in the flight software's state.
static_assert(sizeof(KeypointNetwork) < 2'000'000);

}  // namespace
