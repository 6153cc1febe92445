#include "emulators/common/host_line.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

namespace vbar::emulators {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// A host that never reads its line: 10 MB are 15 minutes of a line at its highest rate.
constexpr std::size_t kMaxWaiting = 10'000'000;

struct BaudName {
  unsigned baud;
  speed_t speed;
};
constexpr std::array<BaudName, 9> kBauds{{{2400, B2400},
                                          {4800, B4800},
                                          {9600, B9600},
                                          {19200, B19200},
                                          {38400, B38400},
                                          {57600, B57600},
                                          {115200, B115200},
                                          {230400, B230400},
                                          {460800, B460800}}};

}  // namespace

HostLine::HostLine(asio::io_context& context, std::filesystem::path link, Listener listener)
    : context_(&context), link_(std::move(link)), listener_(std::move(listener)) {
  plug_in();
}

HostLine::~HostLine() {
  hang_up();
}

void HostLine::plug_in() {
  if (pty_) return;
  std::error_code error;
  const auto status = std::filesystem::symlink_status(link_, error);
  if (std::filesystem::is_symlink(status)) std::filesystem::remove(link_, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_symlink(status))
    throw std::runtime_error(
        fmt::format("{}: there is a file where a serial line of the bench belongs; remove it", link_.string()));
  pty_ = io::make_pty();
  std::filesystem::create_symlink(pty_->slave_path, link_, error);
  if (error) {
    pty_.reset();
    throw std::runtime_error(
        fmt::format("{}: a link to a terminal cannot be made: {}", link_.string(), error.message()));
  }
  stream_ = std::make_shared<asio::posix::stream_descriptor>(*context_, ::dup(pty_->master.get()));
  stream_->non_blocking(true);
  wait_for_bytes();
}

void HostLine::hang_up() {
  if (!pty_) return;
  lose_waiting();
  error_code ignored;
  stream_->close(ignored);
  stream_.reset();
  pty_.reset();
  waits_for_room_ = false;
  std::error_code no_file;
  std::filesystem::remove(link_, no_file);
}

void HostLine::wait_for_bytes() {
  const std::weak_ptr<asio::posix::stream_descriptor> alive = stream_;
  stream_->async_wait(asio::posix::stream_descriptor::wait_read, [this, alive](const error_code& error) {
    if (error || alive.expired() || alive.lock() != stream_) return;
    poll();
    if (stream_ == alive.lock() && stream_) wait_for_bytes();
  });
}

void HostLine::poll() {
  std::array<std::uint8_t, 4096> buffer;
  while (stream_) {
    error_code error;
    const std::size_t count = stream_->read_some(asio::buffer(buffer), error);
    if (error || count == 0) return;
    if (listener_) listener_(std::span(buffer.data(), count), host_baud());
  }
}

void HostLine::write(std::span<const std::uint8_t> bytes) {
  if (!stream_) {
    bytes_lost_ += bytes.size();
    return;
  }
  const std::size_t accepted = std::min(bytes.size(), kMaxWaiting - std::min(kMaxWaiting, waiting_.size()));
  bytes_lost_ += bytes.size() - accepted;
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(accepted));
  flush();
}

void HostLine::flush() {
  std::size_t written = 0;
  while (written < waiting_.size()) {
    error_code error;
    written += stream_->write_some(asio::buffer(waiting_.data() + written, waiting_.size() - written), error);
    if (error) break;
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(written));
  if (waiting_.empty() || waits_for_room_) return;
  waits_for_room_ = true;
  const std::weak_ptr<asio::posix::stream_descriptor> alive = stream_;
  stream_->async_wait(asio::posix::stream_descriptor::wait_write, [this, alive](const error_code& error) {
    if (error || alive.expired() || alive.lock() != stream_) return;
    waits_for_room_ = false;
    flush();
  });
}

void HostLine::lose_waiting() {
  bytes_lost_ += waiting_.size();
  waiting_.clear();
}

unsigned HostLine::host_baud() const {
  termios settings{};
  if (!pty_ || ::tcgetattr(pty_->slave.get(), &settings) != 0) return 0;
  const speed_t speed = ::cfgetospeed(&settings);
  const auto* found = std::ranges::find(kBauds, speed, &BaudName::speed);
  return found == kBauds.end() ? 0 : found->baud;
}

bool HostLine::set_host_baud(unsigned baud) {
  const auto* found = std::ranges::find(kBauds, baud, &BaudName::baud);
  termios settings{};
  if (found == kBauds.end() || !pty_ || ::tcgetattr(pty_->slave.get(), &settings) != 0) return false;
  ::cfsetispeed(&settings, found->speed);
  ::cfsetospeed(&settings, found->speed);
  return ::tcsetattr(pty_->slave.get(), TCSANOW, &settings) == 0;
}

}  // namespace vbar::emulators
