#pragma once
// Section [testbed.tron] of a mission.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::tron {

struct TronSettings : mission::TestbedSettings {
  std::string bench;                                    ///< command line of the emulator; empty: hardware
  std::string laboratory = "{data}/benches/tron.toml";  ///< path of the bench file; {data} is replaced
  std::string calibration;                              ///< path; {data} and {seed} are replaced
  // Addresses; empty: for an emulator as its addresses.json states, by default as the bench file states.
  std::string camera_address, camera_robot_address, target_robot_address, lights_address;
  int trials = 400;             ///< placements tried for an image
  int max_hidden = 3;           ///< largest number of keypoints and centre hidden, in an image that is taken
  double settle_limit_s = 5.0;  ///< bench time for the arms to come to rest
  double correct_above_mm = 0.5, correct_above_deg = 0.02;  ///< errors of a pose, which is then corrected once
  double fail_above_mm = 5.0, fail_above_deg = 0.3;         ///< errors of a corrected pose
  int retries = 3;                                          ///< tries of a trigger
  int packet_size = 8000;
  std::chrono::milliseconds timeout{3000};     ///< wall clock: of a device that does not answer
  std::chrono::seconds operator_timeout{600};  ///< bench time: of a stop that the operator has to clear
};

/// Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_tron(const mission::TableReader& section);

/// Returns the file of the calibration. Throws MissionError if there is none.
[[nodiscard]] std::filesystem::path calibration_file(const TronSettings& settings,
                                                     const std::filesystem::path& data_directory, std::uint64_t seed);

/// Returns `path` with {data} and {seed} replaced.
[[nodiscard]] std::filesystem::path replaced(std::string path, const std::filesystem::path& data_directory,
                                             std::uint64_t seed);

}  // namespace vbar::tron
