#include "hil_drivers/grand/bench/receiver/log_list.h"

#include <algorithm>
#include <cmath>

namespace vbar::grand::bench {
namespace {

constexpr double kEpochsPerSecond = 100.0;
constexpr std::int64_t kMinPeriod = 5;  ///< 20 Hz

// Fields of the command LOG.
constexpr std::size_t kMessage = 1, kTrigger = 2, kPeriod = 3, kOffset = 4, kHold = 5;

bool accepts(const LogKind& kind, Trigger trigger) {
  switch (trigger) {
    case Trigger::kOnTime:
      return kind.log_class != LogClass::kEvent;
    case Trigger::kOnce:
    case Trigger::kOnNext:
      return true;
    case Trigger::kOnNew:
    case Trigger::kOnChanged:
      return kind.log_class == LogClass::kMessage || kind.log_class == LogClass::kEvent;
    case Trigger::kOnMark:
      return false;  // no mark input is emulated
  }
  return false;
}

Trigger default_trigger(const LogKind& kind) {
  const bool by_itself = kind.log_class == LogClass::kMessage || kind.log_class == LogClass::kEvent;
  return by_itself ? Trigger::kOnNew : Trigger::kOnce;
}

}  // namespace

Response LogList::add(const Command& command, int port) {
  LogRequest request;
  request.port = port;
  request.kind = find_log_kind(command.message_id(kMessage));
  if (request.kind == nullptr) return no_such_log();
  request.format = command.format(kMessage);
  if (request.format != LogFormat::kBinary && !request.kind->ascii) return no_such_log();
  request.trigger = command.whole(kTrigger) == kDefaultTrigger ? default_trigger(*request.kind)
                                                               : static_cast<Trigger>(command.whole(kTrigger));
  if (!accepts(*request.kind, request.trigger)) return invalid_trigger(kTrigger);
  if (request.trigger == Trigger::kOnTime) {
    const double period = command.values[kPeriod] * kEpochsPerSecond;
    const double offset = command.values[kOffset] * kEpochsPerSecond;
    request.period = std::llround(period);
    request.offset = std::llround(offset);
    // 20, 10, 5, 4, 2 Hz, or whole seconds.
    const bool whole_seconds = request.period % 100 == 0;
    if (std::abs(period - static_cast<double>(request.period)) > 1e-6 || request.period < kMinPeriod ||
        (!whole_seconds && 100 % request.period != 0) || request.period % kMinPeriod != 0)
      return invalid_rate();
    if (std::abs(offset - static_cast<double>(request.offset)) > 1e-6 || request.offset >= request.period ||
        request.offset % kMinPeriod != 0)
      return invalid_offset();
  }
  request.hold = command.whole(kHold) != 0;
  const auto same = std::ranges::find_if(requests_, [&request](const LogRequest& other) {
    return other.port == request.port && other.kind == request.kind && other.format == request.format;
  });
  if (same != requests_.end()) {
    *same = request;
    return {};
  }
  if (requests_.size() >= kMaxLogs) return not_enough_resources();
  requests_.push_back(request);
  return {};
}

void LogList::remove(int port, std::uint16_t id, LogFormat format) {
  std::erase_if(requests_, [&](const LogRequest& request) {
    return request.port == port && static_cast<std::uint16_t>(request.kind->id) == id && request.format == format;
  });
}

void LogList::remove_all(int port, bool held) {
  std::erase_if(requests_, [&](const LogRequest& request) {
    return (port < 0 || request.port == port) && (held || !request.hold);
  });
}

bool LogList::any_due_at(std::int64_t epoch) const {
  return std::ranges::any_of(requests_, [epoch](const LogRequest& request) { return request.due_at(epoch); });
}

}  // namespace vbar::grand::bench
