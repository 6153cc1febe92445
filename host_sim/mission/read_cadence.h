#pragma once
// A period as missions state it: a number of seconds, or a list of [hour of the mission, seconds].

#include <string_view>

#include "host_sim/engine/cadence.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// Reads a period. The mission's epoch and start must be known. A single period, also the default, holds from the
/// start; elements of a list before the start are left out.
[[nodiscard]] engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s,
                                           const Mission& mission, const engine::Cadence& default_value);
[[nodiscard]] engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s,
                                           const Mission& mission, fsw::Duration default_value);

}  // namespace vbar::mission
