#pragma once
// How well the target's place is known before the start: 1 sigma of mean ROE times the reference semi-major axis, m.

#include "fsw/core/types.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// Keys of the section; `usual`: what those that are left out stand for. The two of de, and of di, are alike.
[[nodiscard]] fsw::Vector6 read_apriori(const TableReader& section, const fsw::Vector6& usual);

}  // namespace vbar::mission
