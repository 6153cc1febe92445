#pragma once
// All devices of a testbed over their wires.

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/exchange/devices.h"
#include "hil_drivers/tron/hardware/addresses.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron {

struct DeviceSettings {
  BenchFile bench;
  std::string vicon_rotation;  ///< as the calibration found it; empty: as the bench file says
  bool is_emulated = false;    ///< an emulator: any free ports of this computer, by default those of the bench file
  twins::camera::Region region{160, 100, 1600, 1000};
  double exposure_s = 0.5e-3;
  int converter_bits = 12;
  int packet_size = 8000;
  int retries = 3;
  std::chrono::milliseconds timeout{3000};
  double settle_limit_s = 5.0;
  double operator_timeout_s = 600.0;
  std::function<void(const std::string&)> report;  ///< sentences for the operator
};

class WiredLaboratory final : public Laboratory {
 public:
  /// Listens for the robots and motion capture. Throws std::runtime_error.
  explicit WiredLaboratory(const DeviceSettings& settings);
  ~WiredLaboratory() override;

  /// Returns options for the command line of an emulator: the ports of this computer.
  [[nodiscard]] std::string port_options() const;

  /// Opens robots, lights and camera. Throws std::runtime_error.
  void open(const BenchAddresses& addresses);
  void close() noexcept;
  /// Stops from another thread: calls that wait return or throw.
  void stop() noexcept;

  [[nodiscard]] Posture posture() override;
  MotionEnd follow(const Motion& motion) override;
  MotionEnd hold(double bench_s) override;
  void recover() override;
  std::variant<MeasuredPlace, MotionEnd> measure() override;
  void light(const LightLevels& levels) override;
  BenchFrame take(double exposure_s) override;
  [[nodiscard]] double time_s() const override;

  /// Sends raw values, for calibration: lamp power, place, boxes.
  void light_values(const std::array<std::uint16_t, 2 + kBoxes>& values);
  /// Sets the conversion from light to DMX values; by default proportional.
  void set_light_values(std::function<std::array<std::uint16_t, 2 + kBoxes>(const LightLevels&)> values);

  /// Returns vendor, model, serial number.
  [[nodiscard]] std::string camera() const;
  [[nodiscard]] std::string camera_model() const;
  [[nodiscard]] std::string camera_serial() const;
  [[nodiscard]] bool camera_is_emulated() const;
  /// Returns counters of the devices, by name.
  [[nodiscard]] std::map<std::string, double> counts() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vbar::tron
