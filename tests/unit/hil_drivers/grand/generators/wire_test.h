#pragma once
// Bytes written by hand, and the message of a WireError.

#include <functional>
#include <string>
#include <string_view>

#include "hil_drivers/grand/wire/bytes.h"

namespace vbar::grand::wire::test {

/// "01 a0 ff" to bytes.
inline Bytes hex(std::string_view text) {
  Bytes bytes;
  for (std::size_t k = 0; k < text.size();) {
    if (text[k] == ' ' || text[k] == '\n') {
      ++k;
      continue;
    }
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(std::string(text.substr(k, 2)), nullptr, 16)));
    k += 2;
  }
  return bytes;
}

inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline std::string error_of(const std::function<void()>& use) {
  try {
    use();
  } catch (const WireError& error) {
    return error.what();
  }
  return "";
}

}  // namespace vbar::grand::wire::test
