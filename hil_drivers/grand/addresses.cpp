#include "hil_drivers/grand/addresses.h"

#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace vbar::grand {

BenchAddresses read_addresses(const std::filesystem::path& file) {
  BenchAddresses addresses;
  try {
    std::ifstream stream(file);
    const nlohmann::json json = nlohmann::json::parse(stream);
    for (const auto& port : json.at("control_ports")) {
      const int number = port.get<int>();
      if (number < 1 || number > 65535) throw std::runtime_error("control port " + std::to_string(number));
      addresses.control_ports.push_back(static_cast<std::uint16_t>(number));
    }
    addresses.pps = json.value("pps", "");
    for (const auto& [spacecraft, ports] : json.at("receivers").items()) {
      addresses.receivers.emplace(spacecraft, ports.at("com1").get<std::string>());
      if (ports.contains("com2")) addresses.board_lines.emplace(spacecraft, ports.at("com2").get<std::string>());
    }
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": not the addresses of a bench: " + error.what());
  }
  return addresses;
}

}  // namespace vbar::grand
