#pragma once
// An input as a file, in memory.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "tests/fuzz/fuzz_target.h"

namespace vbar::fuzz {

class File {
 public:
  explicit File(std::span<const std::uint8_t> bytes) : descriptor_(::memfd_create("fuzz", 0)) {
    VBAR_FUZZ_EXPECT(descriptor_ >= 0);
    while (!bytes.empty()) {
      const ssize_t size = ::write(descriptor_, bytes.data(), bytes.size());
      VBAR_FUZZ_EXPECT(size > 0);
      bytes = bytes.subspan(static_cast<std::size_t>(size));
    }
  }
  ~File() { ::close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace vbar::fuzz
