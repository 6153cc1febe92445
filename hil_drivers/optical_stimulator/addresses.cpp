#include "hil_drivers/optical_stimulator/addresses.h"

#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace vbar::optical_stimulator {

BenchAddresses read_addresses(const std::filesystem::path& file) {
  try {
    std::ifstream stream(file);
    const nlohmann::json json = nlohmann::json::parse(stream);
    BenchAddresses addresses;
    addresses.display = json.at("display").get<std::string>();
    addresses.camera = json.at("camera").get<std::string>();
    addresses.rails = json.at("rails").at("pty").get<std::string>();
    return addresses;
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": not the addresses of a bench: " + error.what());
  }
}

}  // namespace vbar::optical_stimulator
