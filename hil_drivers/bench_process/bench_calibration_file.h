#pragma once
// File of the calibration that a mission names for its testbed.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace vbar::bench_process {

/// Command that makes a calibration of a testbed.
struct CalibrationCommand {
  std::string_view testbed;  ///< table of the mission: "testbed.tron"
  std::string command;  ///< with {N} for the seed and {out} for the file or its folder: of the emulated bench or of the
                        ///< hardware
  std::string_view duration;
};

/// Returns `path` with {data} and {seed} replaced: relative to the working directory or, if there is no such file, to
/// the data folder, which has the calibration of the emulated TRON for seed 1. Throws a MissionError with the command
/// that makes the file if it is in neither.
[[nodiscard]] std::filesystem::path bench_calibration_file(const std::string& path,
                                                           const std::filesystem::path& data_directory,
                                                           std::uint64_t seed, const CalibrationCommand& made_by);

}  // namespace vbar::bench_process
