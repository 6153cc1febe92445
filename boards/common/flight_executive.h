#pragma once
// What every board runs: frames in, flight software stepped at the barrier, frames out (the board's side of
// fsw/link/frame.h). A board supplies a `Platform`; it has no other say in what happens.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"
#include "fsw/gnc/vbar_gnc.h"
#include "fsw/link/frame.h"

namespace vbar::boards {

/// Unit of Platform::counter, as step_report.unit has it.
enum class CounterUnit : std::int8_t { kNone = 0, kEmulatedTimerTicks = 1, kCycles = 2 };

/// What a board supplies. All functions get `context`; none may block for good.
struct Platform {
  void* context = nullptr;
  const char* name = "";  ///< ASCII, shown to the host
  void (*send)(void* context, std::span<const std::uint8_t> frame) = nullptr;  ///< one frame to the host, uncoded
  std::uint64_t (*counter)(void* context) = nullptr;                           ///< cost counter; may be null
  std::uint32_t (*stack_high_water)(void* context) = nullptr;                  ///< bytes; may be null
  CounterUnit counter_unit = CounterUnit::kNone;
};

/// Answer of a step, kept until the next step so that it can be sent again. Full: the newest packet is dropped, counted.
inline constexpr std::size_t kOutboxBytes = 128 * 1024;
inline constexpr std::size_t kOutboxPackets = 256;
/// Room for the flight software's state (vbar_gnc_state_size() must not exceed it).
inline constexpr std::size_t kGncStateBytes = 8 * 1024 * 1024;

enum class Activity : std::uint8_t { kIdle, kStepped, kGoodbye };

/// One per image, in static memory (it is large). Not thread-safe, not re-entrant.
class FlightExecutive {
 public:
  explicit FlightExecutive(const Platform& platform);

  /// Takes one received frame, whole and uncoded; sends what the protocol asks for; runs the step it completes.
  Activity on_frame(std::span<const std::uint8_t> frame);

  /// Frames a board dropped before they became frames (COBS errors, datagrams of strangers): into the step report.
  void count_rejected(std::uint32_t frames) { frames_rejected_ += frames; }

 private:
  static void sink(void* context, const std::uint8_t* packet, std::size_t size);
  // To be completed by the implementation.
  Platform platform_;
  std::uint32_t frames_rejected_ = 0;
};

}  // namespace vbar::boards
