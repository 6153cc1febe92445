#pragma once
// Addresses of a testbed's devices: addresses.json of an emulator.

#include <filesystem>
#include <string>

namespace vbar::optical_stimulator {

struct BenchAddresses {
  std::string display;  ///< name of its X server
  std::string camera;   ///< IP address
  std::string rails;    ///< a tty
};

/// Throws std::runtime_error that names the file.
[[nodiscard]] BenchAddresses read_addresses(const std::filesystem::path& file);

}  // namespace vbar::optical_stimulator
