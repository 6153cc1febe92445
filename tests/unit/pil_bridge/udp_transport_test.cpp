#include <bit>
#include <cmath>
#include <deque>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/link/frame.h"
#include "host_sim/io/udp_socket.h"
#include "pil_bridge/link_faults.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {

namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using Bytes = std::vector<std::uint8_t>;

Clock::time_point soon() {
  return Clock::now() + std::chrono::seconds(10);
}

/// Two transports that are each other's peers.
struct Pair {
  Pair() {
    io::BoundUdpSocket a = io::bind_udp_loopback();
    io::BoundUdpSocket b = io::bind_udp_loopback();
    port = a.port;
    one = make_udp_transport(std::move(a.socket), "127.0.0.1", b.port);
    other = make_udp_transport(std::move(b.socket), "127.0.0.1", a.port);
  }
  std::uint16_t port = 0;  ///< of `one`
  std::unique_ptr<FrameTransport> one;
  std::unique_ptr<FrameTransport> other;
};

TEST(UdpTransport, CarriesOneFrameADatagram) {
  const Pair pair;
  const Bytes longest(fsw::link::kMaxFrameBytes, 0xA5);
  pair.one->send(Bytes{1, 2, 3});
  pair.one->send(longest);
  EXPECT_THAT(pair.other->receive(soon()), ElementsAre(1, 2, 3));
  EXPECT_THAT(pair.other->receive(soon()), ElementsAreArray(longest));
  EXPECT_EQ(pair.one->counters().bytes_sent, 3 + longest.size());
  EXPECT_EQ(pair.other->counters().bytes_received, 3 + longest.size());
}

TEST(UdpTransport, IgnoresAndCountsForeignDatagrams) {
  const Pair pair;
  const auto stranger = make_udp_transport("127.0.0.1", pair.port);
  stranger->send(Bytes{6, 6, 6});
  stranger->send(Bytes{6, 6, 6});
  pair.other->send(Bytes{7});
  EXPECT_THAT(pair.one->receive(soon()), ElementsAre(7));
  EXPECT_EQ(pair.one->counters().foreign_datagrams, 2U);
  EXPECT_EQ(pair.one->counters().bytes_received, 1U);
}

TEST(UdpTransport, RejectsAndCountsWhatCannotBeAFrame) {
  const Pair pair;
  pair.other->send(Bytes(fsw::link::kMaxFrameBytes + 1));
  pair.other->send(Bytes(3000));
  pair.other->send(Bytes{});
  pair.other->send(Bytes{7});
  EXPECT_THAT(pair.one->receive(soon()), ElementsAre(7));
  EXPECT_EQ(pair.one->counters().frames_rejected, 3U);
}

TEST(UdpTransport, ReceiveEndsAtItsDeadline) {
  const Pair pair;
  const auto deadline = Clock::now() + std::chrono::milliseconds(20);
  EXPECT_TRUE(pair.one->receive(deadline).empty());
  EXPECT_GE(Clock::now(), deadline);
}

TEST(UdpTransport, APeerThatIsNotThereYetIsNoError) {
  std::uint16_t free_port = io::bind_udp_loopback().port;
  const auto transport = make_udp_transport("127.0.0.1", free_port);
  for (int i = 0; i < 3; ++i) {
    transport->send(Bytes{1});
    EXPECT_TRUE(transport->receive(Clock::now() + std::chrono::milliseconds(5)).empty());
  }
}

TEST(UdpTransport, AnAddressThatIsNoneIsAnError) {
  EXPECT_THROW(make_udp_transport("localhost?", 5000), LinkError);
}

}  // namespace

// A bad line must be bad by the rate asked for, and the same way every time.

namespace {

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
