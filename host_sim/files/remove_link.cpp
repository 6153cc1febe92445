#include "host_sim/files/remove_link.h"

#include <stdexcept>
#include <system_error>

namespace vbar::files {

void remove_link(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_symlink(std::filesystem::symlink_status(file, error))) return;
  if (!std::filesystem::remove(file, error) && error)
    throw std::runtime_error(file.string() + ": is a symbolic link that cannot be removed: " + error.message());
}

}  // namespace vbar::files
