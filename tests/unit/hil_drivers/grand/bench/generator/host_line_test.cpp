// A serial line of the bench as the host sees it: a terminal of Linux.

#include "hil_drivers/bench_lines/host_line.h"

#include <chrono>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include "tests/unit/hil_drivers/grand/bench/generator/bench_directory.h"

namespace vbar::grand::bench {
namespace {

using namespace std::chrono_literals;
using bench_lines::HostLine;
using test::BenchDirectory;
using test::read_available;

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

class HostLineTest : public ::testing::Test {
 protected:
  io::FileDescriptor open_host() const {
    io::FileDescriptor host(::open(line.path().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    EXPECT_GE(host.get(), 0);
    return host;
  }

  BenchDirectory directory;
  boost::asio::io_context context;
  std::string heard;
  unsigned heard_baud = 0;
  HostLine line{context, directory.path() / "servicer.com1", [this](auto bytes, unsigned baud) {
                  heard.append(bytes.begin(), bytes.end());
                  heard_baud = baud;
                }};
};

TEST_F(HostLineTest, BytesPassInBothDirections) {
  const io::FileDescriptor host = open_host();
  line.write(bytes_of("hello\r\n"));
  EXPECT_EQ(read_available(host.get()), "hello\r\n");
  ASSERT_EQ(::write(host.get(), "log\r\n", 5), 5);
  line.poll();
  EXPECT_EQ(heard, "log\r\n");
  ASSERT_EQ(::write(host.get(), "x", 1), 1);
  context.run_for(100ms);  // the event loop hears it too
  EXPECT_EQ(heard, "log\r\nx");
}

// A terminal takes some ten kilobytes: the rest is kept and follows in order.
TEST_F(HostLineTest, NothingIsLostWhenTheHostReadsLate) {
  const io::FileDescriptor host = open_host();
  std::string sent;
  for (int k = 0; k < 40'000; ++k) sent += fmt::format("{:06d}\n", k);
  line.write(bytes_of(sent));
  EXPECT_GT(line.waiting(), 100'000U);
  std::string received;
  for (int round = 0; round < 10'000 && received.size() < sent.size(); ++round) {
    received += read_available(host.get());
    context.run_for(1ms);
  }
  EXPECT_EQ(received, sent);
  EXPECT_EQ(line.waiting(), 0U);
  EXPECT_EQ(line.bytes_lost(), 0U);
}

TEST_F(HostLineTest, BaudRateIsThatOfTheHostsEnd) {
  const io::FileDescriptor host = open_host();
  termios settings{};
  ASSERT_EQ(::tcgetattr(host.get(), &settings), 0);
  ::cfsetspeed(&settings, B57600);
  ASSERT_EQ(::tcsetattr(host.get(), TCSANOW, &settings), 0);
  EXPECT_EQ(line.host_baud(), 57600U);
  ASSERT_EQ(::write(host.get(), "a", 1), 1);
  line.poll();
  EXPECT_EQ(heard_baud, 57600U);
  EXPECT_TRUE(line.set_host_baud(9600));
  ASSERT_EQ(::tcgetattr(host.get(), &settings), 0);
  EXPECT_EQ(::cfgetospeed(&settings), static_cast<speed_t>(B9600));
  EXPECT_FALSE(line.set_host_baud(12345));
}

TEST_F(HostLineTest, HangUpEndsTheHostsEndAndPluggingInMakesANewOne) {
  const io::FileDescriptor host = open_host();
  line.hang_up();
  EXPECT_FALSE(line.is_plugged_in());
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(line.path())));
  char byte = 0;
  EXPECT_LE(::read(host.get(), &byte, 1), 0);
  EXPECT_NE(errno, EAGAIN);
  EXPECT_LT(::write(host.get(), "x", 1), 0);
  line.write(bytes_of("lost"));
  EXPECT_EQ(line.bytes_lost(), 4U);
  EXPECT_EQ(line.host_baud(), 0U);

  line.plug_in();
  const io::FileDescriptor again = open_host();
  line.write(bytes_of("back"));
  EXPECT_EQ(read_available(again.get()), "back");
  ASSERT_EQ(::write(again.get(), "y", 1), 1);
  context.run_for(100ms);
  EXPECT_EQ(heard, "y");
}

TEST_F(HostLineTest, LinkOfAnEndedProgramIsReplacedAndAFileIsNot) {
  std::filesystem::create_symlink("/dev/pts/nowhere", directory.path() / "old.com1");
  { const HostLine replaced(context, directory.path() / "old.com1", {}); }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(directory.path() / "old.com1")));
  std::ofstream(directory.path() / "file.com1") << "text";
  EXPECT_THROW(HostLine(context, directory.path() / "file.com1", {}), std::runtime_error);
  EXPECT_TRUE(std::filesystem::exists(directory.path() / "file.com1"));
}

}  // namespace
}  // namespace vbar::grand::bench
