#pragma once
// TRON during one run: calibration, emulator process, devices, planning, and the images taken.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "hil_drivers/common/camera_run.h"
#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/imaging/image_exchange.h"
#include "hil_drivers/tron/imaging/image_finish.h"
#include "hil_drivers/tron/laboratory.h"
#include "hil_drivers/tron/lights/room_light.h"
#include "hil_drivers/tron/motion_planning/arm_planner.h"
#include "hil_drivers/tron/tron_report.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/sensors/testbed.h"

namespace vbar::tron {

// Section [testbed.tron] of a mission.

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
  testbeds::OnFailure on_failure = testbeds::OnFailure::kStop;
};

/// Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_tron(const mission::TableReader& section);

/// Returns the file of the calibration. Throws MissionError if there is none.
[[nodiscard]] std::filesystem::path calibration_file(const TronSettings& settings,
                                                     const std::filesystem::path& data_directory, std::uint64_t seed);

/// Returns `path` with {data} and {seed} replaced.
[[nodiscard]] std::filesystem::path replaced(std::string path, const std::filesystem::path& data_directory,
                                             std::uint64_t seed);

/// Returns the camera of the mission with the lens as calibrated, for the pixels of the mission, which are binned.
[[nodiscard]] twins::camera::CameraSettings calibrated_camera(const Calibration& calibration,
                                                              const twins::camera::CameraSettings& of_mission);

class TronRun final : public testbeds::CameraRun<TronRow, RunFigures> {
 public:
  TronRun(const TronSettings& settings, const testbeds::RunContext& context);
  ~TronRun() override;

 private:
  [[nodiscard]] twins::camera::CameraSettings calibrated_camera_of(const testbeds::CameraPlan& plan) override;
  void open() override;
  [[nodiscard]] twins::camera::TakenImage expose(const twins::camera::Exposure& exposure, TronRow& row) override;
  void stop() noexcept override;
  void close_devices() noexcept override;
  [[nodiscard]] RunFigures figures_of_run() override;

  void open_devices();
  void check_calibration();
  [[nodiscard]] twins::camera::TakenImage taken(const twins::camera::Exposure& exposure, TronRow& row);

  TronSettings settings_;
  std::filesystem::path laboratory_file_;
  TestbedDesign bench_;
  Calibration calibration_;
  double exposure_s_ = 0.0;  ///< in the laboratory
  std::string clock_;        ///< clock of the testbed

  std::unique_ptr<WiredDevices> laboratory_;
  std::optional<ArmPlanner> planner_;
  std::optional<RoomLight> lights_;
  std::optional<ImageExchange> exchange_;
  std::optional<ImageFinish> finish_;
};

// TRON as a testbed of missions.

extern const testbeds::TestbedKind kTron;

}  // namespace vbar::tron
