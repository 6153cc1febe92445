#pragma once
// Optical Stimulator during one run: calibration, emulator process, display, camera, and the images taken.

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/bench_process/bench_process.h"
#include "hil_drivers/optical_stimulator/addresses.h"
#include "hil_drivers/optical_stimulator/bench_row.h"
#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"
#include "hil_drivers/optical_stimulator/exchange/exchange.h"
#include "hil_drivers/optical_stimulator/hardware/bench_devices.h"
#include "hil_drivers/optical_stimulator/scene/scene_pictures.h"
#include "hil_drivers/optical_stimulator/self_check/self_check.h"
#include "hil_drivers/optical_stimulator/settings.h"
#include "hil_drivers/testbed.h"

namespace vbar::optical_stimulator {

class StimulatorRun final : public testbeds::TestbedRun, public std::enable_shared_from_this<StimulatorRun> {
 public:
  StimulatorRun(const OpticalStimulatorSettings& settings, const testbeds::RunContext& context);
  ~StimulatorRun() override;

  /// Makes the only camera. Throws std::runtime_error for a second one, and for a calibration that is not of this
  /// camera.
  [[nodiscard]] std::unique_ptr<twins::camera::ImageTaker> make_camera(const testbeds::CameraPlan& plan) override;
  void begin(report::RunRecord& record, const std::filesystem::path& folder) override;
  void finish() noexcept override;

  // For the image taker.
  /// Starts the testbed, opens its devices and checks it. Throws std::runtime_error, one sentence.
  void start();
  /// Stops from another thread than take(), which then returns.
  void stop() noexcept;
  twins::camera::TakenImage take(const twins::camera::Exposure& exposure);
  [[nodiscard]] std::vector<twins::Note> statistics() const;

 private:
  void open_devices();
  void check_bench();
  void place_display(const DayCorrection& correction);
  [[nodiscard]] Exchange make_exchange() const;
  void close() noexcept;

  OpticalStimulatorSettings settings_;
  testbeds::RunContext context_;
  std::filesystem::path calibration_file_;
  std::optional<BenchCalibration> calibration_;
  std::optional<testbeds::CameraPlan> plan_;
  twins::camera::CameraSettings camera_;  ///< as calibrated
  std::optional<bench_process::BenchProcess> process_;
  std::optional<BenchDevices> devices_;
  std::optional<DisplayLight> light_;
  std::shared_ptr<const DisplayMap> map_;
  std::optional<FrameStrip> strip_;
  std::optional<Exchange> exchange_;
  std::optional<ScenePictures> pictures_;
  Picture picture_;
  std::optional<SelfCheckFigures> self_check_;
  report::RunRecord* record_ = nullptr;

  mutable std::mutex mutex_;  // guards the rows, which take() adds
  std::vector<BenchRow> rows_;
};

}  // namespace vbar::optical_stimulator
