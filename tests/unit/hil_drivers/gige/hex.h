#pragma once

#include <string>
#include <string_view>

#include "hil_drivers/gige/protocol/big_endian.h"

namespace vbar::gige::wire::test {

/// "01 a0 ff" to bytes.
inline Bytes hex(std::string_view text) {
  Bytes bytes;
  for (std::size_t k = 0; k + 1 < text.size();) {
    if (text[k] == ' ') {
      ++k;
      continue;
    }
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(std::string(text.substr(k, 2)), nullptr, 16)));
    k += 2;
  }
  return bytes;
}

}  // namespace vbar::gige::wire::test
