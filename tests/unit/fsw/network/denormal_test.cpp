// No denormal number arises in the network, whatever its weights and its crop (number_range.h). The x86 processor keeps
// account of that: a denormal operand or an underflow sets a flag that stays set.

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "fsw/network/keypoint_network.h"
#include "fsw/network/number_range.h"
#include "tests/unit/fsw/network/tiny_numbers.h"

#if defined(__SSE2__)
#include <immintrin.h>

namespace {

using namespace vbar::fsw::network;

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
