#pragma once
// Append-only files of JSON lines, each with a checksum: one writer a file, so that no lock is needed between
// computers, and a line that was cut by a crash is recognised.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "host_sim/io/file_descriptor.h"

namespace vbar::campaign {

using Json = nlohmann::ordered_json;

/// A line without its end: the members of `object`, then "crc32" of the text without that member.
[[nodiscard]] std::string line_of(const Json& object);

class RecordFile {
 public:
  enum class Sync { kNo, kYes };

  /// Makes the file, which must not exist, and holds a lock on it as long as this object lives. Throws
  /// std::runtime_error that names the file, here and below.
  explicit RecordFile(std::filesystem::path file);

  /// Appends one line; with kYes it survives a loss of power when this returns.
  void append(const Json& object, Sync sync);

  [[nodiscard]] const std::filesystem::path& path() const { return file_; }

 private:
  std::filesystem::path file_;
  io::FileDescriptor descriptor_;
};

/// Whether the writer of the file lives: its lock is held.
[[nodiscard]] bool is_being_written(const std::filesystem::path& file);

struct ReadLines {
  std::vector<Json> lines;
  std::size_t damaged = 0;  ///< lines that fail their checksum, but for one without an end
};

/// Throws std::runtime_error that names the file if it cannot be read.
[[nodiscard]] ReadLines read_lines_of(const std::filesystem::path& file);

}  // namespace vbar::campaign
