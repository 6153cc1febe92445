#include "host_sim/faults/aid_watch.h"

#include <algorithm>

#include "fsw/packets/messages.h"

namespace vbar::faults {

using fsw::GpsTime;

void AidWatch::change(GpsTime time, std::int32_t aiding) {
  if (!changes_.empty() && changes_.back().time == time) {
    changes_.back().aiding = aiding;
  } else {
    changes_.push_back({time, aiding});
  }
}

void AidWatch::take(GpsTime time, const fsw::packets::PacketView& packet) {
  const std::int32_t present = changes_.empty() ? 0 : changes_.back().aiding;
  if (const auto health = fsw::packets::decode<telemetry_health>(packet); health.ok()) {
    // The computer began again: its events of this step, before the health packet or after it, still hold.
    if (health.value().step == 0 && has_stepped_) change(time, time == reported_at_ ? present & reported_ : 0);
    has_stepped_ = true;
    return;
  }
  const auto event = fsw::packets::decode<telemetry_event>(packet);
  if (!event.ok() || event.value().event != telemetry_event::kEventAid) return;
  const std::int32_t source = event.value().device;
  if (time != reported_at_) reported_ = 0;
  reported_at_ = time;
  reported_ |= source;
  const bool is_aiding = event.value().after == telemetry_event::kAidAiding;
  change(time, is_aiding ? present | source : present & ~source);
}

std::int32_t AidWatch::before(GpsTime time) const {
  const auto later = std::ranges::lower_bound(changes_, time, {}, &Change::time);
  return later == changes_.begin() ? 0 : std::prev(later)->aiding;
}

std::optional<GpsTime> AidWatch::first_with(std::int32_t sources, GpsTime from) const {
  auto change = std::ranges::upper_bound(changes_, from, {}, &Change::time);
  const std::int32_t present = change == changes_.begin() ? 0 : std::prev(change)->aiding;
  if ((present & sources) == sources) return from;
  change =
      std::find_if(change, changes_.end(), [sources](const Change& one) { return (one.aiding & sources) == sources; });
  return change == changes_.end() ? std::nullopt : std::optional(change->time);
}

}  // namespace vbar::faults
