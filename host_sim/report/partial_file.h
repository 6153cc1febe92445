#pragma once
// A file that grows over a run: it has its name only once it is whole, until then one that says it is not.

#include <filesystem>
#include <fstream>
#include <string_view>

namespace vbar::files {

class PartialFile {
 public:
  /// Starts `<file>.part`. Throws std::runtime_error that names the file.
  explicit PartialFile(std::filesystem::path file);

  /// Throws std::runtime_error that names the file, here or in finish().
  void append(std::string_view text);

  /// Hands all that was appended to the operating system: it outlives the program.
  void flush();

  /// Gives the file its name. Without it the part stays a part.
  void finish();

  [[nodiscard]] const std::filesystem::path& path() const { return file_; }

  /// Returns the path of an unfinished `file`.
  [[nodiscard]] static std::filesystem::path part_of(const std::filesystem::path& file);

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  std::ofstream stream_;
};

}  // namespace vbar::files
