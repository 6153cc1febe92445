#pragma once
// receive: decodes, checks and sorts each packet by its time tag. Packets are not processed until the step.

#include <array>
#include <cstdint>
#include <span>
#include <tuple>

#include "fsw/core/result.h"
#include "fsw/core/time_ordered_queue.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/security_trailer.h"
#include "fsw/vision/imaging/image_assembly.h"

namespace vbar::fsw::messaging {

/// Limits of times: instants from 1980 to 2126, and spans up to 115 days. Their sums and differences stay within int64.
inline constexpr GpsTime kLatestTime{std::int64_t{1} << 62};
inline constexpr Duration kLongestSpan = duration_of_seconds(10'000'000);
constexpr bool is_usable(GpsTime time) {
  return time.ns >= 0 && time <= kLatestTime;
}
constexpr bool is_usable(Duration span) {
  return span.ns > 0 && span <= kLongestSpan;
}

/// Counts the packets so far, for telemetry.
struct PacketCounters {
  std::int32_t accepted = 0;
  std::int32_t rejected_checksum = 0;
  std::int32_t rejected_type = 0;  ///< APID unknown or not for flight, or type hash of another message
  std::int32_t rejected_length = 0;
  std::int32_t rejected_content = 0;  ///< NaN, infinity, or a value (including a time tag) outside its valid range
  std::int32_t rejected_time = 0;     ///< time tag after the step, or not after the newest processed
  std::int32_t rejected_other = 0;    ///< of another spacecraft, or a duplicate
  std::int32_t dropped_full = 0;      ///< queue full: the newest is dropped
};

/// Holds the packets of the coming step: a queue of each message that message_list.h routes into one. A full queue
/// rejects the newest packet.
class Inbox {
 public:
  /// Largest number of packets of one message in a step.
  template <class Message>
  static constexpr std::size_t kCapacity = packets::MessageTraits<Message>::kRoute.capacity;
  template <class Message>
  using Queue = TimeOrderedQueue<Message, kCapacity<Message>>;

  explicit Inbox(std::uint8_t spacecraft);

  /// Accepts telecommands only with a valid security trailer from here on (security_trailer.h).
  void authenticate(const packets::TelecommandSecurity& security) { authentication_.require(security); }
  [[nodiscard]] const packets::TelecommandAuthentication& authentication() const { return authentication_; }

  /// Receives one packet. The status is the reason for a rejection. Never reads past `bytes`.
  Status receive(std::span<const std::uint8_t> bytes);

  /// Counts an entry that proved unusable at the step (late, or of the future).
  void count_unusable_time() { ++counters_.rejected_time; }

  /// Counts a telecommand whose content the step rejected.
  void count_bad_content() { ++counters_.rejected_content; }

  /// Discards all entries at the end of a step. Until the next step, expected at `next_step`, image tiles later than
  /// that are rejected: a tile of the far future would otherwise block all earlier ones.
  void clear(GpsTime next_step);

  [[nodiscard]] const PacketCounters& counters() const { return counters_; }
  /// Holds what outlives a step, for the snapshot.
  struct Retained {
    PacketCounters counters;
    Duration step_period;
    std::uint64_t telecommand_sequence = 0;
  };
  [[nodiscard]] Retained retained() const { return {counters_, step_period_, authentication_.sequence()}; }
  void restore(const Retained& retained) {
    counters_ = retained.counters;
    step_period_ = retained.step_period;
    authentication_.raise_sequence(retained.telecommand_sequence);
  }
  /// Returns the packets of one message, in order of their time tags.
  template <class Message>
  [[nodiscard]] const Queue<Message>& queue() const {
    return std::get<Queue<Message>>(queues_);
  }
  /// Returns the image of a camera (unit below kCameras) whose tiles arrived, complete or not.
  [[nodiscard]] const imaging::ImageAssembly& image(std::size_t camera) const { return images_[camera]; }
  /// Discards the image of a camera.
  void discard_image(std::size_t camera) { images_[camera].clear(); }
  /// Returns the time from the last tick to the next one; 0 before the first tick.
  [[nodiscard]] Duration step_period() const { return step_period_; }

 private:
  Status file(std::span<const std::uint8_t> bytes, const packets::PacketView& received);
  template <class Message>
  Status take(const packets::PacketView& packet);
  Status take_special(const packets::PacketHeader& header, const tick& message);
  Status take_special(const packets::PacketHeader& header, const image_tile& message);
  void count(Status status);

  std::uint8_t spacecraft_;
  packets::TelecommandAuthentication authentication_;
  PacketCounters counters_;
  Duration step_period_;
  packets::TupleOfRoute<&packets::has_queue, Queue>::Type queues_;
  std::array<imaging::ImageAssembly, packets::kCameras> images_;
};

}  // namespace vbar::fsw::messaging
