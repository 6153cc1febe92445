#pragma once
// Origin of a run: program, mission, data, flight software, computer. It stands in summary.json from the run's
// first moment; data files and packet log are added at the end.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace vbar::report {

struct FileDigest {
  std::string file;  ///< data: relative to the data directory where it stands in it
  std::uint64_t bytes = 0;
  std::string sha256;
  friend bool operator==(const FileDigest&, const FileDigest&) = default;
};

struct Provenance {
  std::string vbar_version, commit, compiler, build_type;
  std::string host, started_utc, epoch_utc;
  std::vector<std::string> overrides;  ///< "path=value", as given
  std::string mission_sha256;          ///< hash of mission.toml in the run folder
  std::string program_sha256;
  std::optional<FileDigest> flight_software;  ///< the library or image that flew; none: in the program, or on a board
  std::vector<FileDigest> testbed;            ///< program and scenario of an emulated bench
  std::vector<FileDigest> data;
  std::optional<FileDigest> packet_log;
  friend bool operator==(const Provenance&, const Provenance&) = default;
};

/// Returns an empty value if the file cannot be read.
[[nodiscard]] std::optional<FileDigest> digest_of(const std::filesystem::path& file);

}  // namespace vbar::report
