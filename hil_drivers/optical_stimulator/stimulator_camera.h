#pragma once
// Camera of the testbed as the image taker of a sensor.

#include <memory>
#include <utility>
#include <vector>

#include "hil_drivers/optical_stimulator/stimulator_run.h"

namespace vbar::optical_stimulator {

class StimulatorCamera final : public twins::camera::ImageTaker {
 public:
  explicit StimulatorCamera(std::shared_ptr<StimulatorRun> run) : run_(std::move(run)) {}

  void start(fsw::GpsTime /*first_epoch*/) override { run_->start(); }
  void stop(twins::StopReason /*reason*/) override { run_->stop(); }
  twins::camera::TakenImage take(const twins::camera::Exposure& exposure) override { return run_->take(exposure); }
  [[nodiscard]] std::vector<twins::Note> statistics() const override { return run_->statistics(); }

 private:
  std::shared_ptr<StimulatorRun> run_;
};

}  // namespace vbar::optical_stimulator
