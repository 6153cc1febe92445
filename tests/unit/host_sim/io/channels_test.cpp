// Every byte channel against a plain descriptor at its other end.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include "host_sim/io/byte_channel.h"
#include "host_sim/io/serial_line.h"
#include "host_sim/io/udp_socket.h"

namespace vbar::io {

namespace {

using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;

Clock::time_point soon() {
  return Clock::now() + std::chrono::seconds(10);
}

/// Every byte value, among them those a cooked terminal would act on (3, 10, 13, 17, 19, 26, 127).
Bytes all_bytes() {
  Bytes bytes(256);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

Bytes read_exactly(ByteChannel& channel, std::size_t count) {
  Bytes bytes;
  while (bytes.size() < count) {
    const auto more = channel.read(soon());
    if (more.empty()) break;
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return bytes;
}

Bytes read_exactly(int fd, std::size_t count) {
  Bytes bytes(count);
  std::size_t held = 0;
  while (held < count) {
    const ssize_t got = ::read(fd, bytes.data() + held, count - held);
    if (got <= 0) break;
    held += static_cast<std::size_t>(got);
  }
  bytes.resize(held);
  return bytes;
}

void expect_bytes_pass_both_ways(ByteChannel& channel, int other_end) {
  const Bytes bytes = all_bytes();
  channel.write(bytes, soon());
  EXPECT_EQ(read_exactly(other_end, bytes.size()), bytes);
  ASSERT_EQ(::write(other_end, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  EXPECT_EQ(read_exactly(channel, bytes.size()), bytes);
}

TEST(ByteChannels, SocketPair) {
  auto [ours, theirs] = make_socket_pair();
  const auto channel = adopt_socket(std::move(ours), "pair");
  expect_bytes_pass_both_ways(*channel, theirs.get());
}

TEST(ByteChannels, PseudoTerminalIsTransparentToEveryByte) {
  Pty pty = make_pty();
  const auto channel = adopt_pty(std::move(pty.master), "pty");
  expect_bytes_pass_both_ways(*channel, pty.slave.get());
}

// A pseudo-terminal's slave is a serial device as far as the system's terminal interface goes.
TEST(ByteChannels, SerialDeviceIsTransparentToEveryByte) {
  const Pty pty = make_pty();
  const auto channel = open_serial(pty.slave_path, 115200);
  expect_bytes_pass_both_ways(*channel, pty.master.get());
}

TEST(ByteChannels, UnixSocketWaitsForTheListener) {
  const auto path = std::filesystem::temp_directory_path() / ("vbar_unix_test_" + std::to_string(::getpid()));
  int accepted = -1;
  std::thread listener([&] {
    std::this_thread::sleep_for(milliseconds(50));
    const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof address.sun_path - 1);
    ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
    ::listen(socket.get(), 1);
    accepted = ::accept(socket.get(), nullptr, nullptr);
  });
  const auto channel = connect_unix(path.string(), soon());
  listener.join();
  const FileDescriptor other_end(accepted);
  std::filesystem::remove(path);
  expect_bytes_pass_both_ways(*channel, other_end.get());
}

TEST(ByteChannels, TcpSocket) {
  const FileDescriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  ASSERT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(socket.get(), 1), 0);
  ASSERT_EQ(::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &length), 0);
  const auto channel = connect_tcp("127.0.0.1", std::to_string(ntohs(address.sin_port)), soon());
  const FileDescriptor other_end(::accept(socket.get(), nullptr, nullptr));
  expect_bytes_pass_both_ways(*channel, other_end.get());
}

TEST(ByteChannels, NobodyListeningIsAnErrorAtTheDeadline) {
  EXPECT_THROW(connect_unix("/nowhere/socket", Clock::now() + milliseconds(20)), ChannelError);
  EXPECT_THROW(open_serial("/nowhere/tty", 115200), ChannelError);
}

TEST(ByteChannels, ReadEndsAtItsDeadline) {
  auto [ours, theirs] = make_socket_pair();
  const auto channel = adopt_socket(std::move(ours), "pair");
  const auto deadline = Clock::now() + milliseconds(20);
  EXPECT_TRUE(channel->read(deadline).empty());
  EXPECT_GE(Clock::now(), deadline);
}

TEST(ByteChannels, WhatHasArrivedIsReadEvenAfterTheDeadline) {
  auto [ours, theirs] = make_socket_pair();
  const auto channel = adopt_socket(std::move(ours), "pair");
  ASSERT_EQ(::write(theirs.get(), "late", 4), 4);
  EXPECT_EQ(channel->read(Clock::now() - milliseconds(1)).size(), 4U);
}

TEST(ByteChannels, AClosedLineIsAnErrorAfterItsLastBytes) {
  auto [ours, theirs] = make_socket_pair();
  const auto channel = adopt_socket(std::move(ours), "pair");
  ASSERT_EQ(::write(theirs.get(), "last", 4), 4);
  theirs.reset();
  EXPECT_EQ(channel->read(soon()).size(), 4U);
  EXPECT_THROW((void)channel->read(soon()), ChannelError);
  EXPECT_THROW(channel->write(all_bytes(), soon()), ChannelError);
}

TEST(ByteChannels, AHungUpTerminalIsAnError) {
  Pty pty = make_pty();
  const auto channel = adopt_pty(std::move(pty.master), "pty");
  pty.slave.reset();
  EXPECT_THROW((void)channel->read(soon()), ChannelError);
}

TEST(ByteChannels, ALineThatTakesNoMoreBytesIsAnErrorAtTheDeadline) {
  auto [ours, theirs] = make_socket_pair();
  const auto channel = adopt_socket(std::move(ours), "pair");
  const Bytes more_than_any_socket_buffer(64U << 20U);
  EXPECT_THROW(channel->write(more_than_any_socket_buffer, Clock::now() + milliseconds(50)), ChannelError);
  // The read that went on beside the write still works.
  ASSERT_EQ(::write(theirs.get(), "x", 1), 1);
  EXPECT_EQ(channel->read(soon()).size(), 1U);
}

// Both ends write more than the buffers between them hold before either reads: each must read while it writes.
TEST(ByteChannels, TwoWritersDoNotWaitForEachOther) {
  constexpr std::size_t kMuch = 4U << 20U;
  auto [ours, theirs] = make_socket_pair();
  const auto one = adopt_socket(std::move(ours), "one");
  const auto other = adopt_socket(std::move(theirs), "other");
  const Bytes bytes(kMuch, 0x55);
  std::thread writer([&] {
    other->write(bytes, soon());
    EXPECT_EQ(read_exactly(*other, kMuch).size(), kMuch);
  });
  one->write(bytes, soon());
  EXPECT_EQ(read_exactly(*one, kMuch).size(), kMuch);
  writer.join();
}

TEST(ByteChannels, PacingGivesTheLineOfABaudRate) {
  auto [ours, theirs] = make_socket_pair();
  const auto channel = paced(adopt_socket(std::move(ours), "pair"), 115200);
  const auto start = Clock::now();
  for (int i = 0; i < 5; ++i) channel->write(all_bytes(), soon());
  // 5 * 256 bytes of 10 bits at 115200 bit/s are 111.1 ms.
  EXPECT_GE(Clock::now() - start, std::chrono::microseconds(111111));
}

}  // namespace

// Serial lines on pseudo-terminals: draining, change of the rate, hang-up (pty(7), termios(3)).

namespace {

Clock::time_point deadline() {
  return Clock::now() + std::chrono::seconds(5);
}

void write_all(int fd, const Bytes& bytes) {
  ASSERT_EQ(::write(fd, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
}

TEST(SerialLine, ReadsAllThatWasWrittenBeforeTheCall) {
  const Pty pty = make_pty();
  SerialLine line(pty.slave_path, 115200);
  for (int round = 0; round < 200; ++round) {
    Bytes sent(3000);
    std::iota(sent.begin(), sent.end(), static_cast<std::uint8_t>(round));
    write_all(pty.master.get(), sent);
    Bytes received;
    line.read_available(received);  // without waiting
    ASSERT_EQ(received, sent) << "round " << round;
  }
}

TEST(SerialLine, IsEmptyWithoutAnError) {
  const Pty pty = make_pty();
  SerialLine line(pty.slave_path, 115200);
  Bytes received;
  line.read_available(received);
  EXPECT_TRUE(received.empty());
}

TEST(SerialLine, ChangesTheRateOfTheTerminal) {
  const Pty pty = make_pty();
  SerialLine line(pty.slave_path, 115200);
  const auto rate = [&] {
    termios settings{};
    EXPECT_EQ(::tcgetattr(pty.master.get(), &settings), 0);
    return ::cfgetospeed(&settings);
  };
  EXPECT_EQ(rate(), static_cast<speed_t>(B115200));
  line.set_baud(9600);
  EXPECT_EQ(rate(), static_cast<speed_t>(B9600));
  EXPECT_EQ(line.baud(), 9600U);
  EXPECT_THROW(line.set_baud(12345), ChannelError);  // a rate that the system does not have
}

TEST(SerialLine, ReportsThatTheOtherEndHasHungUp) {
  Pty pty = make_pty();
  SerialLine line(pty.slave_path, 115200);
  pty.master.reset();
  Bytes received;
  EXPECT_THROW(line.read_available(received), ChannelError);
  EXPECT_THROW(line.write(Bytes{1, 2, 3}, deadline()), ChannelError);
}

TEST(SerialLine, NamesADeviceThatDoesNotExist) {
  try {
    SerialLine line("/dev/no_such_receiver", 115200);
    FAIL();
  } catch (const ChannelError& error) {
    EXPECT_NE(std::string(error.what()).find("/dev/no_such_receiver"), std::string::npos);
  }
}

TEST(SerialLine, WritesAndWaits) {
  const Pty pty = make_pty();
  SerialLine line(pty.slave_path, 115200);
  line.write(Bytes{'a', 'b'}, deadline());
  Bytes at_master(2);
  EXPECT_EQ(::read(pty.master.get(), at_master.data(), at_master.size()), 2);
  EXPECT_EQ(at_master, (Bytes{'a', 'b'}));
  write_all(pty.master.get(), {'c'});
  line.wait_for_input(deadline());
  Bytes received;
  line.read_available(received);
  EXPECT_EQ(received, Bytes{'c'});
}

}  // namespace

namespace {

using testing::ElementsAre;
using testing::SizeIs;

constexpr std::size_t kMaxBytes = 8;

/// Two sockets that are each other's peers.
struct Pair {
  explicit Pair(BoundUdpSocket a = bind_udp_loopback(), BoundUdpSocket b = bind_udp_loopback())
      : port(a.port),
        one(std::move(a.socket), "127.0.0.1", b.port, kMaxBytes),
        other(std::move(b.socket), "127.0.0.1", a.port, kMaxBytes) {}
  std::uint16_t port;  ///< of `one`
  UdpSocket one;
  UdpSocket other;
};

TEST(UdpSocket, DeliversDatagramsWholeAndInOrder) {
  Pair pair;
  pair.one.send(std::vector<std::uint8_t>{1, 2, 3});
  pair.one.send({});
  EXPECT_THAT(pair.other.receive(soon()).value(), ElementsAre(1, 2, 3));
  EXPECT_THAT(pair.other.receive(soon()).value(), SizeIs(0));
}

TEST(UdpSocket, ALongerDatagramIsSeenToBeLonger) {
  Pair pair;
  pair.one.send(std::vector<std::uint8_t>(kMaxBytes + 5, 7));
  EXPECT_THAT(pair.other.receive(soon()).value(), SizeIs(kMaxBytes + 1));
}

TEST(UdpSocket, DatagramsOfAnotherAddressAreCountedAndDiscarded) {
  Pair pair;
  UdpSocket foreign("127.0.0.1", pair.port, 0, kMaxBytes);
  foreign.send(std::vector<std::uint8_t>{9});
  pair.other.send(std::vector<std::uint8_t>{1});
  EXPECT_THAT(pair.one.receive(soon()).value(), ElementsAre(1));
  EXPECT_EQ(pair.one.foreign_datagrams(), 1U);
}

TEST(UdpSocket, NothingByTheDeadline) {
  Pair pair;
  EXPECT_FALSE(pair.one.receive(Clock::now() + milliseconds(10)).has_value());
}

TEST(UdpSocket, APeerThatIsNotThereLosesDatagramsOnly) {
  const std::uint16_t free_port = bind_udp_loopback().port;
  UdpSocket socket("127.0.0.1", free_port, 0, kMaxBytes);
  socket.send(std::vector<std::uint8_t>{1});
  EXPECT_FALSE(socket.receive(Clock::now() + milliseconds(10)).has_value());
  socket.send(std::vector<std::uint8_t>{1});
}

TEST(UdpSocket, ErrorsNameTheAddress) {
  try {
    UdpSocket socket("zedboard.local", 1, 0, kMaxBytes);
    FAIL() << "a host name was accepted";
  } catch (const ChannelError& error) {
    EXPECT_STREQ(error.what(), "'zedboard.local' is not an IPv4 address");
  }
}

}  // namespace

}  // namespace vbar::io
