#pragma once

#include <string>
#include <string_view>

namespace vbar::files {

/// `text` with every `what`, which is not empty, in it replaced.
[[nodiscard]] inline std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

}  // namespace vbar::files
