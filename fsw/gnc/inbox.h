#pragma once
// receive: decode, check and file each packet by its time tag. Packets are not processed until the step.

#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/result.h"
#include "fsw/core/time_ordered_queue.h"
#include "fsw/imaging/image_assembly.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::gnc {

/// Instants from 1980 to 2126, and spans up to 115 days: their sums and differences stay within int64.
inline constexpr GpsTime kLatestTime{std::int64_t{1} << 62};
inline constexpr Duration kLongestSpan = duration_of_seconds(10'000'000);
constexpr bool is_usable(GpsTime time) {
  return time.ns >= 0 && time <= kLatestTime;
}
constexpr bool is_usable(Duration span) {
  return span.ns > 0 && span <= kLongestSpan;
}

/// Counters of the packets so far, for telemetry.
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

/// Packets of the coming step. A queue that is full refuses the newest packet.
class Inbox {
 public:
  static constexpr std::size_t kMeasurements = 64;
  static constexpr std::size_t kManeuvers = 32;
  static constexpr std::size_t kTelecommands = 4;
  static constexpr std::size_t kGnssPackets = 64;  ///< of each receiver, 82 kB: twenty epochs of eighty signals

  explicit Inbox(std::uint8_t spacecraft) : spacecraft_(spacecraft) { image_.accept_until(GpsTime{-1}); }

  /// Receives one packet; the status is the reason for a refusal. Never reads past `bytes`.
  Status receive(std::span<const std::uint8_t> bytes);

  /// Counts an entry that proved unusable at the step (late, or of the future).
  void count_unusable_time() { ++counters_.rejected_time; }

  /// Writes the newest entry of a queue into `kept`, which is unchanged if there is none. Entries tagged after `now`
  /// are counted as unusable.
  template <class Message, std::size_t kCapacity>
  void keep_newest(const TimeOrderedQueue<Message, kCapacity>& queue, GpsTime now, std::optional<Message>& kept) {
    for (std::size_t k = 0; k < queue.size(); ++k) {
      if (queue[k].tag.time > now) {
        count_unusable_time();
      } else {
        kept = queue[k].value;
      }
    }
  }

  /// Counts a telecommand whose content the step refused.
  void count_bad_content() { ++counters_.rejected_content; }

  /// Discards all entries at the end of a step. Until the next one, expected at `next_step`, image tiles later
  /// than that are refused: a tile of the far future would otherwise block all earlier ones.
  void clear(GpsTime next_step);

  [[nodiscard]] const PacketCounters& counters() const { return counters_; }
  [[nodiscard]] const TimeOrderedQueue<ideal_navigation, kMeasurements>& ideal_navigation_states() const {
    return ideal_navigation_;
  }
  [[nodiscard]] const TimeOrderedQueue<executed_maneuver, kManeuvers>& executed_maneuvers() const {
    return executed_maneuvers_;
  }
  [[nodiscard]] const TimeOrderedQueue<waypoint_table, kTelecommands>& waypoint_tables() const {
    return waypoint_tables_;
  }
  [[nodiscard]] const TimeOrderedQueue<gnc_configuration, kTelecommands>& configurations() const {
    return configurations_;
  }
  [[nodiscard]] const TimeOrderedQueue<mode_command, kTelecommands>& mode_commands() const { return mode_commands_; }
  [[nodiscard]] const TimeOrderedQueue<navigation_configuration, kTelecommands>& navigation_configurations() const {
    return navigation_configurations_;
  }
  [[nodiscard]] const TimeOrderedQueue<camera_configuration, kTelecommands>& camera_configurations() const {
    return camera_configurations_;
  }
  [[nodiscard]] const TimeOrderedQueue<angles_only_configuration, kTelecommands>& angles_only_configurations() const {
    return angles_only_configurations_;
  }
  [[nodiscard]] const TimeOrderedQueue<target_apriori, kTelecommands>& target_aprioris() const {
    return target_aprioris_;
  }
  [[nodiscard]] const TimeOrderedQueue<pose_configuration, kTelecommands>& pose_configurations() const {
    return pose_configurations_;
  }
  [[nodiscard]] const TimeOrderedQueue<gnss_bytes, kGnssPackets>& gnss_bytes_packets() const { return gnss_bytes_; }
  [[nodiscard]] const TimeOrderedQueue<crosslink_gnss_bytes, kGnssPackets>& crosslink_gnss_bytes_packets() const {
    return crosslink_gnss_bytes_;
  }
  [[nodiscard]] const TimeOrderedQueue<attitude, kMeasurements>& attitudes() const { return attitudes_; }
  [[nodiscard]] const TimeOrderedQueue<crosslink_attitude, kMeasurements>& crosslink_attitudes() const {
    return crosslink_attitudes_;
  }
  /// The image whose tiles arrived, complete or not.
  [[nodiscard]] const imaging::ImageAssembly& image() const { return image_; }
  /// Time from the last tick to the next one; 0 before the first tick.
  [[nodiscard]] Duration step_period() const { return step_period_; }

 private:
  Status file(const packets::PacketView& packet);
  void count(Status status);

  std::uint8_t spacecraft_;
  PacketCounters counters_;
  Duration step_period_;
  TimeOrderedQueue<ideal_navigation, kMeasurements> ideal_navigation_;
  TimeOrderedQueue<executed_maneuver, kManeuvers> executed_maneuvers_;
  TimeOrderedQueue<waypoint_table, kTelecommands> waypoint_tables_;
  TimeOrderedQueue<gnc_configuration, kTelecommands> configurations_;
  TimeOrderedQueue<mode_command, kTelecommands> mode_commands_;
  TimeOrderedQueue<navigation_configuration, kTelecommands> navigation_configurations_;
  TimeOrderedQueue<camera_configuration, kTelecommands> camera_configurations_;
  TimeOrderedQueue<angles_only_configuration, kTelecommands> angles_only_configurations_;
  TimeOrderedQueue<target_apriori, kTelecommands> target_aprioris_;
  TimeOrderedQueue<pose_configuration, kTelecommands> pose_configurations_;
  TimeOrderedQueue<gnss_bytes, kGnssPackets> gnss_bytes_;
  TimeOrderedQueue<crosslink_gnss_bytes, kGnssPackets> crosslink_gnss_bytes_;
  TimeOrderedQueue<attitude, kMeasurements> attitudes_;
  TimeOrderedQueue<crosslink_attitude, kMeasurements> crosslink_attitudes_;
  imaging::ImageAssembly image_;
};

}  // namespace vbar::fsw::gnc
