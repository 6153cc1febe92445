#pragma once
// Emulated controller with two axes or more that answers Zaber ASCII commands; no sockets.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil_drivers/zaber/device/axis.h"
#include "hil_drivers/zaber/wire/messages.h"

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

}  // namespace vbar::zaber
