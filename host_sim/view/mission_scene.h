#pragma once
// What a page draws beside the tables of a run and only the mission states: shapes of the spacecraft, cameras, keep-out
// radii, sunlight.

#include <filesystem>

#include <nlohmann/json.hpp>

#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/view/embedded_table.h"

namespace vbar::view {

/// Returns the scene: the bodies of the servicer and of the target with their shapes, cameras, waypoints with their
/// keep-out radii. A shape that cannot be read is left out, with the reason under "notes".
[[nodiscard]] nlohmann::json scene_of(const mission::Mission& mission, const report::RunRecord& record,
                                      const std::filesystem::path& data_directory);

/// Returns the direction to the Sun, the fraction of its light that reaches the servicer, and whether that is eclipse,
/// at steps of the run.
[[nodiscard]] CellTable sunlight_of(const mission::Mission& mission, const report::RunRecord& record);

}  // namespace vbar::view
