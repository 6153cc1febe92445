#pragma once
// A directory of its own for the bench of a test, and reading of what lies on a line now.

#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <stdlib.h>
#include <unistd.h>

namespace vbar::test {

class EmulatorDirectory {
 public:
  EmulatorDirectory() {
    std::string pattern = (std::filesystem::temp_directory_path() / "vbar_bench_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = pattern;
  }
  ~EmulatorDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  EmulatorDirectory(const EmulatorDirectory&) = delete;
  EmulatorDirectory& operator=(const EmulatorDirectory&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// All bytes that a non-blocking descriptor gives at once.
inline std::string read_available(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t count = 0; (count = ::read(descriptor, buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(count));
  return text;
}

}  // namespace vbar::test
