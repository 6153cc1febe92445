#include "hil_drivers/tron/hardware/addresses.h"

#include <charconv>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace vbar::tron {

TcpAddress parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  TcpAddress address;
  if (colon != std::string::npos && colon > 0) {
    address.host = text.substr(0, colon);
    const char* const end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data() + colon + 1, end, address.port);
    if (error == std::errc() && last == end && address.port > 0) return address;
  }
  throw std::runtime_error("\"" + text + "\" is not an address host:port");
}

BenchAddresses addresses_of(const BenchFile& bench) {
  BenchAddresses addresses;
  addresses.camera = bench.camera_address;
  addresses.camera_robot = {bench.camera_robot.line.address, bench.camera_robot.line.eki_port};
  addresses.target_robot = {bench.target_robot.line.address, bench.target_robot.line.eki_port};
  addresses.lights = {bench.sacn.address, bench.sacn.port};
  return addresses;
}

BenchAddresses read_addresses(const std::filesystem::path& file) {
  try {
    std::ifstream stream(file);
    const nlohmann::json json = nlohmann::json::parse(stream);
    BenchAddresses addresses;
    addresses.is_virtual = json.at("clock").get<std::string>() == "virtual";
    addresses.camera = json.at("camera").get<std::string>();
    addresses.camera_robot = parse_address(json.at("camera_robot").at("eki").get<std::string>());
    addresses.target_robot = parse_address(json.at("target_robot").at("eki").get<std::string>());
    addresses.lights = parse_address(json.at("sacn").get<std::string>());
    addresses.control = json.at("control").get<std::string>();
    return addresses;
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": not the addresses of a bench: " + error.what());
  }
}

}  // namespace vbar::tron
