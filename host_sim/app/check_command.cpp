// vbar check: the limits of a mission against runs of it.

#include <utility>
#include <vector>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/limit_verdict.h"
#include "host_sim/report/text_file.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

int print_numbers(const std::vector<fs::path>& run_folders) {
  for (const fs::path& folder : run_folders)
    for (const auto& [key, value] : campaign::numbers_of(summary_json_of(folder)))
      fmt::print("{} = {:g}\n", key, value);
  return kDone;
}

}  // namespace

int check_command(const CheckOptions& options) {
  if (options.numbers) return print_numbers(options.run_folders);
  bool passed = true;
  std::vector<check::JunitSuite> suites;
  for (const fs::path& folder : options.run_folders) {
    CheckedRun run = checked_run(folder, options.limits);
    passed = passed && run.passed;
    suites.push_back(std::move(run.suite));
  }
  if (!options.junit.empty()) files::replace_text_file(options.junit, check::junit_xml(suites));
  return passed ? kDone : kLimitMissed;
}

}  // namespace vbar::app
