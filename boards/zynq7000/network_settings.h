#pragma once
// Ethernet and UDP addresses of the board: part of the image, in which boards/zynq7000/set_address.py changes them, so
// that two boards on one network need no second build.

#include <array>
#include <cstdint>

#include "boards/zynq7000/udp_endpoint.h"

namespace vbar::boards::zynq7000 {

/// Addresses as they lie in the image: no padding, the port with its high byte first. The script finds them by the
/// first eight bytes.
struct NetworkSettings {
  std::array<char, 8> label;
  MacAddress mac;
  Ipv4Address address;
  std::array<std::uint8_t, 2> port;

  [[nodiscard]] std::uint16_t udp_port() const { return static_cast<std::uint16_t>((port[0] << 8U) | port[1]); }
};
static_assert(sizeof(NetworkSettings) == 20);

/// Settings of this image, defined in a source of its own: a compiler that saw the values would not read them from the
/// image.
extern const NetworkSettings kNetworkSettings;

}  // namespace vbar::boards::zynq7000
