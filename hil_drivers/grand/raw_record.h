#pragma once
// Bytes of one receiver as they came, kept in memory until there is a run folder, then in a file of the folder. Public
// tools read such files (RTKLIB: convbin -r nov).

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace vbar::grand {

class RawRecord {
 public:
  /// Adds bytes, from any thread. Throws std::runtime_error if the file cannot be extended.
  void add(std::span<const std::uint8_t> bytes);
  /// Writes all bytes, earlier and later ones, to the file. Throws std::runtime_error that names it.
  void keep_in(const std::filesystem::path& file);
  void flush();

 private:
  void write(std::span<const std::uint8_t> bytes);

  std::mutex mutex_;
  std::vector<std::uint8_t> early_;
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace vbar::grand
