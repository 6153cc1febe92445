#pragma once
// Receiver of the object stream of Vicon Tracker on a UDP port of this computer.

#include <memory>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/vicon/capture_source.h"

namespace vbar::tron::vicon {

class Receiver final : public CaptureSource {
 public:
  /// Listens on `settings.port` (0: any free one) of `address`. `rotation`: order of the angles, as the calibration
  /// found it; empty: as in the settings. Throws std::runtime_error, std::invalid_argument.
  explicit Receiver(const ViconSettings& settings, const std::string& rotation = {},
                    const std::string& address = "0.0.0.0");
  ~Receiver() override;

  [[nodiscard]] std::uint16_t port() const;

  void clear() override;
  int drain() override;
  int wait_for(int frames, std::chrono::milliseconds timeout) override;
  [[nodiscard]] CaptureAverage average(int frames, const Moved& moved) override;
  [[nodiscard]] CaptureCounts counts() const override;
  [[nodiscard]] std::string description() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vbar::tron::vicon
