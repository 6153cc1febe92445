#include "host_sim/mission/read_sections.h"

namespace vbar::mission {

void read_burns(const TableReader& document, Mission& mission) {
  for (const TableReader& section : document.tables("burn")) {
    PrescribedBurn burn;
    burn.time = mission.epoch + section.span("time_h", kHour_s, from_to(0.0, kLongestMission_h));
    if (burn.time < mission.start_time() || burn.time > mission.end_time())
      section.refuse_value("time_h", "a time of the run");
    if (!mission.burns.empty() && burn.time <= mission.burns.back().time)
      section.refuse_value("time_h", "a time after the burn before");
    const auto dv_mmps = section.three_numbers("dv_rtn_mmps", from_to(-1e6, 1e6));
    burn.dv_rtn = 1e-3 * fsw::Vector3(dv_mmps[0], dv_mmps[1], dv_mmps[2]);
    section.finish();
    mission.burns.push_back(burn);
  }
}

}  // namespace vbar::mission
