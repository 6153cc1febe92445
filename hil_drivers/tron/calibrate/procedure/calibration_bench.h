#pragma once
// Interface of a testbed to its calibration, over its wires or simulated.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/calibrate/data/measurement.h"

namespace vbar::tron::calibrate {

/// Names what the plate of the target's arm carries.
enum class Mounted { kTarget, kBoard };

/// Holds values of the lights, shares of the largest, not of light.
struct LightShares {
  double lamp = 0.0;
  double lamp_azimuth_rad = 0.0;
  std::array<double, kBoxes> boxes{};
};

struct BenchImage {
  int width = 0, height = 0, bits = 12;
  std::vector<std::uint16_t> dn;  ///< rows from the top
};

struct BenchPlace {
  Posture posture;  ///< as the controllers state it, at rest
  std::optional<ViconObjects> vicon;
};

struct BenchIdentity {
  std::string camera_model, camera_serial;
  bool is_emulated = false;
};

/// Gives a calibration access to a testbed. All functions throw std::runtime_error, one sentence that names the device,
/// if the testbed cannot go on.
class CalibrationBench {
 public:
  CalibrationBench() = default;
  CalibrationBench(const CalibrationBench&) = delete;
  CalibrationBench& operator=(const CalibrationBench&) = delete;
  virtual ~CalibrationBench() = default;

  [[nodiscard]] virtual BenchIdentity identity() = 0;
  /// Mounts mock-up or board: an emulator does it by itself; at a real testbed the operator is asked to.
  virtual void mount(Mounted what) = 0;
  /// Moves and waits until the arms have settled; false: there is no way without a collision.
  [[nodiscard]] virtual bool move(const Posture& posture) = 0;
  [[nodiscard]] virtual BenchPlace measure() = 0;
  /// Waits until the lights act.
  virtual void light(const LightShares& shares) = 0;
  [[nodiscard]] virtual BenchImage take(double exposure_s) = 0;
};

}  // namespace vbar::tron::calibrate
