#include "fsw/messaging/telecommands.h"

namespace vbar::fsw::messaging {
namespace {

// The last value stands for all: the list of vbar.lcm is that of the code.
static_assert(static_cast<int>(TelecommandStatus::kContradiction) == telemetry_telecommand::kStatusContradiction);

/// Returns whether `tag` has an older time, or the same time and an older sequence count, which wraps at 14 bits. A
/// repetition is not older.
bool is_older(const FilingTag& tag, const FilingTag& than) {
  if (tag.time != than.time) return tag.time < than.time;
  constexpr unsigned kCounts = 0x4000;
  return ((tag.sequence_count - than.sequence_count) & (kCounts - 1)) >= kCounts / 2;
}

}  // namespace

void Telecommands::update(GpsTime now, Inbox& inbox, const TelecommandRules& rules) {
  acknowledgment_count_ = 0;
  has_changed_ = false;
  packets::for_each_telecommand(
      [&]<class Message>() { propose_all(now, inbox, std::get<TelecommandCheck<Message>>(rules.checks)); });
  refuse_contradictions(rules);
  packets::for_each_telecommand([&]<class Message>() {
    for (Slot<Message>& slot : std::get<Slots<Message>>(slots_).units) {
      slot.is_new = slot.proposed.has_value() || (is_renewed_ && slot.value.has_value());
      if (!slot.is_new) continue;
      has_changed_ = true;
      if (!slot.proposed) continue;
      slot.value = slot.proposed;
      slot.tag = slot.proposed_tag;
      slot.proposed.reset();
    }
  });
  is_renewed_ = false;
  count_refusals(inbox);
}

void Telecommands::renew(GpsTime now) {
  is_renewed_ = true;
  packets::for_each_telecommand([&]<class Message>() {
    for (Slot<Message>& slot : std::get<Slots<Message>>(slots_).units) {
      if (slot.tag.time > now) slot.tag.time = now;
    }
  });
}

template <class Message>
void Telecommands::propose_all(GpsTime now, const Inbox& inbox, const TelecommandCheck<Message>& check) {
  const auto& queue = inbox.queue<Message>();
  for (std::size_t k = 0; k < queue.size(); ++k) {
    // Member by member: a copied aggregate would bring the padding of the stack into the state.
    Acknowledgment& acknowledgment = acknowledgments_[acknowledgment_count_++];
    acknowledgment.apid = packets::MessageTraits<Message>::kApid;
    acknowledgment.tag = queue[k].tag;
    acknowledgment.status = propose(now, queue[k].tag, queue[k].value, check);
  }
}

template <class Message>
TelecommandStatus Telecommands::propose(GpsTime now, const FilingTag& tag, const Message& message,
                                        const TelecommandCheck<Message>& check) {
  auto& units = std::get<Slots<Message>>(slots_).units;
  if (tag.time > now) return TelecommandStatus::kFuture;
  if (tag.unit >= units.size()) return TelecommandStatus::kUnknownUnit;
  Slot<Message>& slot = units[tag.unit];
  const bool is_superseded =
      (slot.value && is_older(tag, slot.tag)) || (slot.proposed && is_older(tag, slot.proposed_tag));
  if (is_superseded) return TelecommandStatus::kSuperseded;
  if (!check.is_valid(message)) return TelecommandStatus::kOutOfRange;
  slot.proposed = message;
  slot.proposed_tag = tag;
  return TelecommandStatus::kAccepted;
}

/// Those in force agree with each other, so that without the proposals nothing contradicts.
void Telecommands::refuse_contradictions(const TelecommandRules& rules) {
  for (const packets::Apid apid : rules.rejected_first) {
    if (rules.are_consistent(*this)) return;
    packets::for_each_telecommand([&]<class Message>() {
      if (packets::MessageTraits<Message>::kApid == apid) refuse_proposals<Message>();
    });
  }
}

template <class Message>
void Telecommands::refuse_proposals() {
  for (Slot<Message>& slot : std::get<Slots<Message>>(slots_).units) {
    if (!slot.proposed) continue;
    slot.proposed.reset();
    for (std::size_t k = 0; k < acknowledgment_count_; ++k) {
      Acknowledgment& acknowledgment = acknowledgments_[k];
      if (acknowledgment.apid == packets::MessageTraits<Message>::kApid && acknowledgment.tag == slot.proposed_tag) {
        acknowledgment.status = TelecommandStatus::kContradiction;
      }
    }
  }
}

void Telecommands::count_refusals(Inbox& inbox) const {
  for (std::size_t k = 0; k < acknowledgment_count_; ++k) {
    switch (acknowledgments_[k].status) {
      case TelecommandStatus::kAccepted:
        break;
      case TelecommandStatus::kFuture:
      case TelecommandStatus::kSuperseded:
        inbox.count_unusable_time();
        break;
      case TelecommandStatus::kUnknownUnit:
      case TelecommandStatus::kOutOfRange:
      case TelecommandStatus::kContradiction:
        inbox.count_bad_content();
        break;
    }
  }
}

void Telecommands::report(Outbox& outbox, std::int64_t step, GpsTime now) const {
  for (std::size_t k = 0; k < acknowledgment_count_; ++k) {
    const Acknowledgment& acknowledgment = acknowledgments_[k];
    telemetry_telecommand message{};
    message.step = step;
    message.time_tag_gps_ns = acknowledgment.tag.time.ns;
    message.apid = static_cast<std::int32_t>(acknowledgment.apid);
    message.sequence_count = static_cast<std::int32_t>(acknowledgment.tag.sequence_count);
    message.unit = static_cast<std::int16_t>(acknowledgment.tag.unit);
    message.status = static_cast<std::int8_t>(acknowledgment.status);
    outbox.send(now, message);
  }
}

}  // namespace vbar::fsw::messaging
