#pragma once
// results.csv: a row for each case, joined from cases.csv and the files of the workers.

#include <string>

#include "host_sim/campaign/case_state.h"

namespace vbar::campaign {

/// Returns the table sorted by case. It does not depend on how the campaign was flown, but for wall-clock times,
/// processor times, host, processor and number of attempts.
[[nodiscard]] std::string results_text(const Standing& standing);

/// Writes results.csv. Throws std::runtime_error that names the file.
void write_results(const Folder& folder, const Standing& standing);

}  // namespace vbar::campaign
