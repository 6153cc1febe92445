#pragma once
// Interface of a testbed to its calibration. Behind it are the wires of a real or emulated testbed, or a model in a
// test.

#include <cstdint>
#include <vector>

#include "hil_drivers/optical_stimulator/calibrate/dots.h"

namespace vbar::optical_stimulator::calibrate {

class Screen {
 public:
  virtual ~Screen() = default;
  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual int height() const = 0;
  /// Returns when the light of these counts has settled.
  virtual void show(const Picture& counts) = 0;
};

class Eye {
 public:
  virtual ~Eye() = default;
  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual int height() const = 0;
  [[nodiscard]] virtual int bits() const = 0;
  /// Takes an image of the whole detector, right-aligned DN.
  [[nodiscard]] virtual std::vector<std::uint16_t> take(double exposure_s) = 0;
};

class Rails {
 public:
  virtual ~Rails() = default;
  virtual void home() = 0;
  /// Moves both axes, always from the same side, and waits until they are there.
  virtual void move_to(double lens_mm, double display_mm) = 0;
};

}  // namespace vbar::optical_stimulator::calibrate
