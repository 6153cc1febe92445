#include "host_sim/files/error_lines.h"

#include <cstdio>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"

namespace vbar::files {

void print_error(std::string_view program, std::string_view message) {
  static_cast<void>(std::fputs(fmt::format("{}: {}\n", program, printable(message)).c_str(), stderr));
}

std::string parse_error_text(std::string_view message) {
  return fmt::format("{}\nRun with --help for more information.\n", printable(message));
}

}  // namespace vbar::files
