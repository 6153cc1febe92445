#pragma once
// An emulated GigE Vision camera: answers GVCP on UDP port 3956 of its address, exposes when it is triggered, and
// streams. It has one owner at a time, whose silence for the heartbeat's time releases it. Everything happens on the
// thread of the io_context, calls of this interface included.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "emulators/gige/acquisition.h"
#include "emulators/gige/features.h"
#include "hil_drivers/gige/protocol/gvcp.h"

namespace vbar::gige {

class Device {
 public:
  struct Settings {
    std::string address = "127.0.0.1";     ///< IPv4
    std::uint16_t port = wire::kGvcpPort;  ///< clients accept no other; 0 for tests: any free one
    Description description;
    Pace pace = Pace::kFast;
    double readout_s = 6.1e-3;  ///< whole sensor; a region takes the share of its rows
    std::uint64_t seed = 1;     ///< random stream of the packet faults
  };

  struct Statistics {
    std::int64_t commands = 0;
    std::int64_t commands_refused = 0;
    std::int64_t foreign_datagrams = 0;
    std::int64_t owners_expired = 0;  ///< by the heartbeat
    AcquisitionStatistics acquisition;
    StreamStatistics stream;
  };

  /// Throws std::runtime_error if the address is not available, std::invalid_argument for an invalid description.
  Device(boost::asio::io_context& context, const Settings& settings, Expose expose);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  // Faults, from now on.
  void set_packet_faults(const PacketFaults& faults);
  void set_answer_delay(std::chrono::milliseconds delay);
  /// Sets the camera away: it neither hears nor speaks, as with its cable pulled.
  void set_away(bool away);
  /// Sets the camera to be owned by another program.
  void set_busy(bool busy);
  void damage_xml(bool damaged);
  void set_exposure_factor(double factor);
  void refuse_region(bool refused);
  void ignore_triggers(int count);
  /// Loses the next frames: they are exposed and not sent, or the one before is sent in their place, with its time
  /// stamp.
  void lose_frames(int count);
  void repeat_frames(int count);
  /// Delays frames until after the next trigger (Acquisition::delay_frames).
  void delay_frames(int count, bool alone);
  /// Sets the type that blocks state; pixels do not change.
  void set_payload_type(wire::PayloadType type);

  [[nodiscard]] Statistics statistics() const;
  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] bool is_owned() const;

 private:
  class Control;
  std::unique_ptr<Control> control_;
};

// An emulated camera on a loopback address of its own.

struct PlacedDevice {
  std::string address;
  std::unique_ptr<Device> device;
};

/// Makes a device on the first address from <network>.1 that has no camera; `network`: three numbers, such as
/// "127.0.13". Throws std::runtime_error if there is none.
[[nodiscard]] PlacedDevice device_on_free_address(boost::asio::io_context& context, Device::Settings settings,
                                                  const std::string& network, const Expose& expose);

/// Returns eight digits of a random stream.
[[nodiscard]] std::string drawn_serial(std::uint64_t seed, const std::string& stream);

}  // namespace vbar::gige
