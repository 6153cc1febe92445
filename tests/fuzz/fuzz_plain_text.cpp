// Data files as they lie on a disk, and messages with their text. Promise: text without a byte 0 and no longer than the
// limit, or one exception that names the file; a message without control characters.

#include <algorithm>
#include <exception>
#include <string>
#include <string_view>

#include "host_sim/files/text_lines.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLargest = 1 << 16;
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  const bool is_compressed = contents.starts_with("\x1f\x8b");
  try {
    const std::string text = vbar::files::plain_text(std::string(contents), "file.txt", kLargest);
    VBAR_FUZZ_EXPECT(text.find('\0') == std::string::npos);
    VBAR_FUZZ_EXPECT(text.size() <= (is_compressed ? kLargest : size));
  } catch (const std::exception& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).find("file.txt") != std::string_view::npos);
  }
  const std::string message = vbar::files::printable(contents);
  VBAR_FUZZ_EXPECT(message.size() <= size);
  VBAR_FUZZ_EXPECT(std::ranges::none_of(message, [](char c) { return (c >= '\0' && c < ' ') || c == '\x7f'; }));
  VBAR_FUZZ_EXPECT(vbar::files::printable(message) == message);
  return 0;
}
