#pragma once
// Section [testbed.optical_stimulator] of a mission: display, camera and rails.

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::optical_stimulator {

struct OpticalStimulatorSettings : mission::TestbedSettings {
  std::string bench;        ///< command line of the emulator; empty: hardware, or a testbed that runs already
  std::string calibration;  ///< path of the calibration's file; {data} and {seed} are replaced
  // Addresses; empty: as addresses.json states.
  std::string camera_address, x_display, output;
  std::string rails;  ///< a tty, or host:port; empty: as the testbed says or, without a testbed, none
  int packet_size = 1400;
  std::optional<int> packet_delay_us;  ///< empty: as the socket's buffer needs
  std::chrono::nanoseconds settle{};   ///< from a picture on the screen to the trigger
  std::chrono::milliseconds timeout{};
  int retries = 3;
  bool any_exposure = false;  ///< exposures need not be whole frames of the display
  double white_electrons = 12000.0;
};

/// Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_optical_stimulator(const mission::TableReader& section);

/// Returns the file of the calibration.
[[nodiscard]] std::filesystem::path calibration_file(const OpticalStimulatorSettings& settings,
                                                     const std::filesystem::path& data_directory, std::uint64_t seed);

}  // namespace vbar::optical_stimulator
