#pragma once
// What another program says.

#include <array>
#include <cstdio>
#include <memory>
#include <string>

namespace vbar::report::test {

struct ProgramOutput {
  int status = -1;  ///< 0 if it ended well
  std::string text;
};

inline ProgramOutput output_of(const std::string& command) {
  ProgramOutput output;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    output.text.append(buffer.data(), size);
  }
  output.status = ::pclose(pipe);
  return output;
}

}  // namespace vbar::report::test
