#pragma once
// The log of a recorded run against which a repetition of the run is compared, event by event.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/lcm_log.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::twins {

/// Error: records are missing from the middle of a log; the message names file and place.
class IncompleteLog : public DamagedLog {
 public:
  using DamagedLog::DamagedLog;
};

/// Error: the repetition differs from the log; the message names step and packet.
class RunDiffers : public std::runtime_error {
 public:
  RunDiffers(fsw::GpsTime time, const std::string& what) : std::runtime_error(what), time_(time) {}
  [[nodiscard]] fsw::GpsTime time() const { return time_; }

 private:
  fsw::GpsTime time_;
};

class RunLog {
 public:
  /// Reads the log once: event numbers, steps, times, messages and checksums have to be consistent. A log that is cut
  /// or damaged at its end, with no event after that place, counts until there. Throws DamagedLog or IncompleteLog for
  /// damage elsewhere, and std::runtime_error that names a file that cannot be read.
  explicit RunLog(const std::filesystem::path& file);

  /// Returns the number of events before the damage or cut, the end excepted.
  [[nodiscard]] std::uint64_t events() const { return events_; }
  /// Number of steps that the run began, from 0 on, and the time of the last one.
  [[nodiscard]] std::uint32_t steps() const { return steps_; }
  [[nodiscard]] fsw::GpsTime time() const { return time_; }
  /// Whether the run closed the log.
  [[nodiscard]] bool has_end() const { return has_end_; }
  /// Returns the byte from which on it is damaged or cut.
  [[nodiscard]] std::optional<std::uint64_t> damaged_from() const { return damaged_from_; }

  /// Limits the comparison: nothing from this time on is compared.
  void compare_before(fsw::GpsTime time) { until_ = lcm_timestamp(time); }

  /// Compares the next event of the repetition (twins::EventCheck). Throws RunDiffers, or DamagedLog if it differs
  /// from an event whose checksum is wrong.
  void compare(fsw::GpsTime time, const LcmEvent& flown);

  /// Whether everything that was to be compared has been, and was identical.
  [[nodiscard]] bool is_over() const { return is_over_; }

 private:
  std::optional<LoggedEvent> next_intact();
  void check(const LoggedEvent& event);
  void check_record(const LoggedEvent& event);
  [[noreturn]] void part(fsw::GpsTime time, const LcmEvent& flown, const LoggedEvent* logged);

  std::filesystem::path file_;
  LcmLogReader reader_;
  std::uint64_t events_ = 0, compared_ = 0;
  std::uint32_t steps_ = 0;
  fsw::GpsTime time_;
  bool has_end_ = false, is_over_ = false;
  std::optional<std::uint64_t> damaged_from_;
  std::optional<LcmEvent> message_;  ///< that has to follow the last packet
  std::int64_t until_ = std::numeric_limits<std::int64_t>::max();
};

}  // namespace vbar::twins
