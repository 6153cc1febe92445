#pragma once
// Addresses of the devices of a testbed: an emulator writes them to addresses.json, a real testbed has them in its
// bench file.

#include <cstdint>
#include <filesystem>
#include <string>

#include "hil_drivers/tron/bench_file/bench_file.h"

namespace vbar::tron {

struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;
};

struct BenchAddresses {
  bool is_virtual = false;                ///< the clock of an emulator
  std::string camera;                     ///< IP address
  TcpAddress camera_robot, target_robot;  ///< Ethernet KRL
  TcpAddress lights;                      ///< sACN, UDP
  std::filesystem::path control;          ///< socket of an emulator; empty: none
};

[[nodiscard]] BenchAddresses addresses_of(const BenchFile& bench);
/// Throws std::runtime_error that names the file.
[[nodiscard]] BenchAddresses read_addresses(const std::filesystem::path& file);
/// Parses "host:port"; throws std::runtime_error.
[[nodiscard]] TcpAddress parse_address(const std::string& text);

}  // namespace vbar::tron
