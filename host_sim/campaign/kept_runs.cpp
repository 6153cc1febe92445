#include "host_sim/campaign/kept_runs.h"

#include <algorithm>
#include <limits>
#include <set>
#include <system_error>

#include <fmt/format.h>

namespace vbar::campaign {
namespace {

namespace fs = std::filesystem;

/// Larger is worse; a case without the number is the worst.
double badness(const PassCriterion& criterion, const Result& result) {
  const auto value = find_number(result.numbers, criterion.key);
  if (!value) return std::numeric_limits<double>::infinity();
  double worst = -std::numeric_limits<double>::infinity();
  if (criterion.most) worst = std::max(worst, *value - *criterion.most);
  if (criterion.least) worst = std::max(worst, *criterion.least - *value);
  return worst;
}

std::size_t count_folders(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code error;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder, error)) ++count;
  return count;
}

}  // namespace

std::vector<std::size_t> worst_cases(const Plan& plan, const std::vector<Result>& results) {
  std::set<std::size_t> worst;
  for (const PassCriterion& criterion : plan.passes) {
    std::vector<std::pair<double, std::size_t>> ranked;
    for (const Result& result : results) ranked.emplace_back(-badness(criterion, result), result.number);
    std::ranges::sort(ranked);
    for (std::size_t k = 0; k < std::min(plan.keep.worst, ranked.size()); ++k) worst.insert(ranked[k].second);
  }
  return {worst.begin(), worst.end()};
}

bool is_kept(const Plan& plan, const Result& result, const std::vector<Result>& before, const Folder& folder) {
  switch (plan.keep.kind) {
    case Keep::Kind::kSummary:
      return false;
    case Keep::Kind::kAll:
      return true;
    case Keep::Kind::kFailed:
      return !has_passed(plan, result) && count_folders(folder.runs()) < kMaxFailedRuns;
    case Keep::Kind::kWorst:
      break;
  }
  return std::ranges::any_of(plan.passes, [&](const PassCriterion& criterion) {
    const double own = badness(criterion, result);
    const auto worse = std::ranges::count_if(before, [&](const Result& r) { return badness(criterion, r) >= own; });
    return static_cast<std::size_t>(worse) < plan.keep.worst;
  });
}

std::string keep_run(const Folder& folder, const fs::path& run_folder, std::size_t number) {
  const fs::path kept = folder.runs() / name_of_case(number);
  std::error_code error;
  fs::create_directories(folder.runs(), error);
  fs::remove_all(kept, error);
  fs::rename(run_folder, kept, error);
  if (error) throw std::runtime_error(kept.string() + ": cannot be written: " + error.message());
  return kept.lexically_relative(folder.root()).string();
}

void remove_outdone_runs(const Plan& plan, const std::vector<Result>& results, const Folder& folder) {
  if (plan.keep.kind != Keep::Kind::kWorst) return;
  const std::vector<std::size_t> worst = worst_cases(plan, results);
  std::error_code ignored;
  for (const Result& result : results)
    if (!result.folder.empty() && !std::ranges::binary_search(worst, result.number))
      fs::remove_all(folder.runs() / name_of_case(result.number), ignored);
}

}  // namespace vbar::campaign
