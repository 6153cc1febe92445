#pragma once
// The files of a campaign's folder.

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/campaign/case.h"

namespace vbar::campaign {

class Folder {
 public:
  explicit Folder(std::filesystem::path root) : root_(std::move(root)) {}

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  [[nodiscard]] std::filesystem::path campaign_copy() const { return root_ / "campaign.toml"; }
  [[nodiscard]] std::filesystem::path plan() const { return root_ / "campaign.json"; }
  [[nodiscard]] std::filesystem::path cases() const { return root_ / "cases.csv"; }
  [[nodiscard]] std::filesystem::path results() const { return root_ / "results.csv"; }
  /// A file for each worker: a line for each case that it finished.
  [[nodiscard]] std::filesystem::path result_files() const { return root_ / "results"; }
  /// A file for each worker: a line for each flight that it began, and for each that was killed.
  [[nodiscard]] std::filesystem::path attempt_files() const { return root_ / "attempts"; }
  /// The run folders of cases that are being flown, one for each attempt.
  [[nodiscard]] std::filesystem::path flying() const { return root_ / "flying"; }
  /// The run folders that are kept.
  [[nodiscard]] std::filesystem::path runs() const { return root_ / "runs"; }
  /// Program, data, images and mission as they were when the campaign was made.
  [[nodiscard]] std::filesystem::path copies() const { return root_ / "bin"; }
  [[nodiscard]] std::filesystem::path program() const { return copies() / "host" / "vbar"; }
  [[nodiscard]] std::filesystem::path data() const { return copies() / "data"; }
  [[nodiscard]] std::filesystem::path mission_files() const { return copies() / "files"; }
  [[nodiscard]] std::filesystem::path checksums() const { return copies() / "SHA256SUMS"; }
  /// Returns the folder of the lists of cases for the workers of one submission, and of their output.
  [[nodiscard]] std::filesystem::path submissions() const { return root_ / "submissions"; }

  /// Throws app::Refused unless the folder holds a campaign.
  void require_campaign() const;

  /// Throws app::Refused if a folder within is a symbolic link: what is written and removed in it would be elsewhere.
  void refuse_links() const;

 private:
  std::filesystem::path root_;
};

/// The files `*.jsonl` of a folder in order of their names; none if it does not exist.
[[nodiscard]] std::vector<std::filesystem::path> record_files(const std::filesystem::path& folder);

// campaign.json: what the workers and the report need of a campaign, fixed when it is made.

struct Plan {
  std::string name, description, mission, vbar_version, commit, program_sha256;
  std::string seeds_from;  ///< commit of which the seeds were drawn; empty if they were stated
  std::size_t cases = 0;
  std::string cases_sha256;  ///< hash of cases.csv
  std::vector<std::string> keys, swept;
  std::vector<PassCriterion> passes;
  std::vector<double> samples_h;
  std::vector<Requirement> requirements;
  bool independent = true;  ///< the draws are: false of Latin hypercube sampling

  std::string mission_file;  ///< path of the copy, relative to the campaign's folder
  std::vector<std::string> set;
  Keep keep;
  double case_time_limit_s = 0.0, expected_case_s = 60.0;
  std::int64_t retries = 2, stop_after_failures = 0;
};

[[nodiscard]] Plan plan_of(const CampaignFile& campaign);

[[nodiscard]] std::string plan_json(const Plan& plan);

/// Throws std::runtime_error that names the file, the line or key and what is accepted.
[[nodiscard]] Plan read_plan(const std::filesystem::path& file);

/// SHA-256 of a case's overrides: what a result belongs to.
[[nodiscard]] std::string identity_of(const Plan& plan, const Case& one);

/// The overrides of a case, "path=value". `full_record`: with packet log and tables.
[[nodiscard]] std::vector<std::string> overrides_of(const Plan& plan, const Case& one, bool full_record);

// Makes the folder of a campaign from a campaign file. Every case is loaded first: a campaign of which one case is
// rejected does not start.

/// Version and commit of this program, as `vbar --version` prints them.
struct Build {
  std::string version, commit;
};

/// Makes `folder`, with a line of progress on a terminal unless `quiet`. Throws app::Refused that names the case, the
/// key and what is accepted, or that the folder is in use; then nothing was made. Throws std::runtime_error if a file
/// cannot be written or copied.
void prepare(const CampaignFile& campaign, const Folder& folder, const Build& build, bool quiet);

/// Whether the folder holds the campaign of this file.
[[nodiscard]] bool holds_same_campaign(const Folder& folder, const std::filesystem::path& file);

}  // namespace vbar::campaign
