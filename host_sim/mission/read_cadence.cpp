#include "host_sim/mission/read_cadence.h"

#include <utility>
#include <vector>

#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

constexpr std::size_t kMaxPeriods = 32;

/// Parts that end before the start of the mission are of no effect; the one in force at the start begins there.
engine::Cadence from_start(std::vector<engine::Cadence::Part> parts, fsw::GpsTime start) {
  while (parts.size() > 1 && parts[1].from <= start) parts.erase(parts.begin());
  if (parts.front().from < start) parts.front().from = start;
  return engine::Cadence(std::move(parts));
}

}  // namespace

engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s, const Mission& mission,
                             const engine::Cadence& default_value) {
  if (!section.has(key)) return default_value;
  if (!section.is_array(key)) return {mission.start_time(), section.span(key, 1.0, period_s)};
  std::vector<engine::Cadence::Part> parts;
  for (const auto& [from_h, seconds] : section.pairs(key, kMaxPeriods, from_to(0.0, kLongestMission_h), period_s)) {
    const fsw::GpsTime from = mission.epoch + fsw::nearest_duration(kHour_s * from_h);
    if (!parts.empty() && from <= parts.back().from) section.refuse_value(key, "hours in increasing order");
    parts.push_back({from, fsw::nearest_duration(seconds)});
  }
  return from_start(std::move(parts), mission.start_time());
}

engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s, const Mission& mission,
                             fsw::Duration default_value) {
  return read_cadence(section, key, period_s, mission, engine::Cadence(mission.start_time(), default_value));
}

}  // namespace vbar::mission
