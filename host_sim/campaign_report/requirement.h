#pragma once
// Whether a campaign meets its requirements. No case vanishes from a statistic: one without the figure, or that was not
// flown to an end, is counted as such, and a requirement is met only if no more cases lack it than it allows.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/report/json_file.h"

namespace vbar::campaign_report {

/// The case that speaks most against a requirement: the largest figure with `most`, the smallest with `least`; of
/// shares the first one that counts against it.
struct WorstCase {
  std::uint64_t number = 0;
  std::string seed;
  std::optional<double> value;  ///< none of shares
  std::string command;          ///< that flies the case again
};

struct JudgedRequirement {
  Requirement requirement;
  bool met = false;
  std::optional<double> value;         ///< the statistic of the cases that have a value; of shares of all cases
  std::optional<double> bound;         ///< upper with `most`, lower with `least`; none if not required or not supported
  std::size_t cases = 0;               ///< cases with a value; of shares those flown to an end
  std::vector<std::uint64_t> missing;  ///< the others
  std::optional<WorstCase> worst;
  std::string sentence;  ///< "requirement met: ..."
};

/// Judges the requirements of a campaign, in the order of its file. `folder` stands in the commands that fly a case
/// again.
[[nodiscard]] std::vector<JudgedRequirement> judge_requirements(const Campaign& campaign, const std::string& folder);

[[nodiscard]] bool all_met(const std::vector<JudgedRequirement>& judged);

/// "median", "percentile"; of a campaign file.
[[nodiscard]] std::string_view name_of(Statistic statistic);

/// "percentile 95 of waypoints.10.control_error_m", "share of verdict achieved or missed", "pass rate"
[[nodiscard]] std::string subject_of(const Requirement& requirement);

/// "at most 45.0 mm", with the confidence if there is one.
[[nodiscard]] std::string limit_of(const Requirement& requirement);

/// A statistic or bound of the requirement with its unit: "41.2 mm", "97.50 %".
[[nodiscard]] std::string value_of(const Requirement& requirement, double value);

// Requirements and results as JSON.

/// What campaign.json holds of a requirement.
[[nodiscard]] report::Json json_of(const Requirement& requirement);

/// Reads `require` of campaign.json: a list, or null or one pass rate as older versions wrote it. Throws
/// std::runtime_error that names the key and what is accepted.
[[nodiscard]] std::vector<Requirement> requirements_of(const report::JsonObject& campaign);

/// The text of campaign_results.json: program, counts of states and verdicts, every requirement with its statistic,
/// bound and worst case. The same two files of a folder give the same text.
[[nodiscard]] std::string results_json(const Campaign& campaign, const std::vector<JudgedRequirement>& judged);

}  // namespace vbar::campaign_report
