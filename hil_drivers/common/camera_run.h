#pragma once
// A testbed with one camera during one run: the order of its start, its images and its end, what becomes of its
// emulator's process, and the digital twin that takes over from it. A driver adds its devices.
//
// The testbed is started and checked before the run. It is parked while its next image is more than an hour away, and
// started and checked again for that image.

#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/common/testbed_use.h"
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
      close_with_figures();
      const std::scoped_lock lock(mutex_);
      record_->tables.template rows<Row>() = rows_;
      add_figures(figures_, *record_);
      use_.add_to(record_->summary.testbeds[kind_]);
    } catch (...) {
      // Without memory for its figures the run still ends in order.
    }
    record_ = nullptr;
  }

 protected:
  /// `kind`: of the testbed. `wait`: the duration whose sum the packet log keeps, by its name.
  CameraRun(std::string kind, const RunContext& context, std::filesystem::path calibration_file,
            std::pair<const char*, double Row::*> wait, OnFailure on_failure)
      : context_(context),
        calibration_file_(std::move(calibration_file)),
        kind_(std::move(kind)),
        wait_(std::move(wait)),
        on_failure_(on_failure) {}

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
    return std::runtime_error("testbed " + kind_ + ": " + reason);
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
    void start(fsw::GpsTime first_epoch) override { run_->start(first_epoch); }
    void stop(twins::StopReason /*reason*/) override { run_->end(); }
    twins::camera::TakenImage take(const twins::camera::Exposure& exposure) override { return run_->take(exposure); }
    [[nodiscard]] std::vector<twins::Note> statistics() const override { return run_->statistics(); }

   private:
    std::shared_ptr<CameraRun> run_;
  };

  void start(fsw::GpsTime first_epoch) {
    start_testbed();
    if (is_idle_after(context_.mission, plan_->name, first_epoch)) close_with_figures();
  }

  void start_testbed() {
    const auto begin = std::chrono::steady_clock::now();
    try {
      const std::scoped_lock lock(devices_);
      is_open_ = true;
      open();
      if (process_) process_->watch([this] { stop_devices(); });
    } catch (const std::runtime_error& error) {
      const std::runtime_error cause = cause_of(error, {});
      close_testbed();
      throw cause;
    }
    use_.start_wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  /// Ends what waits in expose(), from another thread.
  void stop_devices() noexcept {
    const std::scoped_lock lock(devices_);
    stop();
  }

  void end() noexcept {
    is_ending_ = true;
    stop_devices();
  }

  /// Keeps the figures of a testbed that is open, and closes it.
  void close_with_figures() {
    if (!is_open_) return;
    figures_ = figures_of_run();
    close_testbed();
  }

  void close_testbed() {
    if (process_) process_->end_watch();  // before the lock, for which its thread may wait
    const std::scoped_lock lock(devices_);
    close();
    is_open_ = false;
    if (!process_) return;
    figures_.bench_files = process_->files();
    figures_.faults = process_->faults();
    process_.reset();
  }

  twins::camera::TakenImage take(const twins::camera::Exposure& exposure) {
    if (twin_) return twin_->take(exposure);
    std::vector<twins::Note> notes;
    twins::camera::TakenImage image;
    try {
      if (!is_open_ && !is_ending_) {
        start_testbed();
        use_.started_h = hours_of(exposure.time);
        notes.push_back({"testbed_start_wall_s", use_.start_wall_s, kind_});
      }
      image = take_by_testbed(exposure);
    } catch (const std::runtime_error& error) {
      if (on_failure_ == OnFailure::kStop || is_ending_) throw;
      hand_over(exposure.time, error.what());
      notes.push_back(event("testbed_handed_over", error.what()));
      image = twin_->take(exposure);
    }
    if (is_open_ && is_idle_after(context_.mission, plan_->name, exposure.time)) {
      close_with_figures();
      use_.parked_h = hours_of(exposure.time);
      notes.push_back(event("testbed_parked", kind_));
    }
    image.notes.insert(image.notes.end(), notes.begin(), notes.end());
    return image;
  }

  twins::camera::TakenImage take_by_testbed(const twins::camera::Exposure& exposure) {
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

  /// The twin has the calibrated camera, which the flight software is configured for.
  void hand_over(fsw::GpsTime time, const std::string& reason) {
    std::cerr << reason << "; the digital twin of " << plan_->name << " takes over\n";
    use_.handed_over_h = hours_of(time);
    use_.failure = reason;
    close_with_figures();
    twins::camera::ImageMaker::Settings settings;
    settings.camera = camera_;
    settings.name = plan_->name;
    settings.seed = context_.mission.seed;
    twin_ = std::make_unique<twins::camera::ImageMaker>(
        settings, [scene = std::shared_ptr(plan_->make_scene(camera_, nullptr))](
                      const twins::camera::Exposure& exposure, twins::camera::PhotonImage& photons) {
          scene->render(exposure, photons);
        });
  }

  [[nodiscard]] double hours_of(fsw::GpsTime time) const {
    return fsw::seconds(time - context_.mission.epoch) / 3600.0;
  }

  [[nodiscard]] static twins::Note event(std::string name, std::string text) {
    return {std::move(name), std::numeric_limits<double>::quiet_NaN(), std::move(text)};
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

  std::string kind_;
  std::pair<const char*, double Row::*> wait_;
  OnFailure on_failure_;
  std::atomic<bool> is_ending_ = false;
  std::mutex devices_;  ///< held while they are opened and closed, so that stop() meets them whole
  bool is_open_ = false;
  Figures figures_;  ///< of the last session
  TestbedUse use_;
  std::unique_ptr<twins::camera::ImageMaker> twin_;  ///< once it has taken over
  report::RunRecord* record_ = nullptr;
  mutable std::mutex mutex_;  // guards the rows, which take() adds
  std::vector<Row> rows_;
};

}  // namespace vbar::testbeds
