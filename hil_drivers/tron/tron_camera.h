#pragma once
// Camera of the testbed as the image taker of a sensor.

#include <memory>
#include <utility>
#include <vector>

#include "hil_drivers/tron/tron_run.h"

namespace vbar::tron {

class TronCamera final : public twins::camera::ImageTaker {
 public:
  explicit TronCamera(std::shared_ptr<TronRun> run) : run_(std::move(run)) {}

  void start(fsw::GpsTime /*first_epoch*/) override { run_->start(); }
  void stop(twins::StopReason /*reason*/) override { run_->stop(); }
  twins::camera::TakenImage take(const twins::camera::Exposure& exposure) override { return run_->take(exposure); }
  [[nodiscard]] std::vector<twins::Note> statistics() const override { return run_->statistics(); }

 private:
  std::shared_ptr<TronRun> run_;
};

}  // namespace vbar::tron
