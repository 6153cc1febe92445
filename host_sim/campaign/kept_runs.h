#pragma once
// Selection of the run folders of a campaign that stay.

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/campaign/folder.h"
#include "host_sim/campaign/result.h"

namespace vbar::campaign {

/// Largest number of failed cases that keep their folders.
inline constexpr std::size_t kMaxFailedRuns = 100;

/// Whether the folder of `result` is to stay, given the results of the same worker before it: all, those that did not
/// pass, or those that are among the worst so far by a criterion.
[[nodiscard]] bool is_kept(const Plan& plan, const Result& result, const std::vector<Result>& before,
                           const Folder& folder);

/// Moves a run folder to runs/NUMBER, in place of one that is there; its path relative to the campaign's folder. Throws
/// std::runtime_error.
std::string keep_run(const Folder& folder, const std::filesystem::path& run_folder, std::size_t number);

/// The cases that are the worst `plan.keep.worst` by any criterion.
[[nodiscard]] std::vector<std::size_t> worst_cases(const Plan& plan, const std::vector<Result>& results);

/// keep = "worst:N": removes the folders of cases that others have outdone since.
void remove_outdone_runs(const Plan& plan, const std::vector<Result>& results, const Folder& folder);

}  // namespace vbar::campaign
