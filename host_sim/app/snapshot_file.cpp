#include "host_sim/app/snapshot_file.h"

#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "host_sim/app/exit_codes.h"

namespace vbar::app {
namespace {

constexpr auto kFirstWord = "vbar-snapshot";

}  // namespace

void write_snapshot(const std::filesystem::path& file, const Snapshot& snapshot) {
  std::ofstream out(file, std::ios::binary);
  out << kFirstWord << ' ' << snapshot.next_step << ' ' << snapshot.bytes.size() << '\n';
  out.write(reinterpret_cast<const char*>(snapshot.bytes.data()), static_cast<std::streamsize>(snapshot.bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
}

Snapshot read_snapshot(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Refused(fmt::format("{}: cannot be read", file.string()));
  std::string line;
  std::getline(in, line);
  std::istringstream words(line);
  std::string first;
  std::size_t size = 0;
  Snapshot snapshot;
  if (!(words >> first >> snapshot.next_step >> size) || first != kFirstWord)
    throw Refused(fmt::format("{}: is no snapshot (vbar replay --save writes one)", file.string()));
  snapshot.bytes.assign(std::istreambuf_iterator<char>(in), {});
  if (snapshot.bytes.size() != size)
    throw Refused(fmt::format("{}: {} bytes of {}", file.string(), snapshot.bytes.size(), size));
  return snapshot;
}

}  // namespace vbar::app
