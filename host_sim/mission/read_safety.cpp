#include "host_sim/mission/read_sections.h"

namespace vbar::mission {

// Presence of the table selects retreat and safety monitor. Every key has a default, that of the paper's mission:
// Tango's sphere of 0.73 m and one of 1.3 m around Mango with its panels, errors of a retreat at 7 m, a hold orbit at
// 200 m.
void read_safety(const TableReader& document, Mission& mission) {
  if (!document.has("safety")) return;
  const TableReader section = document.table("safety");
  constexpr Range kDistance_m = above_to(0.0, 1e5);
  vbar::safety_configuration& c = mission.safety.emplace();
  c.contact_distance_m = section.number("contact_distance_m", kDistance_m, 2.0);
  c.horizon_s = 3600.0 * section.number("horizon_h", above_to(0.0, 50.0), 24.0);
  c.retreat_delay_s = section.number("retreat_delay_s", above_to(0.0, 1e5), 600.0);
  c.semi_major_axis_error_m = section.number("semi_major_axis_error_m", from_to(0.0, 1e3), 0.05);
  c.differential_drag = section.number("differential_drag_mps2", from_to(0.0, 1e-3), 1e-9);
  c.maximum_collision_probability = section.number("maximum_collision_probability", above_to(0.0, 1.0), 1e-4);
  c.recession_m = section.number("recession_m", kDistance_m, 1.0);
  c.hold_distance_m = section.number("hold_distance_m", kDistance_m, 200.0);
  c.hold_separation_m = section.number("hold_separation_m", kDistance_m, 6.0);
  c.data_timeout_s = section.number("data_timeout_s", above_to(0.0, 1e6), 2100.0);
  c.data_timeout_range_m = section.number("data_timeout_range_m", kDistance_m, 100.0);
  c.target_size_m = section.number("target_size_m", kDistance_m, 0.69);
  section.finish();
  if (c.hold_distance_m <= c.contact_distance_m)
    section.refuse_value("hold_distance_m", "more than contact_distance_m");
  if (c.hold_separation_m <= c.contact_distance_m)
    section.refuse_value("hold_separation_m", "more than contact_distance_m");
}

}  // namespace vbar::mission
