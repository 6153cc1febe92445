#pragma once
// SHA-256 of bytes and of files.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::files {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(std::span<const std::uint8_t> bytes);
  void add(std::string_view bytes);

  /// Returns the hash of all bytes so far, 64 lower-case hexadecimal digits; more bytes may follow.
  [[nodiscard]] std::string hexadecimal() const;

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string sha256_of(std::string_view bytes);

/// Returns an empty value if the file cannot be read.
[[nodiscard]] std::optional<std::string> sha256_of_file(const std::filesystem::path& file);

// The data files that a run reads. Each is read completely here, so that the parsed bytes are those recorded in the
// run's provenance, and a file that differs from the checksums of its data directory is rejected.

struct FileRead {
  std::filesystem::path file;
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// Returns the files that this process has read so far, each once, in order of their paths.
[[nodiscard]] std::vector<FileRead> files_read();

/// Keeps files that this thread reads during its life from being recorded: those of missions that are inspected and not
/// flown.
class UnrecordedReads {
 public:
  UnrecordedReads();
  ~UnrecordedReads();
  UnrecordedReads(const UnrecordedReads&) = delete;
  UnrecordedReads& operator=(const UnrecordedReads&) = delete;
};

/// Records a file whose contents were read elsewhere. Throws std::runtime_error that names the file if a SHA256SUMS in
/// a folder above it lists other contents.
void note_file_read(const std::filesystem::path& file, std::string_view contents);

/// Replaces std::ifstream: the text of a file, whose contents as they lie on the disk are recorded. Its state is bad if
/// the file cannot be read; throws as note_file_read and plain_text.
class DataStream : public std::istringstream {
 public:
  explicit DataStream(const std::filesystem::path& file);
};

}  // namespace vbar::files
