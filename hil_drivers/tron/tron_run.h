#pragma once
// TRON during one run: calibration, emulator process, devices, planning, and the images taken.

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/bench_process/bench_process.h"
#include "hil_drivers/testbed.h"
#include "hil_drivers/tron/calibration_file/calibration.h"
#include "hil_drivers/tron/exchange/image_exchange.h"
#include "hil_drivers/tron/hardware/wired_laboratory.h"
#include "hil_drivers/tron/image/image_finish.h"
#include "hil_drivers/tron/lights/room_light.h"
#include "hil_drivers/tron/planner/arm_planner.h"
#include "hil_drivers/tron/settings.h"
#include "hil_drivers/tron/tron_row.h"

namespace vbar::tron {

/// Returns the camera of the mission with the lens as calibrated, for the pixels of the mission, which are binned.
[[nodiscard]] twins::camera::CameraSettings calibrated_camera(const Calibration& calibration,
                                                              const twins::camera::CameraSettings& of_mission);

class TronRun final : public testbeds::TestbedRun, public std::enable_shared_from_this<TronRun> {
 public:
  TronRun(const TronSettings& settings, const testbeds::RunContext& context);
  ~TronRun() override;

  /// Makes the only camera. Throws std::runtime_error for a second one, and for a calibration that is not of this
  /// testbed.
  [[nodiscard]] std::unique_ptr<twins::camera::ImageTaker> make_camera(const testbeds::CameraPlan& plan) override;
  void begin(report::RunRecord& record, const std::filesystem::path& folder) override;
  void finish() noexcept override;

  // For the image taker.
  /// Starts the testbed and opens its devices. Throws std::runtime_error, one sentence.
  void start();
  /// Stops from another thread than take(), which then returns or throws.
  void stop() noexcept;
  twins::camera::TakenImage take(const twins::camera::Exposure& exposure);
  [[nodiscard]] std::vector<twins::Note> statistics() const;

 private:
  void open_devices();
  void check_calibration();
  [[nodiscard]] twins::camera::TakenImage taken(const twins::camera::Exposure& exposure, TronRow& row);
  void close() noexcept;

  TronSettings settings_;
  testbeds::RunContext context_;
  std::filesystem::path laboratory_file_, calibration_file_;
  BenchFile bench_;
  Calibration calibration_;
  std::optional<testbeds::CameraPlan> plan_;
  twins::camera::CameraSettings camera_;  ///< as calibrated
  double exposure_s_ = 0.0;               ///< in the laboratory
  std::string clock_;                     ///< clock of the testbed

  std::optional<bench_process::BenchProcess> process_;
  std::unique_ptr<WiredLaboratory> laboratory_;
  std::optional<ArmPlanner> planner_;
  std::optional<RoomLight> lights_;
  std::optional<ImageExchange> exchange_;
  std::optional<ImageFinish> finish_;

  report::RunRecord* record_ = nullptr;
  std::filesystem::path folder_;
  std::filesystem::path truth_file_;  ///< that an emulator writes
  mutable std::mutex mutex_;          // guards the rows, which take() adds
  std::vector<TronRow> rows_;
};

}  // namespace vbar::tron
