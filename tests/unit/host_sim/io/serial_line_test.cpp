// Serial lines on pseudo-terminals: draining, change of the rate, hang-up (pty(7), termios(3)).

#include "host_sim/io/serial_line.h"

#include <numeric>

#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include "host_sim/io/byte_channels.h"

namespace vbar::io {
namespace {

using Bytes = std::vector<std::uint8_t>;

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
}  // namespace vbar::io
