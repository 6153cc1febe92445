#pragma once
// A testbed with one camera during one run: the order of its start, its images and its end, and what becomes of its
// emulator's process. A driver adds its devices.

#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "hil_drivers/common/emulator_process.h"
#include "host_sim/sensors/testbed.h"

namespace vbar::testbeds {

/// `Row`: of the table that the testbed leaves, one for each image, with `time_s` and `image`. `Figures`: of the whole
/// run, with `bench_files` and `faults`, which add_figures(figures, record) of its namespace adds to the record.
template <class Row, class Figures>
class CameraRun : public TestbedRun, public std::enable_shared_from_this<CameraRun<Row, Figures>> {
 public:
  /// Makes the only camera. Throws std::runtime_error for a second one, and for a calibration that is not of it.
  [[nodiscard]] std::unique_ptr<twins::camera::ImageTaker> make_camera(const CameraPlan& plan) final {
    if (plan_) throw error_of("it has one camera, and " + plan.name + " is a second");
    camera_ = calibrated_camera_of(plan);
    plan_ = plan;
    return std::make_unique<Camera>(this->shared_from_this());
  }

  void begin(report::RunRecord& record, const std::filesystem::path& folder) final {
    record_ = &record;
    folder_ = folder;
  }

  void finish() noexcept final {
    if (record_ == nullptr) return;
    try {
      Figures figures = figures_of_run();
      close();
      if (process_) {
        figures.bench_files = process_->files();
        figures.faults = process_->faults();
      }
      const std::scoped_lock lock(mutex_);
      record_->tables.template rows<Row>() = rows_;
      add_figures(figures, *record_);
    } catch (...) {
      // Without memory for its figures the run still ends in order.
    }
    record_ = nullptr;
  }

 protected:
  /// `name`: of the testbed, in messages. `wait`: the duration whose sum the packet log keeps, by its name.
  CameraRun(std::string name, const RunContext& context, std::filesystem::path calibration_file,
            std::pair<const char*, double Row::*> wait)
      : context_(context),
        calibration_file_(std::move(calibration_file)),
        name_("testbed " + std::move(name) + ": "),
        wait_(std::move(wait)) {}

  /// Returns the camera of the plan as calibrated. Throws std::runtime_error, as the following two functions do.
  [[nodiscard]] virtual twins::camera::CameraSettings calibrated_camera_of(const CameraPlan& plan) = 0;
  /// Starts the emulator, if the mission names one, opens the devices, and checks that the calibration is of them.
  virtual void open() = 0;
  /// Returns the image and completes its row.
  [[nodiscard]] virtual twins::camera::TakenImage expose(const twins::camera::Exposure& exposure, Row& row) = 0;
  /// Ends what waits in expose(), from another thread, which then returns or throws.
  virtual void stop() noexcept = 0;
  virtual void close_devices() noexcept = 0;
  /// Returns the figures of the devices, which are still open.
  [[nodiscard]] virtual Figures figures_of_run() = 0;

  /// Closes the devices and ends the emulator. For the destructor of the driver.
  void close() noexcept {
    if (process_) process_->end_watch();
    close_devices();
    if (process_) process_->stop();
  }

  [[nodiscard]] std::runtime_error error_of(const std::string& reason) const {
    return std::runtime_error(name_ + reason);
  }

  RunContext context_;
  std::filesystem::path calibration_file_;
  std::filesystem::path folder_;  ///< of the run; empty: none
  std::optional<CameraPlan> plan_;
  twins::camera::CameraSettings camera_;  ///< as calibrated
  std::optional<EmulatorProcess> process_;

 private:
  class Camera final : public twins::camera::ImageTaker {
   public:
    explicit Camera(std::shared_ptr<CameraRun> run) : run_(std::move(run)) {}
    void start(fsw::GpsTime /*first_epoch*/) override { run_->start(); }
    void stop(twins::StopReason /*reason*/) override { run_->stop(); }
    twins::camera::TakenImage take(const twins::camera::Exposure& exposure) override { return run_->take(exposure); }
    [[nodiscard]] std::vector<twins::Note> statistics() const override { return run_->statistics(); }

   private:
    std::shared_ptr<CameraRun> run_;
  };

  void start() {
    try {
      open();
      if (process_) process_->watch([this] { stop(); });
    } catch (const std::runtime_error& error) {
      const std::runtime_error cause = cause_of(error, {});
      close();
      throw cause;
    }
  }

  twins::camera::TakenImage take(const twins::camera::Exposure& exposure) {
    Row row;
    row.time_s = fsw::seconds(exposure.time - context_.mission.epoch);
    row.image = exposure.number;
    try {
      twins::camera::TakenImage image = expose(exposure, row);
      if (const auto end = process_ && !image.failure.empty() ? process_->end_report() : std::nullopt)
        throw std::runtime_error(*end);
      const std::scoped_lock lock(mutex_);
      rows_.push_back(std::move(row));
      return image;
    } catch (const std::runtime_error& error) {
      constexpr std::chrono::milliseconds kEnd{300};  // its connections are closed before its end is known
      throw cause_of(error, kEnd);
    }
  }

  /// The end of the emulator's process is the cause of all other failures.
  [[nodiscard]] std::runtime_error cause_of(const std::runtime_error& error, std::chrono::milliseconds patience) {
    const auto end = process_ ? process_->end_report(patience) : std::nullopt;
    return error_of(end ? *end : error.what());
  }

  [[nodiscard]] std::vector<twins::Note> statistics() const {
    const std::scoped_lock lock(mutex_);
    double sum_s = 0.0;
    for (const Row& row : rows_) sum_s += row.*wait_.second;
    return {{wait_.first, sum_s}};
  }

  std::string name_;
  std::pair<const char*, double Row::*> wait_;
  report::RunRecord* record_ = nullptr;
  mutable std::mutex mutex_;  // guards the rows, which take() adds
  std::vector<Row> rows_;
};

}  // namespace vbar::testbeds
