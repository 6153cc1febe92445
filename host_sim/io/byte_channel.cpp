#include "host_sim/io/byte_channel.h"

#include <algorithm>
#include <array>
#include <optional>
#include <thread>
#include <vector>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/serial_port.hpp>
#include <boost/asio/write.hpp>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>

#include "host_sim/io/serial_line.h"

namespace vbar::io {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::local::stream_protocol;
using boost::system::error_code;

constexpr std::chrono::milliseconds kConnectRetryPeriod{5};

[[noreturn]] void fail(const std::string& what, const error_code& error) {
  throw ChannelError(what + ": " + error.message());
}

[[noreturn]] void fail_errno(const std::string& what) {
  fail(what, error_code(errno, boost::system::system_category()));
}

/// Any Asio stream. Reading goes on while a write is under way, so that the two ends can never wait for each other.
template <class Stream>
class AsioChannel final : public ByteChannel {
 public:
  AsioChannel(std::unique_ptr<asio::io_context> context, Stream stream, std::string description)
      : context_(std::move(context)), stream_(std::move(stream)), description_(std::move(description)) {}

  void write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) override {
    std::optional<error_code> outcome;
    asio::async_write(stream_, asio::buffer(bytes.data(), bytes.size()),
                      [&outcome](const error_code& error, std::size_t) { outcome = error; });
    start_reading();
    while (!outcome && run_one(deadline)) start_reading();
    if (!outcome) {
      // The handler refers to this frame of the stack: let it finish before leaving.
      error_code ignored;
      stream_.cancel(ignored);
      while (!outcome) context_->run_one();
      throw ChannelError(description_ + " takes no more bytes");
    }
    if (*outcome) fail(description_, *outcome);
  }

  std::span<const std::uint8_t> read(Clock::time_point deadline) override {
    start_reading();
    while (arrived_.empty() && !read_error_ && run_one(deadline)) {
    }
    if (arrived_.empty() && read_error_) fail(description_, *read_error_);
    delivered_.clear();
    std::swap(delivered_, arrived_);
    return delivered_;
  }

  [[nodiscard]] std::string description() const override { return description_; }

 private:
  /// Runs one completion handler; false if none was ready by `deadline`. A completion that is ready when the deadline
  /// has passed already (for example because this program was stopped) still counts.
  bool run_one(Clock::time_point deadline) {
    if (context_->stopped()) context_->restart();
    return context_->run_one_until(deadline) != 0 || context_->poll_one() != 0;
  }

  void start_reading() {
    if (reading_ || read_error_) return;
    reading_ = true;
    stream_.async_read_some(asio::buffer(buffer_), [this](const error_code& error, std::size_t count) {
      reading_ = false;
      arrived_.insert(arrived_.end(), buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count));
      // A write that timed out also cancels the read; the next call continues reading.
      if (error && error != asio::error::operation_aborted) read_error_ = error;
    });
  }

  std::unique_ptr<asio::io_context> context_;
  Stream stream_;
  std::string description_;
  std::array<std::uint8_t, 16384> buffer_{};
  std::vector<std::uint8_t> arrived_;
  std::vector<std::uint8_t> delivered_;
  std::optional<error_code> read_error_;
  bool reading_ = false;
};

template <class Stream>
std::unique_ptr<ByteChannel> make_channel(std::unique_ptr<asio::io_context> context, Stream stream,
                                          std::string description) {
  return std::make_unique<AsioChannel<Stream>>(std::move(context), std::move(stream), std::move(description));
}

/// Calls `attempt` until it succeeds; throws its last error at the deadline.
template <class Attempt>
void connect_patiently(const std::string& description, Clock::time_point deadline, Attempt attempt) {
  for (;;) {
    const error_code error = attempt();
    if (!error) return;
    const bool nobody_there =
        error == asio::error::connection_refused || error == boost::system::errc::no_such_file_or_directory;
    if (!nobody_there || Clock::now() >= deadline) fail(description, error);
    std::this_thread::sleep_for(kConnectRetryPeriod);
  }
}

class PacedChannel final : public ByteChannel {
 public:
  PacedChannel(std::unique_ptr<ByteChannel> channel, double bits_per_s)
      : channel_(std::move(channel)), byte_time_(std::chrono::duration<double>(kBitsPerByte / bits_per_s)) {}

  void write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) override {
    send_line_free_ = std::max(send_line_free_, Clock::now()) + time_of(bytes.size());
    std::this_thread::sleep_until(send_line_free_);
    channel_->write(bytes, deadline);
  }

  std::span<const std::uint8_t> read(Clock::time_point deadline) override {
    const auto bytes = channel_->read(deadline);
    receive_line_free_ = std::max(receive_line_free_, Clock::now()) + time_of(bytes.size());
    if (!bytes.empty()) std::this_thread::sleep_until(receive_line_free_);
    return bytes;
  }

  [[nodiscard]] std::string description() const override { return channel_->description(); }

 private:
  static constexpr double kBitsPerByte = 10.0;
  [[nodiscard]] Clock::duration time_of(std::size_t bytes) const {
    return std::chrono::duration_cast<Clock::duration>(byte_time_ * static_cast<double>(bytes));
  }
  std::unique_ptr<ByteChannel> channel_;
  std::chrono::duration<double> byte_time_;
  Clock::time_point send_line_free_{};
  Clock::time_point receive_line_free_{};
};

}  // namespace

std::unique_ptr<ByteChannel> open_serial(const std::string& device, unsigned baud) {
  auto context = std::make_unique<asio::io_context>();
  asio::serial_port port(*context);
  error_code error;
  const auto require = [&](const char* step) {
    if (error) fail(device + ": " + step, error);
  };
  port.open(device, error);
  require("opening the serial device");
  set_raw(port.native_handle(), device);
  port.set_option(asio::serial_port::baud_rate(baud), error);
  require(("setting " + std::to_string(baud) + " baud").c_str());
  // Bytes of an earlier run in the driver's buffers are discarded.
  ::tcflush(port.native_handle(), TCIOFLUSH);
  return make_channel(std::move(context), std::move(port), device + " at " + std::to_string(baud) + " baud");
}

std::unique_ptr<ByteChannel> connect_unix(const std::string& path, Clock::time_point deadline) {
  auto context = std::make_unique<asio::io_context>();
  stream_protocol::socket socket(*context);
  const std::string description = "unix socket " + path;
  connect_patiently(description, deadline, [&] {
    error_code error;
    socket.close(error);
    socket.connect(stream_protocol::endpoint(path), error);
    return error;
  });
  return make_channel(std::move(context), std::move(socket), description);
}

std::unique_ptr<ByteChannel> connect_tcp(const std::string& host, const std::string& port, Clock::time_point deadline) {
  auto context = std::make_unique<asio::io_context>();
  tcp::socket socket(*context);
  const std::string description = "tcp " + host + ":" + port;
  error_code error;
  const auto endpoints = tcp::resolver(*context).resolve(host, port, error);
  if (error) fail(description, error);
  connect_patiently(description, deadline, [&] {
    error_code attempt_error;
    asio::connect(socket, endpoints, attempt_error);
    return attempt_error;
  });
  socket.set_option(tcp::no_delay(true), error);
  if (error) fail(description, error);
  return make_channel(std::move(context), std::move(socket), description);
}

std::unique_ptr<ByteChannel> adopt_socket(FileDescriptor fd, std::string description) {
  auto context = std::make_unique<asio::io_context>();
  stream_protocol::socket socket(*context);
  error_code error;
  socket.assign(stream_protocol(), fd.get(), error);
  if (error) fail(description, error);
  (void)fd.release();
  return make_channel(std::move(context), std::move(socket), std::move(description));
}

std::unique_ptr<ByteChannel> adopt_pty(FileDescriptor master, std::string description) {
  auto context = std::make_unique<asio::io_context>();
  asio::posix::stream_descriptor stream(*context);
  error_code error;
  stream.assign(master.get(), error);
  if (error) fail(description, error);
  (void)master.release();
  return make_channel(std::move(context), std::move(stream), std::move(description));
}

std::pair<FileDescriptor, FileDescriptor> make_socket_pair() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail_errno("socket pair");
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

Pty make_pty() {
  Pty pty;
  pty.master = FileDescriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  std::array<char, 64> path{};
  if (pty.master.get() < 0 || ::grantpt(pty.master.get()) != 0 || ::unlockpt(pty.master.get()) != 0 ||
      ::ptsname_r(pty.master.get(), path.data(), path.size()) != 0) {
    fail_errno("pseudo-terminal");
  }
  pty.slave_path = path.data();
  pty.slave = FileDescriptor(::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (pty.slave.get() < 0) fail_errno(pty.slave_path);
  set_raw(pty.slave.get(), pty.slave_path);
  return pty;
}

std::unique_ptr<ByteChannel> paced(std::unique_ptr<ByteChannel> channel, double bits_per_s) {
  return std::make_unique<PacedChannel>(std::move(channel), bits_per_s);
}

}  // namespace vbar::io
