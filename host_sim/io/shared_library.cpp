#include "host_sim/io/shared_library.h"

#include <stdexcept>

#include <dlfcn.h>

namespace vbar::io {
namespace {

std::string reason_of_loader() {
  const char* const reason = ::dlerror();
  return reason != nullptr ? reason : "unknown reason";
}

}  // namespace

SharedLibrary::SharedLibrary(const std::string& file, const std::string& purpose, const std::string& package)
    : file_(file),
      needed_(purpose + " needs it (Debian package " + package + ")"),
      handle_(::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) fail(reason_of_loader());
}

void* SharedLibrary::address_of(const char* name) const {
  void* const address = ::dlsym(handle_, name);
  if (address == nullptr) fail(reason_of_loader());
  return address;
}

/// The loader's reason begins with the file's name.
void SharedLibrary::fail(const std::string& reason) const {
  throw std::runtime_error((reason.starts_with(file_) ? reason : file_ + ": " + reason) + "; " + needed_);
}

}  // namespace vbar::io
