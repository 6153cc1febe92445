#pragma once
// A propagation in short: as a table for people and as JSON for programs.

#include <span>
#include <string>

#include "host_sim/report/propagation_record.h"

namespace vbar::report {

/// One line a spacecraft, then where the time went, then the speed.
[[nodiscard]] std::string propagation_table(const PropagationRecord& record);

/// `files`: names of the ephemeris files beside it.
[[nodiscard]] std::string propagation_json(const PropagationRecord& record, std::span<const std::string> files);

}  // namespace vbar::report
