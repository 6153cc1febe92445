#pragma once
// verification.json: what the verification of one commit has shown, a row for each campaign file. Pages are written and
// other commits compared from it alone, so that it holds the values of each case.

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/campaign/plan.h"
#include "host_sim/report/json_file.h"
#include "host_sim/verification/rows.h"

namespace vbar::verification {

using report::Json;

/// Returns the number of seeds all of whose cases have a result in a campaign's folder; zero if it holds no campaign.
/// Throws app::Refused if another program flew it.
[[nodiscard]] std::size_t seeds_flown(const Row& row, const std::filesystem::path& folder);

/// Returns the record of a row from the folder of its campaign, or of one that was not flown if it holds none.
[[nodiscard]] Json record_of(const Row& row, const std::filesystem::path& folder);

/// Returns the text of verification.json: of all rows, whose campaigns are in `folder` by their names.
[[nodiscard]] std::string verification_json(const std::vector<Row>& rows, const std::filesystem::path& folder,
                                            const campaign::Build& build);

/// Reads a verification.json. Throws std::runtime_error that names file, key and what is accepted.
[[nodiscard]] Json read_verification(const std::filesystem::path& file);

/// Whether a row was flown and meets all that it requires.
[[nodiscard]] bool is_flown(const Json& row);
[[nodiscard]] bool is_met(const Json& row);

/// A value of a case or of a statistic; infinite where it is null: the case lacks the figure, e.g. the target was lost.
[[nodiscard]] double value_or_lost(const Json& value);

/// Whether smaller values of the quantity are worse: its limit is a least one.
[[nodiscard]] bool is_smaller_worse(const Json& quantity);

/// Returns the requirement's quantity, null of a share.
[[nodiscard]] const Json* quantity_of(const Json& row, const std::string& key);

}  // namespace vbar::verification
