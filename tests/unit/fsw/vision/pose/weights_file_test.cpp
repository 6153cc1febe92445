#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/vision/pose/keypoint_network.h"
#include "tests/unit/fsw/vision/pose/network_file.h"

namespace {

using namespace vbar::fsw::pose;
using vbar::fsw::Status;
using vbar::test::WeightsFile;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The file with one number changed, and its checksum right.
template <class T>
WeightsFile changed(WeightsFile file, std::size_t offset, T value) {
  vbar::test::put(file, offset, value);
  vbar::test::seal(file);
  return file;
}

class WeightsFileCheck : public testing::Test {
 protected:
  static Status check_with_weight(float weight, int layer = 4) {
    return check_weights_file(changed(good_, vbar::test::place_of_weight(layer, 17), weight));
  }
  static Status check_with_calibration(std::size_t which, float value) {
    return check_weights_file(changed(good_, kCalibrationOffset + 4 * which, value));
  }

  static inline const WeightsFile good_ = vbar::test::random_file(1);
};

TEST_F(WeightsFileCheck, TakesAGoodFileAndTheOneOnBoard) {
  EXPECT_EQ(check_weights_file(good_), Status::kOk);
  EXPECT_EQ(check_weights_file(weights_on_board()), Status::kOk);
}

// Thirteen layers of kernel^2 x in x out weights and out biases, added up outside this program.
TEST_F(WeightsFileCheck, IsAsLongAsItsLayersAdded) {
  EXPECT_EQ(kFileBytes, 16U + 16U + 13U * 32U + 32U + 4U * (514'296U + 836U) + 4U);
}

TEST_F(WeightsFileCheck, CutShortAnywhereIsTooShort) {
  const std::span<const std::byte> whole(good_);
  for (const std::size_t bytes : {std::size_t{0}, kMagicBytes, kMagicBytes + 16, kCalibrationOffset, kFileBytes - 1}) {
    EXPECT_EQ(check_weights_file(whole.first(bytes)), Status::kTooShort) << bytes;
  }
  for (int layer = 0; layer <= kLayerCount; ++layer) {
    EXPECT_EQ(check_weights_file(whole.first(offset_of_layer(layer))), Status::kTooShort) << "before layer " << layer;
  }
}

TEST_F(WeightsFileCheck, OneByteMoreIsTooLong) {
  WeightsFile longer = good_;
  longer.push_back(std::byte{0});
  EXPECT_EQ(check_weights_file(longer), Status::kTooLong);
}

TEST_F(WeightsFileCheck, OtherArchitecturesAreOfTheWrongType) {
  EXPECT_EQ(check_weights_file(changed(good_, 0, 'V')), Status::kWrongType);
  for (std::size_t offset = kMagicBytes; offset < kCalibrationOffset; offset += 4) {
    std::uint32_t word;
    std::memcpy(&word, good_.data() + offset, sizeof word);
    EXPECT_EQ(check_weights_file(changed(good_, offset, word + 1)), Status::kWrongType) << offset;
  }
}

// Also where it is shorter or longer for it: what it is comes before how long it is.
TEST_F(WeightsFileCheck, ALargerArchitectureIsOfTheWrongTypeNotTooLong) {
  WeightsFile larger = changed(good_, kMagicBytes, std::uint32_t{14});
  larger.resize(larger.size() + 1000);
  EXPECT_EQ(check_weights_file(larger), Status::kWrongType);
}

TEST_F(WeightsFileCheck, AFlippedByteBreaksTheChecksum) {
  for (const std::size_t offset : {kCalibrationOffset, kHeaderBytes, kFileBytes / 2, kFileBytes - kChecksumBytes - 1,
                                   kFileBytes - kChecksumBytes, kFileBytes - 1}) {
    WeightsFile file = good_;
    file[offset] ^= std::byte{0x10};
    EXPECT_EQ(check_weights_file(file), Status::kBadChecksum) << offset;
  }
}

TEST_F(WeightsFileCheck, WeightsAreFinite) {
  EXPECT_EQ(check_with_weight(kNan), Status::kNotFinite);
  EXPECT_EQ(check_with_weight(-kInfinity), Status::kNotFinite);
  const std::size_t last = offset_of_layer(kLayerCount) - sizeof(float);
  EXPECT_EQ(check_weights_file(changed(good_, last, kNan)), Status::kNotFinite);
}

TEST_F(WeightsFileCheck, WeightsAreNothingOrInTheRangeThatKeepsDenormalNumbersOut) {
  for (const float good : {0.0F, -0.0F, 0x1p-40F, -0x1p-40F, 0x1.fffffep19F, -0x1.fffffep19F}) {
    EXPECT_EQ(check_with_weight(good), Status::kOk) << good;
  }
  for (const float bad :
       {1e-20F, -1e-20F, 0x1.fffffep-41F, 0x1p20F, -0x1p20F, 1e-42F, std::numeric_limits<float>::denorm_min()}) {
    EXPECT_EQ(check_with_weight(bad), Status::kOutOfRange) << bad;
    EXPECT_EQ(check_with_weight(bad, 0), Status::kOutOfRange) << bad;
    EXPECT_EQ(check_with_weight(bad, kLayerCount - 1), Status::kOutOfRange) << bad;
  }
}

TEST_F(WeightsFileCheck, CalibrationIsOneThatCanBe) {
  for (std::size_t which = 0; which < 4; ++which) {
    EXPECT_EQ(check_with_calibration(which, kNan), Status::kNotFinite) << which;
    EXPECT_EQ(check_with_calibration(which, kInfinity), Status::kNotFinite) << which;
    EXPECT_EQ(check_with_calibration(which, -0.1F), Status::kOutOfRange) << which;
  }
  EXPECT_EQ(check_with_calibration(0, 0.0F), Status::kOutOfRange);  // certain of every keypoint
  EXPECT_EQ(check_with_calibration(1, 0.0F), Status::kOk);
  EXPECT_EQ(check_with_calibration(2, 0.0F), Status::kOutOfRange);
  EXPECT_EQ(check_with_calibration(3, 1.1F), Status::kOutOfRange);  // a share of a map
  EXPECT_EQ(check_with_calibration(4, -0.1F), Status::kOk);
  EXPECT_EQ(check_with_calibration(4, 0.2F), Status::kOutOfRange);
  EXPECT_EQ(check_with_calibration(4, kNan), Status::kNotFinite);
}

}  // namespace
