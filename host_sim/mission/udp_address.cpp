#include "host_sim/mission/udp_address.h"

#include <charconv>
#include <string_view>
#include <system_error>

#include <arpa/inet.h>

#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

UdpAddress read_udp_address(const TableReader& section, const std::string& key) {
  UdpAddress address;
  const std::string text = section.text(key, "");
  if (text.empty()) return address;
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == std::string::npos ? "" : std::string_view(text).substr(colon + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), address.port);
  address.host = text.substr(0, colon);
  in_addr ignored{};
  if (error != std::errc{} || end != digits.data() + digits.size() || address.port == 0 ||
      ::inet_pton(AF_INET, address.host.c_str(), &ignored) != 1)
    section.refuse_value(key, "an IPv4 address and a port, \"127.0.0.1:5005\"");
  return address;
}

}  // namespace vbar::mission
