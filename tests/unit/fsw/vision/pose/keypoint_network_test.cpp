#include "fsw/vision/pose/keypoint_network.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/vision/pose/architecture.h"
#include "fsw/vision/pose/convolution.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/vision/pose/network_file.h"
#include "tests/unit/fsw/vision/pose/plain_network.h"

namespace {

using namespace vbar::fsw::pose;
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

// The sums of wide registers are those of four lanes, bit by bit; what four lanes give is compared with the definition
// in keypoint_network_test.cpp, and with other targets in tests/unit/fsw/same_bits.

namespace {

std::vector<Registers> wide_registers_of_this_computer() {
  std::vector<Registers> found;
  for (const Registers registers : {Registers::kEight, Registers::kSixteen})
    if (registers <= widest_registers()) found.push_back(registers);
  return found;
}

/// A map in memory that ends where the map does, so that a sanitizer sees what is read behind it.
struct OwnedMap {
  FeatureMap map;
  std::vector<float> numbers;

  OwnedMap(int side, int channels) : numbers(static_cast<std::size_t>((side + 2) * (side + 2) * channels)) {
    map = {.numbers = numbers.data(), .side = side, .channels = channels};
  }
  void fill(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> sample;
    for (int row = 0; row < map.side; ++row)
      for (int k = 0; k < map.side * map.channels; ++k) map.cell(row, 0)[k] = sample(random);
  }
};

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(Convolution, WideRegistersGiveTheBitsOfFourLanes) {
  const std::vector<Registers> wide = wide_registers_of_this_computer();
  if (wide.empty()) GTEST_SKIP() << "this computer has registers of four numbers only";
  const vbar::test::WeightsFile file = vbar::test::random_file(3);
  const auto panel = std::make_unique<WeightPanel>();
  int side = kInputSide;
  for (int l = 0; l < kLayerCount; ++l) {
    const Layer& layer = kLayers[static_cast<std::size_t>(l)];
    const auto weights = std::span<const std::byte>(file).subspan(offset_of_layer(l), layer.bytes());
    OwnedMap in(side, layer.in);
    in.fill(static_cast<unsigned>(l));
    side /= layer.stride;
    const bool is_last = l == kLayerCount - 1;
    const auto convolved = [&](Registers registers) {
      if (is_last) {
        std::vector<std::array<float, kMapCells>> maps(kKeypoints);
        convolve_to_maps(layer, weights, in.map, maps, *panel, registers);
        const float* const first = maps[0].data();
        return std::vector<float>(first, first + kKeypoints * kMapCells);
      }
      OwnedMap out(layer.is_rectified ? side : 2 * side, layer.out);
      out.fill(77);
      if (layer.is_rectified)
        convolve_rectified(layer, weights, in.map, out.map, *panel, registers);
      else
        convolve_and_add_enlarged(layer, weights, in.map, out.map, *panel, registers);
      return out.numbers;
    };
    const std::vector<float> expected = convolved(Registers::kFour);
    for (const Registers registers : wide)
      EXPECT_TRUE(same_bits(convolved(registers), expected))
          << "layer " << l << ", registers of " << static_cast<int>(registers);
    if (!layer.is_rectified) side *= 2;
  }
}

}  // namespace

// No denormal number arises in the network, whatever its weights and its crop (architecture.h). The x86 processor keeps
// account of that: a denormal operand or an underflow sets a flag that stays set.

#if defined(__SSE2__)
#include <immintrin.h>

namespace {

/// What was noted since the flags were cleared.
unsigned denormals_noted() {
  constexpr unsigned kDenormalOperand = 0x02;
  constexpr unsigned kUnderflow = 0x10;
  return _mm_getcsr() & (kDenormalOperand | kUnderflow);
}

void clear_flags() {
  _mm_setcsr(_mm_getcsr() & ~0x3FU);
}

/// How many logits have a size between the two, of all.
double share_of_logits(const KeypointNetwork& network, float above, float below) {
  std::size_t count = 0;
  for (int k = 0; k < kKeypoints; ++k) {
    for (const float logit : network.logits(k)) count += std::abs(logit) > above && std::abs(logit) < below;
  }
  return static_cast<double>(count) / static_cast<double>(kKeypoints * kMapCells);
}

TEST(Denormals, TheProcessorNotesThem) {
  clear_flags();
  volatile float small = 0x1p-80F;
  volatile float product = small * small;
  EXPECT_NE(denormals_noted(), 0U) << product;
}

TEST(Denormals, DoNotAriseFromTheSmallestWeightsAndSamples) {
  const auto network = std::make_unique<KeypointNetwork>();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const vbar::test::WeightsFile file = vbar::test::tiny_file(seed);
    ASSERT_EQ(network->load(file), vbar::fsw::Status::kOk);
    // Denormal samples are put aside by a comparison, which the processor notes as well: they are not looked at here.
    auto crop = vbar::test::tiny_crop(seed);
    for (float& sample : crop) {
      if (!(sample > kMinActivation || sample < -kMinActivation)) sample = 0.0F;
    }
    clear_flags();
    ASSERT_EQ(network->run(crop), vbar::fsw::Status::kOk);
    EXPECT_EQ(denormals_noted(), 0U);
    EXPECT_GT(share_of_logits(*network, 0.0F, 0x1p-40F), 0.05);  // small numbers did come through
  }
}

// As NEON does: denormal operands are taken for 0, denormal results become 0.
TEST(Denormals, FlushingThemChangesNothing) {
  const auto plain = std::make_unique<KeypointNetwork>();
  const auto flushed = std::make_unique<KeypointNetwork>();
  const vbar::test::WeightsFile file = vbar::test::tiny_file(4);
  const auto crop = vbar::test::tiny_crop(4);
  ASSERT_EQ(plain->load(file), vbar::fsw::Status::kOk);
  ASSERT_EQ(flushed->load(file), vbar::fsw::Status::kOk);
  ASSERT_EQ(plain->run(crop), vbar::fsw::Status::kOk);
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040U);  // flush to zero, denormals are zeros
  const auto status = flushed->run(crop);
  _mm_setcsr(before);
  ASSERT_EQ(status, vbar::fsw::Status::kOk);
  for (int k = 0; k < kKeypoints; ++k) {
    EXPECT_EQ(std::memcmp(plain->logits(k).data(), flushed->logits(k).data(), sizeof(float) * kMapCells), 0) << k;
  }
}

}  // namespace

#endif
