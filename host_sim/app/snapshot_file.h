#pragma once
// A snapshot of the flight software in a file: a line of text that names the step after it, then the bytes of
// vbar_gnc_save.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace vbar::app {

struct Snapshot {
  std::uint32_t next_step = 0;  ///< number of the step after it
  std::vector<std::uint8_t> bytes;
};

/// Throws std::runtime_error.
void write_snapshot(const std::filesystem::path& file, const Snapshot& snapshot);

/// Throws Refused if the file cannot be read, is not a snapshot or is not whole. Its content is checked by the flight
/// software.
[[nodiscard]] Snapshot read_snapshot(const std::filesystem::path& file);

}  // namespace vbar::app
