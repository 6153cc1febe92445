#pragma once
// Serial line of an emulated receiver as a host sees it: a pseudo-terminal behind a name in the emulator's directory.
// Bytes for the host are never lost while the line is plugged in: bytes that the terminal does not accept now are kept
// in order.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "host_sim/io/byte_channel.h"

namespace vbar::emulators {

class HostLine {
 public:
  /// Receives the bytes that the host has written, and the baud rate to which the host's end is set.
  using Listener = std::function<void(std::span<const std::uint8_t> bytes, unsigned host_baud)>;

  /// Makes the terminal and the symbolic link to it, in place of one that an ended program left. Throws
  /// std::runtime_error, one sentence, if there is something else at that path.
  HostLine(boost::asio::io_context& context, std::filesystem::path link, Listener listener);
  ~HostLine();
  HostLine(const HostLine&) = delete;
  HostLine& operator=(const HostLine&) = delete;

  /// Hands over what the host has written so far; otherwise this happens in the event loop.
  void poll();

  /// Sends bytes to the host. While the line is unplugged they are lost.
  void write(std::span<const std::uint8_t> bytes);

  /// Rate of the host's end; 0 while the line is unplugged.
  [[nodiscard]] unsigned host_baud() const;
  /// Sets the rate of the host's end, as another program on the host could. Returns false for a rate that terminals do
  /// not have.
  bool set_host_baud(unsigned baud);

  /// Unplugs the line: the host's end hangs up, its name disappears, bytes under way are lost.
  void hang_up();
  /// Plugs the line in again: a new terminal under the same name.
  void plug_in();
  [[nodiscard]] bool is_plugged_in() const { return pty_.has_value(); }

  /// Number of bytes that the terminal has not accepted yet.
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  [[nodiscard]] std::uint64_t bytes_lost() const { return bytes_lost_; }
  [[nodiscard]] const std::filesystem::path& path() const { return link_; }

 private:
  struct Plugged;

  void wait_for_bytes();
  void flush();
  void lose_waiting();

  boost::asio::io_context* context_;
  std::filesystem::path link_;
  Listener listener_;
  std::optional<io::Pty> pty_;
  std::shared_ptr<boost::asio::posix::stream_descriptor>
      stream_;  ///< descriptor of the master; handlers hold it weakly
  std::vector<std::uint8_t> waiting_;
  bool waits_for_room_ = false;
  std::uint64_t bytes_lost_ = 0;
};

}  // namespace vbar::emulators
