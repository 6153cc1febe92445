#pragma once
// One sentence about a file that could not be written.

#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace vbar::files {

/// "FILE: cannot be written: REASON", with the system's reason in errno, e.g. "No space left on device". Set errno to 0
/// before the attempt.
[[nodiscard]] std::runtime_error write_error(const std::filesystem::path& file);

// Files of a folder that may have come from elsewhere: a symbolic link in it must not direct a write or a removal to
// what it names.

/// Removes `file` if it is a symbolic link, so that what is opened or written under this name next is in its own
/// folder. Throws std::runtime_error that names the link if it cannot be removed.
void remove_link(const std::filesystem::path& file);

// Whole text files, for files that are either there as meant or not at all.

/// Returns the bytes of a file; an empty value if it cannot be read, also where its disk fails halfway.
[[nodiscard]] std::optional<std::string> contents_of(const std::filesystem::path& file);

/// Throws std::runtime_error that names the file.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Returns the path that replace_text_file writes before it renames; a kill can leave it.
[[nodiscard]] std::filesystem::path neighbour_of(const std::filesystem::path& file);

/// Writes a neighbour and renames it, so that `file` never holds half of `text`. Throws std::runtime_error that names
/// the file; what was there before then still is.
void replace_text_file(const std::filesystem::path& file, std::string_view text);

// A file that grows over a run: it has its name only once it is whole, until then one that says it is not.

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

// A file that grows, of which a program has more than the system lets it keep open.

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
