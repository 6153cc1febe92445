#pragma once
// Reads [spacecraft.attitude].

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/attitude.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// Reads inertia_kgm2 of the table: [xx, yy, zz] or [xx, yy, zz, xy, xz, yz]; nothing if it is missing. Throws
/// MissionError for an invalid inertia (truth::check_inertia).
[[nodiscard]] std::optional<fsw::Matrix3> read_inertia(const TableReader& section);

/// Reads a rotation [w, x, y, z] under `key`, normalised; nothing if it is missing. Throws MissionError.
[[nodiscard]] std::optional<Eigen::Quaterniond> read_quaternion(const TableReader& section, std::string_view key);

/// Reads the value of `target`, "target" if it is missing: another spacecraft than `own`. Throws MissionError.
[[nodiscard]] std::string read_other_spacecraft(const TableReader& section, const std::string& own,
                                                const std::vector<std::string>& names);

/// Reads the attitude of a spacecraft. `own`: the name of the spacecraft; `body`: its body; `names`: those of all
/// spacecraft of the mission. Nothing for profile = "none", the default. Throws MissionError.
[[nodiscard]] std::optional<Attitude> read_attitude(const TableReader& section, const std::string& own,
                                                    const std::string& body, const std::vector<std::string>& names);

/// Reads the elements of `then` of [spacecraft.attitude], whose profiles replace `first` and each other; empty without
/// the key, which is not one of no profile or of one that the flight software commands. Throws MissionError.
[[nodiscard]] std::vector<LaterAttitude> read_later_attitudes(const TableReader& section,
                                                              const std::optional<Attitude>& first);

}  // namespace vbar::mission
