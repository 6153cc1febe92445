#include <limits>
#include <stdexcept>

#include "host_sim/mission/extends.h"
#include "host_sim/mission/read_cadence.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::mission {
namespace {

fsw::GpsTime read_epoch(const TableReader& section) {
  // Default: the paper's initial epoch.
  const std::string text = section.text("epoch_utc", "2011-07-18T01:00:00Z");
  try {
    return truth::gps_from_utc(text);
  } catch (const std::invalid_argument&) {
    section.refuse_value("epoch_utc", "a UTC time like 2011-07-18T01:00:00Z, from 1980-01-06 to the year 2200");
  }
}

}  // namespace

void read_general(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("mission");
  mission.name = section.name("name", name_of_file(mission.file));
  mission.description = section.text("description", "");
  mission.epoch = read_epoch(section);
  mission.start = section.span("start_h", kHour_s, from_to(0.0, kLongestMission_h), 0.0);
  mission.duration = section.span("duration_h", kHour_s, above_to(0.0, kLongestMission_h));
  mission.step = read_cadence(section, "step_s", from_to(1e-3, 3600.0), mission, fsw::duration_of_seconds(60));
  if (mission.step.parts().front().from > mission.start_time())
    section.refuse_value("step_s", "a first period that holds from the start of the mission on");
  constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();
  mission.seed = static_cast<std::uint64_t>(section.integer("seed", 0, kLargestSeed, 1));
  section.finish();
}

}  // namespace vbar::mission
