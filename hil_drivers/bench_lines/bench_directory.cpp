#include "hil_drivers/bench_lines/bench_directory.h"

#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

namespace vbar::bench_lines {
namespace {

std::filesystem::path existing(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory))
    throw std::runtime_error(fmt::format("{}: this directory cannot be made: {}", directory.string(), error.message()));
  return std::filesystem::absolute(directory);
}

}  // namespace

BenchDirectory::BenchDirectory(const std::filesystem::path& directory) : path_(existing(directory)) {}

BenchDirectory::~BenchDirectory() {
  std::error_code ignored;
  std::filesystem::remove(path_ / kAddressesFile, ignored);
}

void BenchDirectory::write_addresses(const std::string& json) const {
  const std::filesystem::path file = path_ / kAddressesFile;
  const std::filesystem::path partial = file.string() + ".partial";
  std::ofstream out(partial);
  out << json << "\n";
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", partial.string()));
  std::filesystem::rename(partial, file);
}

}  // namespace vbar::bench_lines
