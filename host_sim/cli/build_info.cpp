#include "host_sim/cli/build_info.h"

namespace vbar::app {

std::string build_version() {
  return VBAR_VERSION;
}

std::string build_compiler() {
#ifdef __clang__
  return "Clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

std::string build_type() {
  return VBAR_BUILD_TYPE;
}

}  // namespace vbar::app
