#pragma once
// The telecommands in force: the newest valid one of every kind and unit.
//
// A telecommand is checked in the step that it arrives for, stored, and acknowledged. Its users derive their settings
// from the store when it has changed, and combine telecommands that belong together when all of them are present.
// Neither the order in which telecommands arrive nor their distribution over steps has an effect. A rejected
// telecommand leaves the previous one in force.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/core/time_ordered_queue.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/outbox.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::messaging {

/// Statuses, with the numbers of telemetry_telecommand.status.
enum class TelecommandStatus : std::int8_t {
  kAccepted = 0,
  kFuture = 1,         ///< time tag after the step
  kSuperseded = 2,     ///< a newer one of its kind and unit is in force
  kUnknownUnit = 3,    ///< message_list.h states the number of units of each kind
  kOutOfRange = 4,     ///< telecommand_checks.h
  kContradiction = 5,  ///< valid alone, but not with another telecommand in force
};

class Telecommands;

/// Tests whether the values of a telecommand are within their valid ranges, by itself.
template <class Message>
struct TelecommandCheck {
  bool (*is_valid)(const Message& message) = nullptr;
};

/// States what the users of telecommands accept. The rules are passed to the store, which depends on no user.
struct TelecommandRules {
  packets::TupleOfRoute<&packets::is_telecommand, TelecommandCheck>::Type checks;  ///< one for each kind
  /// Tests whether the telecommands proposed or in force agree with each other.
  bool (*are_consistent)(const Telecommands& telecommands) = nullptr;
  std::array<packets::Apid, 3> rejected_first{};  ///< kinds that can contradict each other, in this order
};

class Telecommands {
 public:
  /// Checks and stores the telecommands of the step; the inbox counts those refused. Of two that contradict each other
  /// and arrive for the same step, the one listed later in message_list.h is refused.
  void update(GpsTime now, Inbox& inbox, const TelecommandRules& rules);

  /// Marks the telecommands in force as new for the next update, after a restart at `now`, so that their users derive
  /// their settings again. A later time tag, of a clock that has been set back, becomes that of the restart.
  void renew(GpsTime now);

  /// Returns the telecommand in force, or nullptr. `unit` must be below the number of units of its kind.
  template <class Message>
  [[nodiscard]] const Message* in_force(std::size_t unit = 0) const {
    const auto& value = slot<Message>(unit).value;
    return value ? &*value : nullptr;
  }
  /// The telecommand of this step that is valid by itself, or the one in force; nullptr without either. For the rules.
  template <class Message>
  [[nodiscard]] const Message* proposed_or_in_force(std::size_t unit) const {
    const auto& known = slot<Message>(unit);
    return known.proposed ? &*known.proposed : in_force<Message>(unit);
  }
  /// Time tag of the telecommand in force; 0 without one.
  template <class Message>
  [[nodiscard]] GpsTime time_of(std::size_t unit = 0) const {
    return slot<Message>(unit).tag.time;
  }
  /// Returns whether the last update replaced the telecommand.
  template <class Message>
  [[nodiscard]] bool is_new(std::size_t unit = 0) const {
    return slot<Message>(unit).is_new;
  }

  /// Returns whether the last update replaced any telecommand.
  [[nodiscard]] bool has_changed() const { return has_changed_; }

  /// Acknowledges each telecommand of the last update, in the order of message_list.h, then of time tags.
  void report(Outbox& outbox, std::int64_t step, GpsTime now) const;

 private:
  template <class Message>
  struct Slot {
    std::optional<Message> value;
    FilingTag tag;
    bool is_new = false;
    std::optional<Message> proposed;  ///< of the step, valid by itself
    FilingTag proposed_tag;
  };
  /// Holds the slots of all units of one kind.
  template <class Message>
  struct Slots {
    std::array<Slot<Message>, packets::MessageTraits<Message>::kRoute.units> units{};
  };
  struct Acknowledgment {
    packets::Apid apid = packets::Apid::kTick;
    FilingTag tag;
    TelecommandStatus status = TelecommandStatus::kAccepted;
  };
  static constexpr std::size_t kMaxAcknowledgments = [] {
    std::size_t sum = 0;
    packets::for_each_telecommand([&]<class Message>() { sum += Inbox::kCapacity<Message>; });
    return sum;
  }();

  template <class Message>
  [[nodiscard]] const Slot<Message>& slot(std::size_t unit) const {
    return std::get<Slots<Message>>(slots_).units[unit];
  }
  template <class Message>
  void propose_all(GpsTime now, const Inbox& inbox, const TelecommandCheck<Message>& check);
  template <class Message>
  TelecommandStatus propose(GpsTime now, const FilingTag& tag, const Message& message,
                            const TelecommandCheck<Message>& check);
  void refuse_contradictions(const TelecommandRules& rules);
  template <class Message>
  void refuse_proposals();
  void count_refusals(Inbox& inbox) const;

  packets::TupleOfRoute<&packets::is_telecommand, Slots>::Type slots_;
  std::array<Acknowledgment, kMaxAcknowledgments> acknowledgments_{};
  std::size_t acknowledgment_count_ = 0;
  bool has_changed_ = false;
  bool is_renewed_ = false;
};

}  // namespace vbar::fsw::messaging
