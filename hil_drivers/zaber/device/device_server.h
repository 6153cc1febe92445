#pragma once
// Lines of an emulated controller: a pseudo-terminal and a TCP port of 127.0.0.1. Commands end in LF, CR or both;
// replies in CR LF.

#include <cstdint>
#include <filesystem>
#include <memory>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/zaber/device/device.h"

namespace vbar::zaber {

class DeviceServer {
 public:
  /// Opens both lines. `device` outlives the server; `terminal` is the name of the serial line. Throws
  /// std::runtime_error.
  DeviceServer(boost::asio::io_context& context, Device& device, const std::filesystem::path& terminal,
               std::uint16_t tcp_port = 0);
  ~DeviceServer();
  DeviceServer(const DeviceServer&) = delete;
  DeviceServer& operator=(const DeviceServer&) = delete;

  [[nodiscard]] std::uint16_t tcp_port() const;
  /// Called after every line that was answered.
  std::function<void()> on_command;

 private:
  struct Lines;
  std::unique_ptr<Lines> lines_;
};

}  // namespace vbar::zaber
