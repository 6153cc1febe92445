#pragma once
// A bench to calibrate, over its wires: the devices that the driver flies with.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/calibrate/procedure/calibration_bench.h"

namespace vbar::tron::calibrate {

struct WiredBenchSettings {
  BenchFile bench;
  std::string command;  ///< of an emulated bench; empty: hardware at the addresses of the bench file
  std::uint64_t seed = 1;
  std::filesystem::path data_directory;
  std::function<void(const std::string&)> report;  ///< sentences for the operator
  std::function<void(const std::string&)> ask;     ///< of a laboratory: returns when the operator has done it
};

class WiredBench final : public CalibrationBench {
 public:
  /// Starts an emulated bench and opens its devices. Throws std::runtime_error.
  explicit WiredBench(const WiredBenchSettings& settings);
  ~WiredBench() override;

  [[nodiscard]] BenchIdentity identity() override;
  void mount(Mounted what) override;
  [[nodiscard]] bool move(const Posture& posture) override;
  [[nodiscard]] BenchPlace measure() override;
  void light(const LightShares& shares) override;
  /// The whole sensor.
  [[nodiscard]] BenchImage take(double exposure_s) override;

  /// The table of true poses that an emulated bench writes; empty: there is none.
  [[nodiscard]] std::filesystem::path truth_file() const;
  /// From another thread or a signal: what waits throws.
  void stop() noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vbar::tron::calibrate
