// Who may lead a session over UDP: one host at a time, and another once that one has been silent. Real sockets on the
// loopback interface.

#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "boards/posix/links.h"
#include "tests/unit/boards/common/reference_host.h"

namespace vbar::boards::posix {

namespace {

using fsw::link::FrameType;
using testing::Bytes;

constexpr std::uint64_t kSilence_ms = 300;

/// A UDP socket bound to 127.0.0.1 and a free port.
class Socket {
 public:
  Socket() : fd_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    auto* const raw = reinterpret_cast<sockaddr*>(&address_);
    EXPECT_EQ(::bind(fd_, raw, size), 0);
    EXPECT_EQ(::getsockname(fd_, raw, &size), 0);
  }
  ~Socket() { ::close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  [[nodiscard]] int fd() const { return fd_; }

  void send(const Bytes& frame, const Socket& to) const {
    const auto* const raw = reinterpret_cast<const sockaddr*>(&to.address_);
    EXPECT_EQ(::sendto(fd_, frame.data(), frame.size(), 0, raw, sizeof to.address_),
              static_cast<ssize_t>(frame.size()));
  }

  /// Whether something comes within the time.
  [[nodiscard]] bool hears(int within_ms) const {
    pollfd request{.fd = fd_, .events = POLLIN, .revents = 0};
    if (::poll(&request, 1, within_ms) != 1) return false;
    std::array<std::uint8_t, 2048> bytes{};
    return ::recv(fd_, bytes.data(), bytes.size(), 0) > 0;
  }

 private:
  int fd_;
  sockaddr_in address_{};
};

Bytes frame_of(FrameType type, std::uint32_t session) {
  fsw::link::FrameHeader header;
  header.type = type;
  header.session = session;
  return testing::make_frame(header, type == FrameType::kHello ? Bytes{1} : Bytes{});
}

class DatagramLinkTest : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::reset_fake_gnc();
    Platform platform;
    platform.context = &link_;
    platform.send = &DatagramLink::send;
    executive_ = std::make_unique<FlightExecutive>(platform);
    flight_ = std::thread([this] { end_ = link_.serve(*executive_); });
  }

  /// Ends the session that `host` leads, and with it the program.
  void finish(const Socket& host, std::uint32_t session) {
    host.send(frame_of(FrameType::kGoodbye, session), board_);
    flight_.join();
    EXPECT_EQ(end_, LinkEnd::kGoodbye);
  }

  Socket board_, host_, other_;
  DatagramLink link_{board_.fd(), kSilence_ms};
  std::unique_ptr<FlightExecutive> executive_;
  std::thread flight_;
  std::optional<LinkEnd> end_;
};

TEST_F(DatagramLinkTest, AnotherHostIsRefusedWhileThePeerSpeaks) {
  host_.send(frame_of(FrameType::kHello, 7), board_);
  ASSERT_TRUE(host_.hears(2000));
  other_.send(frame_of(FrameType::kHello, 8), board_);
  EXPECT_FALSE(other_.hears(100));
  other_.send(frame_of(FrameType::kGoodbye, 7), board_);  // does not end what it does not lead
  host_.send(frame_of(FrameType::kHello, 7), board_);
  EXPECT_TRUE(host_.hears(2000));
  finish(host_, 7);
}

TEST_F(DatagramLinkTest, AnotherHostTakesOverFromASilentOne) {
  host_.send(frame_of(FrameType::kHello, 7), board_);
  ASSERT_TRUE(host_.hears(2000));
  std::this_thread::sleep_for(std::chrono::milliseconds(2 * kSilence_ms));
  other_.send(frame_of(FrameType::kHello, 8), board_);
  EXPECT_TRUE(other_.hears(2000));
  host_.send(frame_of(FrameType::kHello, 7), board_);
  EXPECT_FALSE(host_.hears(100));
  finish(other_, 8);
}

}  // namespace

// The line of a wired receiver under a POSIX system, on pseudo-terminals.

namespace {

/// The receiver's end of a pseudo-terminal.
class Terminal {
 public:
  Terminal() : fd_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_EQ(::grantpt(fd_), 0);
    EXPECT_EQ(::unlockpt(fd_), 0);
    path_ = ::ptsname(fd_);
    // Raw before anything is sent: a new terminal would otherwise send it back.
    const int slave = ::open(path_.c_str(), O_RDWR | O_NOCTTY);
    termios settings{};
    EXPECT_EQ(::tcgetattr(slave, &settings), 0);
    ::cfmakeraw(&settings);
    EXPECT_EQ(::tcsetattr(slave, TCSANOW, &settings), 0);
    ::close(slave);
  }
  ~Terminal() { hang_up(); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void hang_up() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  void send(const Bytes& bytes) const {
    EXPECT_EQ(::write(fd_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  [[nodiscard]] speed_t rate() const {
    termios settings{};
    EXPECT_EQ(::tcgetattr(fd_, &settings), 0);
    return ::cfgetispeed(&settings);
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int fd_;
  std::string path_;
};

Bytes all_of(ReceiverLine& line) {
  Bytes all;
  std::array<std::uint8_t, 100> piece{};
  while (const std::size_t count = line.read(piece)) all.insert(all.end(), piece.begin(), piece.begin() + count);
  return all;
}

TEST(ReceiverLine, OpensAtItsRateAndDiscardsWhatCameBefore) {
  const Terminal terminal;
  terminal.send({1, 2, 3});
  ReceiverLine line(terminal.path().c_str());
  EXPECT_EQ(line.fd(), -1);
  ASSERT_TRUE(line.open(38400));
  EXPECT_EQ(terminal.rate(), speed_t{B38400});
  EXPECT_EQ(all_of(line), Bytes{});
  const Bytes bytes{0, 10, 13, 17, 19, 255, 3, 4};  // among them characters that a terminal would interpret
  terminal.send(bytes);
  EXPECT_EQ(all_of(line), bytes);
}

TEST(ReceiverLine, IsOpenedAgainAfterItWasHungUp) {
  const std::string link = ::testing::TempDir() + "vbar_receiver_line_" + std::to_string(::getpid());
  Terminal first;
  ASSERT_EQ(::symlink(first.path().c_str(), link.c_str()), 0);
  ReceiverLine line(link.c_str());
  ASSERT_TRUE(line.open(115200));
  first.hang_up();
  EXPECT_EQ(all_of(line), Bytes{});
  EXPECT_EQ(line.fd(), -1);
  EXPECT_EQ(all_of(line), Bytes{});
  const Terminal second;
  ::unlink(link.c_str());
  ASSERT_EQ(::symlink(second.path().c_str(), link.c_str()), 0);
  second.send({5, 6});
  EXPECT_EQ(all_of(line), (Bytes{5, 6}));
  ::unlink(link.c_str());
}

TEST(ReceiverLine, WhatCannotBeOpenedIsRefused) {
  ReceiverLine none(nullptr);
  EXPECT_FALSE(none.open(115200));
  EXPECT_EQ(all_of(none), Bytes{});
  ReceiverLine nowhere("/nowhere/tty");
  EXPECT_FALSE(nowhere.open(115200));
  const Terminal terminal;
  ReceiverLine line(terminal.path().c_str());
  EXPECT_FALSE(line.open(12345));
  EXPECT_FALSE(line.open(0));
  EXPECT_TRUE(line.open(9600));
  line.close();
  EXPECT_EQ(line.fd(), -1);
  EXPECT_EQ(all_of(line), Bytes{});  // closed, it stays closed
  EXPECT_EQ(line.fd(), -1);
}

}  // namespace

}  // namespace vbar::boards::posix
