#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "emulators/grand/generator/edge_broadcaster.h"
#include "hil_drivers/grand/pps/edge_source.h"
#include "hil_drivers/grand/pps/time_base.h"
#include "hil_drivers/grand/wire/pps_datagram.h"
#include "host_sim/io/file_descriptor.h"

namespace vbar::grand {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr Clock::time_point kAtOnce{};

class SocketEdgesTest : public testing::Test {
 protected:
  SocketEdgesTest() {
    char name[] = "/tmp/vbar_pps_XXXXXX";
    if (::mkdtemp(name) == nullptr) throw std::runtime_error("mkdtemp");
    folder_ = name;
    path = (folder_ / "pps.sock").string();
  }
  ~SocketEdgesTest() override { std::filesystem::remove_all(folder_); }

  static wire::PpsDatagram datagram(std::int64_t k) {
    return {fsw::GpsTime{} + fsw::duration_of_seconds(1000 + k), 2'000'000'000 + k, static_cast<std::uint32_t>(k)};
  }
  [[nodiscard]] std::unique_ptr<EdgeSource> open() const { return make_edge_source("socket:" + path); }

  std::string path;

 private:
  std::filesystem::path folder_;
};

TEST_F(SocketEdgesTest, DeliversEdgesInOrder) {
  EdgeBroadcaster broadcaster(path);
  const auto source = open();
  EXPECT_FALSE(source->next(kAtOnce));  // subscribes
  broadcaster.send(datagram(1));
  broadcaster.send(datagram(2));
  EXPECT_EQ(broadcaster.subscribers(), 1U);
  for (const int k : {1, 2}) {
    const auto edge = source->next(kAtOnce);
    ASSERT_TRUE(edge);
    EXPECT_EQ(edge->gps, datagram(k).gps);
    EXPECT_EQ(edge->monotonic.count(), datagram(k).monotonic_ns);
    EXPECT_EQ(edge->count, static_cast<std::uint32_t>(k));
  }
  const auto begin = Clock::now();
  EXPECT_FALSE(source->next(begin + 30ms));
  EXPECT_GE(Clock::now() - begin, 30ms);
}

TEST_F(SocketEdgesTest, SubscribesAgainToASenderThatWasStartedLater) {
  const auto source = open();
  EXPECT_FALSE(source->next(kAtOnce));  // without a sender
  for (const int run : {1, 2}) {
    EdgeBroadcaster broadcaster(path);
    std::optional<Edge> edge;
    for (int k = 0; k < 80 && !edge; ++k) {
      edge = source->next(Clock::now() + 50ms);
      if (!edge) broadcaster.send(datagram(run));
    }
    ASSERT_TRUE(edge) << "run " << run;
    EXPECT_EQ(edge->count, static_cast<std::uint32_t>(run));
  }
}

TEST_F(SocketEdgesTest, FaultsOfTheSender) {
  EdgeBroadcaster broadcaster(path);
  const auto source = open();
  EXPECT_FALSE(source->next(kAtOnce));
  broadcaster.miss(2);
  broadcaster.send(datagram(1));
  broadcaster.send(datagram(2));
  broadcaster.repeat(1);
  broadcaster.send(datagram(3));
  broadcaster.jump(fsw::duration_of_seconds(-1));
  broadcaster.send(datagram(4));
  broadcaster.delay(fsw::Duration{2'000'000});
  broadcaster.send(datagram(5));
  broadcaster.send(datagram(6));
  std::vector<Edge> edges;
  while (const auto edge = source->next(kAtOnce)) edges.push_back(*edge);
  ASSERT_EQ(edges.size(), 5U);
  EXPECT_EQ(edges[0].count, 3U);
  EXPECT_EQ(edges[1].count, 3U);
  EXPECT_EQ(edges[2].gps, datagram(3).gps);
  EXPECT_EQ(edges[3].monotonic.count(), datagram(5).monotonic_ns + 2'000'000);
  EXPECT_EQ(edges[4].monotonic.count(), datagram(6).monotonic_ns);
}

TEST_F(SocketEdgesTest, ASubscriberThatHasEndedIsForgotten) {
  EdgeBroadcaster broadcaster(path);
  {
    const auto source = open();
    EXPECT_FALSE(source->next(kAtOnce));
    broadcaster.send(datagram(1));
    EXPECT_EQ(broadcaster.subscribers(), 1U);
  }
  broadcaster.send(datagram(2));
  EXPECT_EQ(broadcaster.subscribers(), 0U);
}

TEST_F(SocketEdgesTest, AFullQueueLosesEdgesAndDoesNotHoldTheSender) {
  EdgeBroadcaster broadcaster(path);
  const auto source = open();
  EXPECT_FALSE(source->next(kAtOnce));
  for (int k = 0; k < 5000; ++k) broadcaster.send(datagram(k));
  EXPECT_EQ(broadcaster.subscribers(), 1U);
  const auto edge = source->next(kAtOnce);
  ASSERT_TRUE(edge);
  EXPECT_EQ(edge->count, 0U);
}

/// A sender of whatever it likes.
class RawSender {
 public:
  explicit RawSender(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    if (::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("bind");
  }
  /// Waits for a subscription.
  void accept() {
    std::array<char, 8> request{};
    size_ = sizeof subscriber_;
    if (::recvfrom(socket_.get(), request.data(), request.size(), 0, reinterpret_cast<sockaddr*>(&subscriber_),
                   &size_) != 1)
      throw std::runtime_error("subscription");
  }
  void send(std::span<const std::uint8_t> bytes) { send_from(socket_.get(), bytes); }
  /// From another socket than the one subscribed to.
  void forge(std::span<const std::uint8_t> bytes) {
    const io::FileDescriptor other(::socket(AF_UNIX, SOCK_DGRAM, 0));
    send_from(other.get(), bytes);
  }

 private:
  void send_from(int socket, std::span<const std::uint8_t> bytes) {
    (void)!::sendto(socket, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&subscriber_), size_);
  }
  io::FileDescriptor socket_;
  sockaddr_un subscriber_{};
  socklen_t size_ = 0;
};

TEST_F(SocketEdgesTest, HostileDatagramsAreCountedAndSkipped) {
  RawSender sender(path);
  const auto source = open();
  EXPECT_FALSE(source->next(kAtOnce));
  sender.accept();
  const auto good = wire::encode_pps_datagram(datagram(9));
  std::vector<std::uint8_t> longer(good.begin(), good.end());
  longer.resize(4000);
  auto negative = good;
  negative[7] = 0x80;
  sender.send({});
  sender.send(std::span(good).first(19));
  sender.send(longer);
  sender.send(negative);
  sender.forge(good);
  sender.send(good);
  const auto edge = source->next(Clock::now() + 1s);
  ASSERT_TRUE(edge);
  EXPECT_EQ(edge->count, 9U);
  EXPECT_EQ(source->malformed(), 4U);
  EXPECT_FALSE(source->next(kAtOnce)) << "an edge of a foreign sender was accepted";
}

TEST_F(SocketEdgesTest, ReplacesTheSocketThatADeadProgramLeft) {
  { const RawSender dead(path); }
  EXPECT_TRUE(std::filesystem::exists(path));
  EXPECT_NO_THROW(EdgeBroadcaster{path});
  EXPECT_FALSE(std::filesystem::exists(path));
  const EdgeBroadcaster alive(path);
  EXPECT_THROW(EdgeBroadcaster{path}, std::runtime_error);
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST(EdgeSources, AreNamedWithTheirDevice) {
  for (const char* text : {"kernel:/dev/pps0", "socket:/run/a:b.sock", "timer"})
    EXPECT_NE(find_edge_source(text), nullptr) << text;
  for (const char* text : {"", "kernel", "kernel:", "timer:x", "sundial", "Timer", ":x"})
    EXPECT_EQ(find_edge_source(text), nullptr) << text;
  EXPECT_THROW((void)make_edge_source("kernel"), std::runtime_error);
  EXPECT_THROW((void)make_edge_source("socket:" + std::string(200, 'x')), std::runtime_error);
  EXPECT_EQ(edge_source_forms(), R"("kernel:DEVICE", "socket:PATH", "timer")");
}

TEST(EdgeSources, TheTimerTicksEverySecondOfTheHost) {
  const auto timer = make_edge_source("timer");
  const auto first = timer->next(Clock::now());
  ASSERT_TRUE(first);
  EXPECT_FALSE(timer->next(Clock::now() + 10ms));
  const auto second = timer->next(Clock::now() + 5s);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->monotonic - first->monotonic, 1s);
  EXPECT_EQ(second->count, first->count + 1);
}

template <class T>
T field(std::span<const std::uint8_t> bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// struct sock_sample of chrony's refclock_sock.c on a 64-bit computer: timeval, double, four ints.
TEST(ChronySample, HasTheLayoutOfChronysOwnStructure) {
  const auto bytes = chrony_sample(1'700'000'000s + 250'999ns);
  EXPECT_EQ(field<std::int64_t>(bytes, 0), 1'700'000'000);
  EXPECT_EQ(field<std::int64_t>(bytes, 8), 250);
  EXPECT_NEAR(field<double>(bytes, 16), -250.999e-6, 1e-12);
  EXPECT_EQ(field<std::int32_t>(bytes, 24), 0);
  EXPECT_EQ(field<std::int32_t>(bytes, 28), 0);
  EXPECT_EQ(field<std::int32_t>(bytes, 36), 0x534F434B);
}

TEST(ChronySample, TheNearestSecondCounts) {
  const auto bytes = chrony_sample(1'700'000'000s - 1ms);
  EXPECT_EQ(field<std::int64_t>(bytes, 0), 1'699'999'999);
  EXPECT_EQ(field<std::int64_t>(bytes, 8), 999'000);
  EXPECT_NEAR(field<double>(bytes, 16), 1e-3, 1e-12);
}

TEST(ChronyOutput, WithoutAConsumerNothingHappens) {
  ChronyOutput output("/tmp/vbar_no_chronyd_here.sock");
  output.forward({std::nullopt, std::chrono::steady_clock::now().time_since_epoch(), 1});
  EXPECT_EQ(output.sent(), 0U);
  EXPECT_THROW(ChronyOutput(std::string(200, 'x')), std::runtime_error);
}

}  // namespace

}  // namespace vbar::grand

namespace vbar::grand::wire {

namespace {

// i64, i64, u32, little-endian, written out by hand.
constexpr std::array<std::uint8_t, 20> kBytes = {0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01, 0x18, 0x17,
                                                 0x16, 0x15, 0x14, 0x13, 0x12, 0x11, 0xEF, 0xBE, 0xAD, 0xDE};
constexpr PpsDatagram kDatagram{{0x0102030405060708}, 0x1112131415161718, 0xDEADBEEF};

TEST(PpsDatagram, HasTheLayoutOfTheTable) {
  EXPECT_EQ(encode_pps_datagram(kDatagram), kBytes);
  EXPECT_EQ(decode_pps_datagram(kBytes), kDatagram);
}

TEST(PpsDatagram, OtherLengthsAreRefused) {
  std::vector<std::uint8_t> bytes(kBytes.begin(), kBytes.end());
  bytes.push_back(0);
  EXPECT_FALSE(decode_pps_datagram(bytes));
  for (bytes.resize(19);; bytes.pop_back()) {
    EXPECT_FALSE(decode_pps_datagram(bytes));
    if (bytes.empty()) break;
  }
}

TEST(PpsDatagram, TimesOutsideTheLimitsAreRefused) {
  for (const std::size_t last_byte : {7U, 15U})
    for (const std::uint8_t value : {std::uint8_t{0x40}, std::uint8_t{0x80}, std::uint8_t{0xFF}}) {
      auto bytes = kBytes;
      bytes[last_byte] = value;
      EXPECT_FALSE(decode_pps_datagram(bytes));
    }
  auto largest = kBytes;
  for (const std::size_t first : {0U, 8U}) {
    std::fill_n(largest.begin() + static_cast<std::ptrdiff_t>(first), 7, std::uint8_t{0xFF});
    largest[first + 7] = 0x3F;
  }
  ASSERT_TRUE(decode_pps_datagram(largest));
  EXPECT_EQ(decode_pps_datagram(largest)->gps.ns, kPpsTimeLimit_ns - 1);
}

}  // namespace

}  // namespace vbar::grand::wire
