// The line of a wired receiver under a POSIX system, on pseudo-terminals.

#include "boards/posix/receiver_line.h"

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include "tests/unit/boards/common/reference_host.h"

namespace vbar::boards::posix {
namespace {

using testing::Bytes;

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
