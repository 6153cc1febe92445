#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "host_sim/cli/build_info.h"
#include "host_sim/cli/command_line.h"
#include "host_sim/mission/load.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/run_control.h"
#include "host_sim/verification/compare.h"
#include "host_sim/verification/page.h"
#include "host_sim/verification/verify.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExitCodes =
    "Exit codes: 0 all requirements of the rows are met, or no row is worse; 1 one is not met, a row cannot be flown,\n"
    "or is worse; 2 refused; 75 interrupted: the same command continues.";

struct Options {
  verification::Request request;
  double budget_min = 0.0;
  bool list = false;
  fs::path page, docs = "docs";
  std::vector<fs::path> compare;
};

int write_pages(const Options& options) {
  const verification::Json verification = verification::read_verification(options.page);
  for (const fs::path& changed : verification::write_pages(verification, options.docs))
    fmt::print("changed  {}\n", changed.string());
  return kDone;
}

int compare(const Options& options) {
  const fs::path later = options.compare.size() > 1 ? options.compare[1] : options.request.to / "verification.json";
  const verification::Comparison comparison = verification::compare(verification::read_verification(options.compare[0]),
                                                                    verification::read_verification(later));
  fmt::print("{}", verification::text_of(comparison));
  return comparison.worse.empty() ? kDone : kFailed;
}

int list(const Options& options) {
  fmt::print("{}", verification::list_of(verification::selected_rows(verification::read_rows(options.request.missions),
                                                                     options.request.names)));
  return kDone;
}

int execute(Options& options, bool has_budget) {
  verification::Request& request = options.request;
  request.build = {build_version(), kBuildCommit};
  if (request.missions.empty()) request.missions = mission::missions_directory() / "verification";
  if (request.to.empty()) request.to = fs::path("runs") / ("verification-" + request.build.commit);
  if (!options.page.empty()) return write_pages(options);
  if (!options.compare.empty()) return compare(options);
  if (options.list) return list(options);
  if (has_budget) request.budget_min = options.budget_min;
  request.stop_requested = stop_requested;
  catch_stop_signals();
  return verification::verify(request);
}

}  // namespace

void add_verify_command(CLI::App& program, int& exit_code, const campaign::CommandLine& command_line) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("verify", "fly the verification of this program, or a part of it");
  command->footer(kExitCodes);
  command->add_option("rows", options->request.names,
                      "rows, or folders of rows; without any all but the sample; --list prints them");
  CLI::Option* budget =
      command->add_option("--budget", options->budget_min, "wall-clock minutes; fewer seeds of each row are flown")
          ->check(number_from(0.0));
  command->add_option("--jobs", options->request.jobs, "flights at once; as many as processors unless given")
      ->check(integer_from(1));
  command->add_option("--to", options->request.to,
                      "folder of the campaigns and of verification.json; runs/verification-COMMIT unless given");
  command->add_option("--missions", options->request.missions,
                      "folder of the rows; missions/verification unless given");
  command->add_flag("--trust", options->request.trust, "continue rows whose missions name a testbed");
  command->add_flag("--quiet", options->request.quiet, "print nothing but errors");
  command->add_flag("--list", options->list, "print the rows in the order in which they are flown, and fly nothing");
  command->add_option("--page", options->page, "verification.json: write its figures into the pages, and fly nothing");
  command->add_option("--docs", options->docs,
                      "with --page: folder of the pages, README.md beside it; docs by default");
  command
      ->add_option("--compare", options->compare,
                   "an earlier verification.json and a later one, by default that of --to: name what is worse")
      ->expected(1, 2);
  command->callback([=, &exit_code] {
    options->request.command_line = command_line;
    exit_code = execute(*options, budget->count() > 0);
  });
}

}  // namespace vbar::app
