#include "host_sim/files/write_error.h"

#include <cerrno>
#include <system_error>

namespace vbar::files {

std::runtime_error write_error(const std::filesystem::path& file) {
  std::string text = file.string() + ": cannot be written";
  if (errno != 0) text += ": " + std::generic_category().message(errno);
  return std::runtime_error(text);
}

}  // namespace vbar::files
