#pragma once
// Emulated controller with two axes or more that answers Zaber ASCII commands; no sockets.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "emulators/zaber/axis.h"
#include "hil_drivers/zaber/messages.h"

namespace vbar::zaber {

struct DeviceSettings {
  int address = 1;
  std::vector<AxisSettings> axes;
  std::uint64_t seed = 1;
};

class Device {
 public:
  /// Takes `now_s`: the time of the moves.
  Device(const DeviceSettings& settings, std::function<double()> now_s);

  /// Returns the replies to a line without its end, each without its end: one for an axis or the device, none for a
  /// line of another device, of a form that no device answers or with a wrong checksum.
  [[nodiscard]] std::vector<std::string> answer(std::string_view line);

  /// Returns an axis, counted from 1 on the wire, from 0 here. Its moves have advanced to now.
  [[nodiscard]] Axis& axis(std::size_t index);
  [[nodiscard]] std::size_t axes() const { return axes_.size(); }

 private:
  struct Result {
    bool is_rejected = false;
    std::string data = "0";
  };
  [[nodiscard]] Result execute(const Command& command);
  [[nodiscard]] Result execute_on(Axis& axis, const std::vector<std::string>& words, double now_s);
  [[nodiscard]] Result move(Axis& axis, const std::vector<std::string>& words, double now_s);
  [[nodiscard]] Result set(Axis& axis, const std::string& name, const std::string& value);
  [[nodiscard]] std::string value_of(const Axis& axis, const std::string& name) const;
  [[nodiscard]] Message status_of(const Command& command) const;

  DeviceSettings settings_;
  std::function<double()> now_s_;
  std::vector<Axis> axes_;
};

// Lines of an emulated controller: a pseudo-terminal and a TCP port of 127.0.0.1. Commands end in LF, CR or both;
// replies in CR LF.

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
