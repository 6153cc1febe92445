#pragma once
// Rows of the verification: campaign files below missions/verification. A row is named by its path there, without
// ".toml": "experiment3", "sample/experiment3". A folder there is the name of all rows in it.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_file.h"

namespace vbar::verification {

struct Row {
  std::string name;
  campaign::CampaignFile campaign;
  std::size_t cases_per_seed = 1;  ///< points of its sweeps
  std::size_t flown_seeds = 0;     ///< with this program, all points of each

  [[nodiscard]] std::size_t seeds() const {
    return campaign.seed_draw ? campaign.seed_draw->count : campaign.seeds.size();
  }
  [[nodiscard]] std::size_t seeds_left() const { return seeds() - flown_seeds; }
  /// Expected processor time of one more seed.
  [[nodiscard]] double seed_s() const { return campaign.expected_case_s * static_cast<double>(cases_per_seed); }
  [[nodiscard]] double left_s() const { return seed_s() * static_cast<double>(seeds_left()); }
  /// Requirements and criteria that it decides.
  [[nodiscard]] std::size_t decisions() const { return campaign.requirements.size() + campaign.passes.size(); }
};

/// Returns all rows below `folder`, in order of their names. Throws MissionError.
[[nodiscard]] std::vector<Row> read_rows(const std::filesystem::path& folder);

/// Returns the rows of these names; without a name all that are in no folder of their own, and the regressions. Throws
/// app::Refused that names an unknown one and what is accepted.
[[nodiscard]] std::vector<Row> selected_rows(std::vector<Row> rows, const std::vector<std::string>& names);

/// Orders rows by what a minute on them decides: rows with seeds left first, then the number of requirements and
/// criteria for each expected minute of the seeds that are left, then names.
void order_by_value(std::vector<Row>& rows);

/// The number of further seeds of each row, in their order, within `budget_s` of processor time. All rows have the same
/// share of it; what a row leaves of its share is shared by the others. Seeds that then still fit go to the first rows
/// that have none.
[[nodiscard]] std::vector<std::size_t> seeds_within(const std::vector<Row>& rows, double budget_s);

}  // namespace vbar::verification
