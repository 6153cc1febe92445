#pragma once
// Reads [spacecraft.attitude].

#include <optional>
#include <string>
#include <vector>

#include "host_sim/mission/attitude.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// inertia_kgm2 of the table: [xx, yy, zz] or [xx, yy, zz, xy, xz, yz]; nothing if it is missing. Throws MissionError
/// for what is not the inertia of a body (truth::check_inertia).
[[nodiscard]] std::optional<fsw::Matrix3> read_inertia(const TableReader& section);

/// `own`: the name of the spacecraft; `usual_body`: its body if the table names none; `names`: of all spacecraft of the
/// mission. Nothing for profile = "none", the default. Throws MissionError.
[[nodiscard]] std::optional<Attitude> read_attitude(const TableReader& section, const std::string& own,
                                                    const std::string& usual_body,
                                                    const std::vector<std::string>& names);

}  // namespace vbar::mission
