#pragma once
// An emulated camera on a loopback address of its own.

#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/gige/device/device.h"

namespace vbar::gige {

struct PlacedDevice {
  std::string address;
  std::unique_ptr<Device> device;
};

/// Makes a device on the first address from <network>.1 that has no camera; `network`: three numbers, such as
/// "127.0.13". Throws std::runtime_error if there is none.
[[nodiscard]] PlacedDevice device_on_free_address(boost::asio::io_context& context, Device::Settings settings,
                                                  const std::string& network, const Expose& expose);

/// Returns eight digits of a random stream.
[[nodiscard]] std::string drawn_serial(std::uint64_t seed, const std::string& stream);

}  // namespace vbar::gige
