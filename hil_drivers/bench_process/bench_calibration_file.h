#pragma once
// The file of the calibration that a mission names for its bench.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace vbar::bench_process {

/// How a calibration of a bench is made.
struct CalibrationCommand {
  std::string_view testbed;  ///< table of the mission: "testbed.tron"
  std::string command;  ///< with {N} for the seed and {out} for the file or its folder: of the emulated bench or of the
                        ///< hardware
  std::string_view duration;
};

/// `path` with {data} and {seed} replaced: relative to the working directory or, if there is none, to the data folder,
/// which has that of the emulated TRON for seed 1. Throws MissionError with the command that makes it if it
/// is in neither.
[[nodiscard]] std::filesystem::path bench_calibration_file(const std::string& path,
                                                           const std::filesystem::path& data_directory,
                                                           std::uint64_t seed, const CalibrationCommand& made_by);

}  // namespace vbar::bench_process
