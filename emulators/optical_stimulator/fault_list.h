#pragma once
// Faults of a session: started when they are due, in effect for a number of exposures or seconds, acknowledged when
// they have taken effect, on the control line and as one line of JSON in a file.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "emulators/common/faults.h"
#include "emulators/optical_stimulator/faults.h"
#include "emulators/optical_stimulator/screen.h"

namespace vbar::optical_stimulator::bench {

/// Holds the effect of faults on one exposure.
struct ExposureFaults {
  PanelFaults panel;
  double exposure_factor = 1.0, gain_factor = 1.0, brightness_factor = 1.0;
};

/// Holds the parts of the emulator that faults other than those of an exposure act on.
struct FaultActions {
  /// Sets a fault of the camera's link: on with its value, off.
  std::function<void(const Fault& fault, bool is_on)> camera;
  std::function<void(double x_um, double y_um)> bump;
  std::function<void(std::size_t axis)> stall_rail;
  std::function<void(std::size_t axis, double um)> move_rail;
  std::function<std::uint64_t(std::size_t axis)> rail_stalls;  ///< so far
  std::function<void()> exit;
};

class FaultList {
 public:
  using Acknowledge = emulators::Acknowledge;

  /// Opens `file`, which gets a line for each fault that took effect. Throws std::runtime_error if it cannot be made.
  FaultList(FaultActions actions, const std::filesystem::path& file);

  /// Adds a fault. `now_s`: on any clock, the same in all calls.
  void add(const Fault& fault, double now_s, Acknowledge acknowledge = {});

  /// Begins the faults that are due before exposure number `frame`.
  [[nodiscard]] ExposureFaults begin_exposure(std::uint64_t frame, double now_s);
  /// Ends the faults whose exposures have passed.
  void end_exposure(std::uint64_t frame);
  /// Ends faults whose time has passed, and looks for effects, between exposures.
  void advance(double now_s);
  /// Returns true if any fault has been injected.
  [[nodiscard]] bool has_any() const { return !active_.empty(); }

 private:
  struct Active {
    Fault fault;
    Acknowledge acknowledge;
    bool has_begun = false, has_ended = false, is_acknowledged = false;
    std::uint64_t begun_frame = 0;
    double begun_s = 0.0;
    std::uint64_t stalls_before = 0;
  };
  void begin(Active& active, std::uint64_t frame, double now_s);
  void act(const Fault& fault, bool is_on);
  void acknowledge(Active& active, std::uint64_t frame);

  FaultActions actions_;
  emulators::FaultLog log_;
  std::vector<Active> active_;
  std::uint64_t next_frame_ = 0;
};

}  // namespace vbar::optical_stimulator::bench
