#include "pil_bridge/test_article.h"

#include <filesystem>

#include <dlfcn.h>

#include "pil_bridge/beside_program.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::pil {
namespace {

struct LoadedArticle {
  explicit LoadedArticle(void* library) : handle(library) {}
  LoadedArticle(const LoadedArticle&) = delete;
  LoadedArticle& operator=(const LoadedArticle&) = delete;
  ~LoadedArticle() { ::dlclose(handle); }

  void* handle;
  TestArticle functions;
};

template <class Function>
void resolve(const std::string& path, void* handle, const char* symbol, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(handle, symbol));
  if (function == nullptr) {
    throw FlightComputerError("flight_computer.library '" + path + "' has no function " + symbol +
                              " (fsw/gnc/vbar_gnc.h lists what it needs)");
  }
}

}  // namespace

std::string library_file(const std::string& library) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (library.find('/') != std::string::npos || library.ends_with(".so") || fs::exists(library, error)) return library;
  const std::string name = "lib" + library + ".so";
  return beside_program("../lib/vbar/" + name, name);
}

std::shared_ptr<const TestArticle> load_test_article(const std::string& library) {
  const std::string path = library_file(library);
  // With a slash in it, so that the loader takes the file named and does not search its own directories.
  const std::string file = std::filesystem::absolute(path).string();
  void* const handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* const reason = ::dlerror();
    throw FlightComputerError("flight_computer.library '" + path +
                              "' cannot be loaded: " + (reason != nullptr ? reason : "unknown reason"));
  }
  const auto article = std::make_shared<LoadedArticle>(handle);
  TestArticle& functions = article->functions;
  resolve(path, handle, "vbar_gnc_abi_version", functions.abi_version);
  resolve(path, handle, "vbar_gnc_name", functions.name);
  resolve(path, handle, "vbar_gnc_state_size", functions.state_size);
  resolve(path, handle, "vbar_gnc_state_alignment", functions.state_alignment);
  resolve(path, handle, "vbar_gnc_init", functions.init);
  resolve(path, handle, "vbar_gnc_set_sink", functions.set_sink);
  resolve(path, handle, "vbar_gnc_receive", functions.receive);
  resolve(path, handle, "vbar_gnc_step", functions.step);
  const std::int32_t version = functions.abi_version();
  if (version < VBAR_GNC_ABI_VERSION_MIN || version > VBAR_GNC_ABI_VERSION) {
    throw FlightComputerError("flight_computer.library '" + path + "' was built for version " +
                              std::to_string(version) + " of the test-article interface, this program for " +
                              std::to_string(VBAR_GNC_ABI_VERSION));
  }
  return {article, &functions};
}

}  // namespace vbar::pil
