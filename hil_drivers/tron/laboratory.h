#pragma once
// All devices of a testbed over their wires.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/imaging/devices.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron {

// Addresses of the devices of a testbed: an emulator writes them to addresses.json, a real testbed has them in its
// bench file.

struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;
};

struct TestbedAddresses {
  bool is_virtual = false;                ///< the clock of an emulator
  std::string camera;                     ///< IP address
  TcpAddress camera_robot, target_robot;  ///< Ethernet KRL
  TcpAddress lights;                      ///< sACN, UDP
  std::filesystem::path control;          ///< socket of an emulator; empty: none
};

[[nodiscard]] TestbedAddresses addresses_of(const TestbedDesign& bench);
/// Throws std::runtime_error that names the file.
[[nodiscard]] TestbedAddresses read_addresses(const std::filesystem::path& file);
/// Parses "host:port"; throws std::runtime_error.
[[nodiscard]] TcpAddress parse_address(const std::string& text);

struct DeviceSettings {
  TestbedDesign bench;
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

class WiredDevices final : public Laboratory {
 public:
  /// Listens for the robots and motion capture. Throws std::runtime_error.
  explicit WiredDevices(const DeviceSettings& settings);
  ~WiredDevices() override;

  /// Returns options for the command line of an emulator: the ports of this computer.
  [[nodiscard]] std::string port_options() const;

  /// Opens robots, lights and camera. Throws std::runtime_error.
  void open(const TestbedAddresses& addresses);
  void close() noexcept;
  /// Stops from another thread: calls that wait return or throw.
  void stop() noexcept;

  [[nodiscard]] Posture posture() override;
  MotionEnd follow(const Motion& motion) override;
  MotionEnd hold(double bench_s) override;
  void recover() override;
  std::variant<MeasuredPlace, MotionEnd> measure() override;
  void light(const LightLevels& levels) override;
  DetectorFrame take(double exposure_s) override;
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
