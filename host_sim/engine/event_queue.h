#pragma once
// The event queue of a simulation: events ordered by (time, priority, insertion) and by nothing else, so that a run is
// the same on every computer. The type of the events is a parameter of the template. No event is
// scheduled in the past.

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"

namespace vbar::engine {

/// Names one scheduled event; its order is the order in which events happen.
struct EventId {
  fsw::GpsTime time;
  std::int32_t priority = 0;    ///< the smaller number happens first of two events at the same time
  std::uint64_t insertion = 0;  ///< the one scheduled first happens first of two events with the same time and priority
  auto operator<=>(const EventId&) const = default;
};

template <class Event>
class EventQueue {
 public:
  struct Entry {
    EventId id;
    Event event;
  };

  /// An empty queue at the time `now`.
  explicit EventQueue(fsw::GpsTime now) : now_(now) {}

  /// Schedules `event`. kOutOfRange: `time` lies before now().
  fsw::Result<EventId> schedule(fsw::GpsTime time, std::int32_t priority, Event event) {
    if (time < now_) return fsw::Status::kOutOfRange;
    const EventId id{time, priority, next_insertion_++};
    pending_.emplace(id, std::move(event));
    return id;
  }

  /// Cancels an event. False if it has occurred or was cancelled before.
  bool cancel(const EventId& id) { return pending_.erase(id) != 0; }

  /// Removes the next event and moves now() to its time; empty when nothing is scheduled.
  std::optional<Entry> pop() {
    if (pending_.empty()) return std::nullopt;
    auto node = pending_.extract(pending_.begin());
    now_ = node.key().time;
    return Entry{node.key(), std::move(node.mapped())};
  }

  /// Time of the next event.
  [[nodiscard]] std::optional<fsw::GpsTime> next_time() const {
    if (pending_.empty()) return std::nullopt;
    return pending_.begin()->first.time;
  }

  /// Time of the last event taken.
  [[nodiscard]] fsw::GpsTime now() const { return now_; }
  [[nodiscard]] std::size_t size() const { return pending_.size(); }
  [[nodiscard]] bool empty() const { return pending_.empty(); }

  /// Everything scheduled, in order.
  [[nodiscard]] const std::map<EventId, Event>& pending() const { return pending_; }

 private:
  std::map<EventId, Event> pending_;
  fsw::GpsTime now_;
  std::uint64_t next_insertion_ = 0;
};

}  // namespace vbar::engine
