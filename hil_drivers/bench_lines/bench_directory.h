#pragma once
// Directory in which an emulator makes its lines, and the file that lists their addresses.

#include <filesystem>
#include <string>

namespace vbar::bench_lines {

inline constexpr const char* kAddressesFile = "addresses.json";

class BenchDirectory {
 public:
  /// Makes the directory if it does not exist. Throws std::runtime_error.
  explicit BenchDirectory(const std::filesystem::path& directory);
  /// Removes the list of addresses.
  ~BenchDirectory();
  BenchDirectory(const BenchDirectory&) = delete;
  BenchDirectory& operator=(const BenchDirectory&) = delete;

  /// Absolute path of the directory.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Writes addresses.json, which appears only when it is complete: a program that waits for the file may read it at
  /// once. Throws std::runtime_error.
  void write_addresses(const std::string& json) const;

 private:
  std::filesystem::path path_;
};

}  // namespace vbar::bench_lines
