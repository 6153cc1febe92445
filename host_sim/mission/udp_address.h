#pragma once
// An address of UDP in a mission file: "127.0.0.1:5005".

#include <cstdint>
#include <string>

namespace vbar::mission {

class TableReader;

struct UdpAddress {
  std::string host;  ///< IPv4
  std::uint16_t port = 0;
};

/// Returns the address under a key; port 0 without the key. Throws MissionError for anything else.
[[nodiscard]] UdpAddress read_udp_address(const TableReader& section, const std::string& key);

}  // namespace vbar::mission
