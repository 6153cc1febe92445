#pragma once
// Origin of a run: program, mission, data, flight software, computer. It stands in summary.json from the run's
// first moment; data files and packet log are added at the end.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/files/data_stream.h"

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

// Hashes that make two runs the same: SHA-256 over the bytes of all maneuver commands, and over those of all telemetry.

class OutputHash {
 public:
  /// A packet from the flight software, in its order. Its APID alone decides where it counts, so that a damaged packet
  /// changes the hash instead of vanishing from it. Packets to the flight software and step reports count nowhere.
  void add(std::span<const std::uint8_t> packet);

  /// Returns the hash of all packets so far, 64 lower-case hexadecimal digits.
  [[nodiscard]] std::string commands_sha256() const;
  [[nodiscard]] std::string telemetry_sha256() const;

 private:
  files::Sha256 commands_, telemetry_;
};

}  // namespace vbar::report
