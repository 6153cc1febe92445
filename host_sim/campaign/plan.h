#pragma once
// campaign.json: what the workers and the report need of a campaign, fixed when it is made.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/campaign/case.h"

namespace vbar::campaign {

struct Plan {
  std::string name, description, mission, vbar_version, program_sha256;
  std::size_t cases = 0;
  std::string cases_sha256;  ///< hash of cases.csv
  std::vector<std::string> keys, swept;
  std::vector<PassCriterion> passes;
  std::vector<double> samples_h;
  std::optional<Requirement> require;
  bool independent = true;  ///< the draws are: false of Latin hypercube sampling

  std::string mission_file;  ///< path of the copy, relative to the campaign's folder
  std::vector<std::string> set;
  Keep keep;
  double case_time_limit_s = 0.0, expected_case_s = 60.0;
  std::int64_t retries = 2, stop_after_failures = 0;
};

[[nodiscard]] Plan plan_of(const CampaignFile& campaign);

[[nodiscard]] std::string plan_json(const Plan& plan);

/// Throws std::runtime_error that names the file.
[[nodiscard]] Plan read_plan(const std::filesystem::path& file);

/// SHA-256 of a case's overrides: what a result belongs to.
[[nodiscard]] std::string identity_of(const Plan& plan, const Case& one);

/// The overrides of a case, "path=value". `full_record`: with packet log and tables.
[[nodiscard]] std::vector<std::string> overrides_of(const Plan& plan, const Case& one, bool full_record);

}  // namespace vbar::campaign
