#pragma once
// Pictures that the display shows while the camera exposes, and the faults of a display.

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "hil_drivers/optical_stimulator/bench/light/light_path.h"

namespace vbar::optical_stimulator::bench {

struct PanelFaults {
  bool is_late = false;     ///< shows what the screen held at the exposure before
  bool is_frozen = false;   ///< shows what it showed last before the fault
  bool is_covered = false;  ///< a window of another program lies over its middle
  bool is_mirrored = false;
  bool is_rotated = false;  ///< by 180 deg

  friend bool operator==(const PanelFaults&, const PanelFaults&) = default;
};

/// Holds a picture of the screen during an exposure, with its part of the light.
struct Picture {
  std::shared_ptr<const std::vector<std::uint8_t>> counts;
  double fraction = 1.0;
};
using Pictures = std::vector<Picture>;

class Panel {
 public:
  Panel(int width, int height) : width_(width), height_(height) {}

  /// Returns what the panel shows of `pictures`, which were on the screen during the exposure.
  [[nodiscard]] Pictures show(Pictures pictures, const PanelFaults& faults);

 private:
  [[nodiscard]] Picture with(const Picture& picture, const PanelFaults& faults) const;

  int width_, height_;
  Pictures screen_before_;  ///< on the screen at the exposure before
  Pictures shown_before_;   ///< shown at the last exposure without a frozen display
};

}  // namespace vbar::optical_stimulator::bench
