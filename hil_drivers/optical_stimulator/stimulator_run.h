#pragma once
// Optical Stimulator during one run: calibration, emulator process, display, camera, and the images taken.

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "hil_drivers/common/camera_run.h"
#include "hil_drivers/optical_stimulator/hardware/devices.h"
#include "hil_drivers/optical_stimulator/imaging/image_exchange.h"
#include "hil_drivers/optical_stimulator/imaging/self_check.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "hil_drivers/optical_stimulator/pictures/scene_pictures.h"
#include "hil_drivers/optical_stimulator/stimulator_report.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/sensors/testbed.h"

namespace vbar::optical_stimulator {

// Section [testbed.optical_stimulator] of a mission: display, camera and rails.

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
  testbeds::OnFailure on_failure = testbeds::OnFailure::kStop;
};

/// Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_optical_stimulator(const mission::TableReader& section);

/// Returns the file of the calibration.
[[nodiscard]] std::filesystem::path calibration_file(const OpticalStimulatorSettings& settings,
                                                     const std::filesystem::path& data_directory, std::uint64_t seed);

class StimulatorRun final : public testbeds::CameraRun<StimulatorRow, RunFigures> {
 public:
  StimulatorRun(const OpticalStimulatorSettings& settings, const testbeds::RunContext& context);
  ~StimulatorRun() override;

 private:
  [[nodiscard]] twins::camera::CameraSettings calibrated_camera_of(const testbeds::CameraPlan& plan) override;
  void open() override;
  [[nodiscard]] twins::camera::TakenImage expose(const twins::camera::Exposure& exposure, StimulatorRow& row) override;
  void stop() noexcept override;
  void close_devices() noexcept override;
  [[nodiscard]] RunFigures figures_of_run() override;

  void open_devices();
  void check_bench();
  void place_display(const DayCorrection& correction);

  OpticalStimulatorSettings settings_;
  std::optional<StimulatorCalibration> calibration_;
  std::optional<StimulatorDevices> devices_;
  std::optional<DisplayLight> light_;
  std::shared_ptr<const DisplayMap> map_;
  std::optional<FrameStrip> strip_;
  std::optional<Exchange> exchange_;
  std::optional<ScenePictures> pictures_;
  Picture picture_;
  std::optional<SelfCheckFigures> self_check_;
};

// [testbed.optical_stimulator], registered in ../testbeds.cpp.

extern const testbeds::TestbedKind kOpticalStimulator;

}  // namespace vbar::optical_stimulator
