#include "host_sim/io/serial_line.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/serial_port.hpp>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "host_sim/io/byte_channel.h"

namespace vbar::io {

void set_raw(int terminal, const std::string& description) {
  const auto fail = [&] { throw ChannelError(description + ": " + std::strerror(errno)); };
  termios settings{};
  if (::tcgetattr(terminal, &settings) != 0) fail();
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  if (::tcsetattr(terminal, TCSANOW, &settings) != 0) fail();
}

bool TerminalQueue::is_empty() {
  if (device_.empty()) return true;
  if (terminal_.get() < 0)
    terminal_ = FileDescriptor(::open(device_.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (terminal_.get() < 0) return true;
  // Not FIONREAD: poll also moves what the kernel has not yet passed on to the terminal's queue.
  pollfd request{.fd = terminal_.get(), .events = POLLIN, .revents = 0};
  if (::poll(&request, 1, 0) <= 0) return true;
  const bool is_hung_up = (request.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
  if (is_hung_up) terminal_.reset();
  return is_hung_up;
}

namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds kDrainLimit{500};

/// -1: an error; 0: nothing by the deadline.
int wait_for(int fd, short events, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd entry{fd, events, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 3'600'000)));
    if (ready >= 0 || errno != EINTR) return ready;
  }
}

}  // namespace

struct SerialLine::Port {
  asio::io_context context;
  asio::serial_port port{context};  // which opens it without blocking and has the rates of the system

  [[nodiscard]] int fd() { return port.native_handle(); }
};

SerialLine::SerialLine(const std::string& device, unsigned baud)
    : device_(device), baud_(baud), port_(std::make_unique<Port>()) {
  boost::system::error_code error;
  port_->port.open(device, error);
  if (error) throw ChannelError(device + ": " + error.message());
  set_raw(port_->fd(), device);
  set_baud(baud);
  ::tcflush(port_->fd(), TCIOFLUSH);
}

SerialLine::~SerialLine() = default;

void SerialLine::set_baud(unsigned baud) {
  // tcdrain would wait without a limit for an end that does not read.
  const Clock::time_point deadline = Clock::now() + kDrainLimit;
  for (int queued = 0; ::ioctl(port_->fd(), TIOCOUTQ, &queued) == 0 && queued > 0 && Clock::now() < deadline;)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  boost::system::error_code error;
  port_->port.set_option(asio::serial_port::baud_rate(baud), error);
  if (error) throw ChannelError(device_ + ": setting " + std::to_string(baud) + " baud: " + error.message());
  baud_ = baud;
}

void SerialLine::write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(port_->fd(), bytes.data(), bytes.size());
    if (count >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {
      if (wait_for(port_->fd(), POLLOUT, deadline) == 0) throw ChannelError(device_ + " takes no more bytes");
    } else if (errno != EINTR) {
      throw ChannelError(device_ + ": " + std::strerror(errno));
    }
  }
}

void SerialLine::read_available(std::vector<std::uint8_t>& bytes) {
  std::array<std::uint8_t, 16384> buffer;
  for (;;) {
    const ssize_t count = ::read(port_->fd(), buffer.data(), buffer.size());
    if (count > 0) {
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + count);
    } else if (count == 0) {
      throw ChannelError(device_ + ": the other end has hung up");
    } else if (errno == EAGAIN) {
      return;
    } else if (errno != EINTR) {
      throw ChannelError(device_ + ": " + std::strerror(errno));
    }
  }
}

void SerialLine::wait_for_input(Clock::time_point deadline) {
  static_cast<void>(wait_for(port_->fd(), POLLIN, deadline));
}

}  // namespace vbar::io
