#include "tests/support/paths.h"

namespace vbar::tests {
namespace {

std::string below(std::string root, const std::string& relative) {
  if (!relative.empty()) root += '/' + relative;
  return root;
}

}  // namespace

std::string source_path(const std::string& relative) {
  return below(VBAR_SOURCE_DIR, relative);
}

std::string build_path(const std::string& relative) {
  return below(VBAR_BINARY_DIR, relative);
}

}  // namespace vbar::tests
