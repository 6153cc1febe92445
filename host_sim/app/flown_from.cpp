#include "host_sim/app/flown_from.h"

#include <array>
#include <ctime>
#include <optional>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/app/build_info.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/own_program.h"
#include "host_sim/files/sha256.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

/// Returns an empty value if the program cannot be read. A resume needs it twice, and it takes a tenth of a second.
const std::optional<std::string>& program_sha256() {
  static const std::optional<std::string> sha256 = files::sha256_of_file(files::own_program_bytes());
  return sha256;
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string utc_now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", utc);
}

fs::path data_root() {
  return fs::absolute(mission::data_directory()).lexically_normal();
}

std::string short_hash(const std::string& sha256) {
  return sha256.substr(0, 16);
}

void compare(const std::string& what, const std::string& then, const std::optional<std::string>& now,
             std::vector<std::string>& changes) {
  if (then.empty() || now == then) return;
  changes.push_back(now ? fmt::format("{} differs from that of the run (SHA-256 {}..., then {}...)", what,
                                      short_hash(*now), short_hash(then))
                        : fmt::format("{} cannot be read, but the run had it", what));
}

}  // namespace

report::Provenance provenance_of(const mission::Mission& mission, const std::vector<std::string>& overrides,
                                 const std::string& mission_text) {
  report::Provenance provenance;
  provenance.vbar_version = build_version();
  provenance.commit = kBuildCommit;
  provenance.compiler = build_compiler();
  provenance.build_type = build_type();
  provenance.host = host_name();
  provenance.started_utc = utc_now();
  provenance.epoch_utc = truth::format_utc(mission.epoch);
  provenance.overrides = overrides;
  provenance.mission_sha256 = files::sha256_of(mission_text);
  provenance.program_sha256 = program_sha256().value_or("");
  const std::string file = flight_software_file(flying_spacecraft(mission));
  if (!file.empty()) provenance.flight_software = report::digest_of(file);
  return provenance;
}

std::vector<report::FileDigest> data_read() {
  const fs::path root = data_root();
  std::vector<report::FileDigest> data;
  for (const files::FileRead& read : files::files_read()) {
    const fs::path relative = read.file.lexically_relative(root);
    const bool inside = !relative.empty() && *relative.begin() != "..";
    data.push_back({inside ? relative.string() : read.file.string(), read.bytes, read.sha256});
  }
  return data;
}

std::vector<std::string> changes_since(const report::Provenance& then, const fs::path& mission_copy,
                                       const std::string& flight_software_now) {
  std::vector<std::string> changes;
  if (!then.program_sha256.empty() && program_sha256() != then.program_sha256)
    changes.push_back(
        fmt::format("this program (commit {}) is not the one that flew (commit {})", kBuildCommit, then.commit));
  compare(mission_copy.string(), then.mission_sha256, files::sha256_of_file(mission_copy), changes);
  if (then.flight_software && flight_software_now == then.flight_software->file)
    compare(flight_software_now, then.flight_software->sha256, files::sha256_of_file(flight_software_now), changes);
  for (const report::FileDigest& file : then.data)
    compare("data file " + file.file, file.sha256, files::sha256_of_file(data_root() / file.file), changes);
  return changes;
}

}  // namespace vbar::app
