#pragma once
// Addresses of an emulator or a testbed: addresses.json, which it writes once it listens.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace vbar::grand {

struct BenchAddresses {
  std::vector<std::uint16_t> control_ports;
  std::string pps;  ///< path of its socket of edges; may be empty
  // Devices by spacecraft: the tty of the command port, and of the second one, to which the board is connected.
  std::map<std::string, std::string> receivers, board_lines;
};

/// Reads the file. Throws std::runtime_error that names it.
[[nodiscard]] BenchAddresses read_addresses(const std::filesystem::path& file);

}  // namespace vbar::grand
