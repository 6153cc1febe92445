// A bad line must be bad by the rate asked for, and the same way every time.

#include "pil_bridge/link_faults.h"

#include <bit>
#include <cmath>
#include <deque>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::pil {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Keeps what is written.
class Recorder final : public ByteChannel {
 public:
  explicit Recorder(Bytes& written) : written_(written) {}
  void write(std::span<const std::uint8_t> bytes, Clock::time_point /*deadline*/) override {
    written_.insert(written_.end(), bytes.begin(), bytes.end());
  }
  std::span<const std::uint8_t> read(Clock::time_point /*deadline*/) override { return {}; }
  [[nodiscard]] std::string description() const override { return "recorder"; }

 private:
  Bytes& written_;
};

class FrameRecorder final : public FrameTransport {
 public:
  explicit FrameRecorder(std::vector<Bytes>& frames) : frames_(frames) {}
  void send(std::span<const std::uint8_t> frame) override { frames_.emplace_back(frame.begin(), frame.end()); }
  std::span<const std::uint8_t> receive(Clock::time_point /*deadline*/) override { return {}; }
  [[nodiscard]] TransportCounters counters() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "recorder"; }

 private:
  std::vector<Bytes>& frames_;
};

Bytes through_bad_channel(const LinkFaults& faults, std::size_t count) {
  Bytes written;
  with_byte_faults(std::make_unique<Recorder>(written), faults)->write(Bytes(count, 0), Clock::now());
  return written;
}

/// Frames 0, 1, 2, ... of one distinct byte each, four times over.
std::vector<Bytes> through_bad_transport(const LinkFaults& faults, std::size_t count) {
  std::vector<Bytes> frames;
  const auto line = with_frame_faults(std::make_unique<FrameRecorder>(frames), faults);
  for (std::size_t i = 0; i < count; ++i) line->send(Bytes(4, static_cast<std::uint8_t>(i)));
  return frames;
}

constexpr std::size_t kBytes = 100000;
constexpr double kRate = 0.01;
// Binomial: 1000 expected, standard deviation sqrt(n p (1 - p)) = 31.5. Five of them; the seed is fixed, so it holds
// for good.
const double kFiveSigma = 5.0 * std::sqrt(static_cast<double>(kBytes) * kRate * (1.0 - kRate));

TEST(LinkFaults, FlipsSingleBitsAtTheRateAskedFor) {
  const Bytes bytes = through_bad_channel({.seed = 1, .flip_bit_per_byte = kRate}, kBytes);
  ASSERT_EQ(bytes.size(), kBytes);
  std::size_t flipped = 0;
  for (const std::uint8_t byte : bytes) {
    EXPECT_LE(std::popcount(byte), 1);
    flipped += byte != 0 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(flipped), kRate * static_cast<double>(kBytes), kFiveSigma);
}

TEST(LinkFaults, DropsBytesAtTheRateAskedFor) {
  const Bytes bytes = through_bad_channel({.seed = 1, .drop_byte_per_byte = kRate}, kBytes);
  EXPECT_NEAR(static_cast<double>(kBytes - bytes.size()), kRate * static_cast<double>(kBytes), kFiveSigma);
}

TEST(LinkFaults, TheSeedDecides) {
  const auto with_seed = [](std::uint64_t seed) {
    return through_bad_channel({.seed = seed, .flip_bit_per_byte = kRate, .drop_byte_per_byte = kRate}, kBytes);
  };
  EXPECT_EQ(with_seed(7), with_seed(7));
  EXPECT_NE(with_seed(7), with_seed(8));
}

TEST(LinkFaults, FramesAreDroppedRepeatedAndOvertaken) {
  EXPECT_TRUE(through_bad_transport({.drop_frame = 1.0}, 3).empty());
  EXPECT_EQ(through_bad_transport({.duplicate_frame = 1.0}, 2),
            (std::vector<Bytes>{Bytes(4, 0), Bytes(4, 0), Bytes(4, 1), Bytes(4, 1)}));
  EXPECT_EQ(through_bad_transport({.delay_frame = 1.0}, 4),
            (std::vector<Bytes>{Bytes(4, 1), Bytes(4, 0), Bytes(4, 3), Bytes(4, 2)}));
}

TEST(LinkFaults, AFlippedFrameDiffersByOneBit) {
  for (const Bytes& frame : through_bad_transport({.flip_bit_per_frame = 1.0}, 1)) {
    int ones = 0;
    for (const std::uint8_t byte : frame) ones += std::popcount(byte);
    EXPECT_EQ(ones, 1);
  }
}

TEST(LinkFaults, AStalledLineStandsStill) {
  const auto start = Clock::now();
  const LinkFaults faults{.stall_per_frame = 1.0, .stall = std::chrono::milliseconds(10)};
  EXPECT_EQ(through_bad_transport(faults, 3).size(), 3U);
  EXPECT_GE(Clock::now() - start, std::chrono::milliseconds(30));
}

}  // namespace
}  // namespace vbar::pil
