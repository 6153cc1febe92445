#pragma once
// The flight software through its C interface, as a board or a simulation holds it, and what it answered to a step.

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "fsw/messaging/vbar_gnc.h"
#include "tests/unit/fsw/messaging/packet_factory.h"

namespace vbar::fsw::gnc::test {

struct Command {
  GpsTime time;
  maneuver_command message;
};

/// Of one image.
struct PoseReport {
  std::uint8_t unit = 0;  ///< of the camera
  GpsTime time;
  telemetry_pose message{};
};

/// Everything one step said.
struct Answer {
  vbar_status status = 0;
  std::vector<Bytes> packets;
  std::vector<Command> commands;
  telemetry_navigation navigation{};
  telemetry_control control{};
  telemetry_health health{};
  telemetry_safety safety{};
  std::vector<telemetry_telecommand> acknowledgments;
  std::vector<telemetry_event> events;
  std::vector<PoseReport> poses;
  int telemetry_count = 0;  ///< three a step, one of each kind; without acknowledgments, events and those of sources
};

class Article {
 public:
  Article();

  vbar_status deliver(const Bytes& packet);
  template <class Message>
  vbar_status deliver(GpsTime time, const Message& message, std::uint16_t sequence = 0) {
    return deliver(packet_of(time, message, sequence));
  }

  /// Delivers a tick that promises the next step after `period`, and runs the step.
  Answer step(GpsTime now, Duration period);
  /// Runs the step without a tick.
  Answer step_without_tick(GpsTime now);

  /// The bytes of the whole state.
  [[nodiscard]] std::vector<std::byte> save() const;
  /// Puts saved bytes in place of the state, and this article's own sink in place of the one they name.
  void restore(const std::vector<std::byte>& saved);

  /// The snapshot of the interface in C, and a restart from it.
  [[nodiscard]] std::vector<std::uint8_t> snapshot() const;
  vbar_status restore_snapshot(const std::vector<std::uint8_t>& snapshot);

  /// The complete state, for upsets of its memory.
  [[nodiscard]] void* memory() { return state_.get(); }

  /// What the memory of a new article, and the stack below each call, contains.
  static inline int fill = 0;

  /// Called with true just before, and with false just after, each delivery and step; may be null.
  void (*around_flight_code)(bool entering) = nullptr;

 private:
  template <class Call>
  vbar_status watched(Call call) {
    fill_stack();
    if (around_flight_code != nullptr) around_flight_code(true);
    const vbar_status status = call();
    if (around_flight_code != nullptr) around_flight_code(false);
    return status;
  }
  struct Free {
    void operator()(std::byte* state) const;
  };
  /// Outgoing packets as they come, without an allocation inside the flight software's step.
  struct Tray {
    static constexpr std::size_t kPackets = 64;
    std::array<std::array<std::uint8_t, packets::kMaxPacketBytes>, kPackets> bytes;
    std::array<std::size_t, kPackets> size;
    std::size_t count = 0;
  };
  /// What flight code does not initialise is then the same in all calls, and another one with another `fill`.
  static void fill_stack();
  static void sink(void* tray, const std::uint8_t* packet, std::size_t size);
  Answer collect(vbar_status status);

  std::unique_ptr<Tray> tray_;
  std::unique_ptr<std::byte[], Free> state_;
};

}  // namespace vbar::fsw::gnc::test
