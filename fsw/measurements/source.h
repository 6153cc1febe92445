#pragma once
// What every measurement source has in common: its records wait in one queue, in order of their time tags, until the
// relative navigation filter reaches them.
//
// A source is a folder with a class that offers
//
//   static constexpr std::int32_t kUse              its bit of navigation_configuration.sources
//   bool configure(Configuration)                   settings from the telecommands in force; false: not complete
//   void collect(Context&, RecordFiler)             packets of the step -> records
//   void process_record(record, context, filter)    measurements of a record; the filter stands at its time
//   void watch(GpsTime now, filter)                 after the records of the step: silence
//   void stop(GpsTime now, filter)                  not selected any more: deactivates its own blocks
//   optional<GpsTime> pending_since(GpsTime now)    the oldest time of which a record may still come
//   Aid& aid()                                      its state
//   void report(const Telemetry&) const             its telemetry
//
// with is_valid(telecommand) for each of its telecommands, a place in source_list.h, and places of its state blocks in
// state_blocks.h.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/gnss/gnss_front_end.h"
#include "fsw/measurements/aid.h"
#include "fsw/measurements/pointing.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/outbox.h"
#include "fsw/messaging/telecommands.h"

namespace vbar::fsw::measurements {

/// A measurement that waits to be processed; its content is with its source, under `number`.
struct Record {
  GpsTime time;
  std::uint32_t source = 0;
  std::uint32_t number = 0;
  constexpr auto operator<=>(const Record&) const = default;
};
// Without padding, which a copy may take from the stack into a snapshot.
static_assert(std::has_unique_object_representations_v<Record>);

/// Records in order of time, then of source and number: the order of arrival has no effect.
class RecordQueue {
 public:
  static constexpr std::size_t kCapacity = 128;

  /// kFull; kBadSequence if the record is there already.
  Status file(const Record& record) {
    std::size_t place = count_;
    while (place > 0 && record < records_[place - 1]) --place;
    if (place > 0 && records_[place - 1] == record) return Status::kBadSequence;
    if (count_ == kCapacity) return Status::kFull;
    for (std::size_t k = count_; k > place; --k) records_[k] = records_[k - 1];
    records_[place] = record;
    ++count_;
    return Status::kOk;
  }
  [[nodiscard]] const Record* front() const { return count_ == 0 ? nullptr : records_.data(); }
  void pop() {
    for (std::size_t k = 1; k < count_; ++k) records_[k - 1] = records_[k];
    --count_;
  }
  [[nodiscard]] std::size_t size() const { return count_; }

 private:
  std::array<Record, kCapacity> records_{};
  std::size_t count_ = 0;
};

/// Files the records of one source.
class RecordFiler {
 public:
  RecordFiler(RecordQueue& queue, std::uint8_t source) : queue_(queue), source_(source) {}
  Status file(GpsTime time, std::uint32_t number) { return queue_.file({time, source_, number}); }

 private:
  RecordQueue& queue_;
  std::uint8_t source_;
};

/// The telecommands in force, and the settings of the filter, of which a source sets those of its own blocks.
struct Configuration {
  const messaging::Telecommands& telecommands;
  filter::FilterSettings& settings;
};

/// Pointing and attitudes, as all sources need them.
struct Platform {
  std::optional<Pointing> pointing;  ///< of the servicer's camera: commanded, valid until the next command
  measurements::AttitudeHistory servicer_attitude;
  measurements::AttitudeHistory target_attitude;  ///< by the crosslink
};

/// A step, as seen by a source.
struct Context {
  GpsTime now;
  messaging::Inbox& inbox;
  Platform& platform;
  gnss::GnssFrontEnd& gnss;
};

/// Where a source writes its telemetry at the end of a step, and what it needs for that.
struct Telemetry {
  messaging::Outbox& outbox;
  std::int64_t step = 0;
  GpsTime now;
  const messaging::Inbox& inbox;
  const gnss::GnssFrontEnd& gnss;
  const filter::RelativeNavigationFilter& filter;
};

/// Largest delay of a record with respect to its time tag.
inline constexpr Duration kLongestDelay = duration_of_seconds(600);

}  // namespace vbar::fsw::measurements
