#pragma once
// A file that grows, of which a program has more than the system lets it keep open.

#include <filesystem>
#include <string>
#include <string_view>

namespace vbar::files {

/// As PartialFile, but opened only while some kilobytes are written. All throw std::runtime_error that names the file.
class ReleasedFile {
 public:
  /// Starts `<file>.part`.
  explicit ReleasedFile(std::filesystem::path file);

  void append(std::string_view text);

  /// Hands all that was appended to the operating system.
  void flush();

  /// Gives the file its name. Without it the part stays a part.
  void finish();

 private:
  std::filesystem::path file_;
  std::string pending_;
};

}  // namespace vbar::files
