#include "hil_drivers/bench_process/bench_calibration_file.h"

#include "host_sim/files/replaced.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::bench_process {

std::filesystem::path bench_calibration_file(const std::string& path, const std::filesystem::path& data_directory,
                                             std::uint64_t seed, const CalibrationCommand& made_by) {
  const std::filesystem::path file =
      files::replaced(files::replaced(path, "{data}", data_directory.string()), "{seed}", std::to_string(seed));
  std::error_code error;
  if (std::filesystem::exists(file, error)) return file;
  if (std::filesystem::path bundled = data_directory / file; std::filesystem::exists(bundled, error)) return bundled;
  // The placeholders of the bench's own command line stay.
  const std::string command =
      files::replaced(files::replaced(made_by.command, "{N}", std::to_string(seed)), "{out}", file.string());
  throw mission::MissionError(
      file.string(), std::string(made_by.testbed) + ".calibration",
      "no such file here, nor in " + data_directory.string(),
      "a calibration of this bench, made in " + std::string(made_by.duration) + " by: " + command);
}

}  // namespace vbar::bench_process
