// Reading a run folder of which one file is the input; its first byte chooses the file. Promise: a record, or one
// std::runtime_error that names a file of the folder.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "host_sim/report/run_folder.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

namespace fs = std::filesystem;
using namespace vbar;

/// A complete run without rows, written once, and removed at the end of the program.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("vbar_fuzz_run_" + std::to_string(::getpid()));
  std::vector<fs::path> files;

  Folder() {
    report::RunRecord record;
    record.summary.mission = "fuzz";
    record.summary.complete = true;
    report::RunFolder(path, record.summary).finish(record);
    for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  if (size == 0) return 0;
  const fs::path& file = folder.files[data[0] % folder.files.size()];
  const fs::path aside = file.string() + ".aside";
  fs::rename(file, aside);
  std::ofstream(file, std::ios::binary) << std::string_view(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    static_cast<void>(report::read_run(folder.path));
  } catch (const std::runtime_error& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).find(folder.path.string()) != std::string_view::npos);
  }
  fs::rename(aside, file);
  return 0;
}
