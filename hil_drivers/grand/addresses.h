#pragma once
// Where a bench listens: addresses.json, which it writes once it does.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace vbar::grand {

struct BenchAddresses {
  std::vector<std::uint16_t> control_ports;
  std::string pps;  ///< path of its socket of edges; may be empty
  // By spacecraft: the tty of the command port, and of the second one, to which the board is connected.
  std::map<std::string, std::string> receivers, board_lines;
};

inline constexpr const char* kAddressesFile = "addresses.json";

/// Throws std::runtime_error that names the file.
[[nodiscard]] BenchAddresses read_addresses(const std::filesystem::path& file);

/// What the bench acknowledges of its faults, a line each.
inline constexpr const char* kFaultsFile = "faults.jsonl";

/// Faults that have taken effect, by their kind; lines of another form count as "unknown". None without the file.
[[nodiscard]] std::map<std::string, int> count_faults(const std::filesystem::path& file);

}  // namespace vbar::grand
