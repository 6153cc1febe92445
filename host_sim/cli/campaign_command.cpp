#include <chrono>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include <fmt/core.h>
#include <unistd.h>

#include "host_sim/campaign/engine.h"
#include "host_sim/campaign/exchange.h"
#include "host_sim/campaign/run_campaign.h"
#include "host_sim/campaign/status.h"
#include "host_sim/campaign_report/page.h"
#include "host_sim/cli/build_info.h"
#include "host_sim/cli/command_line.h"
#include "host_sim/cli/viewer.h"
#include "host_sim/files/own_program.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/run_control.h"

namespace vbar::app {
namespace {

constexpr const char* kTrustHelp =
    "fly a folder whose program is not this one, or whose mission names a library, a device or a testbed";
constexpr const char* kFolderHelp = "folder of the campaign";
constexpr const char* kExitCodes =
    "Exit codes of run: 0 every case has its result and every requirement is met, 1 one is not met, cases were lost, "
    "or "
    "no\n"
    "more can be flown here, 2 refused (nothing was flown), 75 cases are left to fly: run the folder again.";

void add_run(CLI::App& campaign, int& exit_code, const campaign::CommandLine& command_line) {
  const auto request = std::make_shared<campaign::RunRequest>();
  const auto sbatch = std::make_shared<std::string>(), submit = std::make_shared<std::string>();
  CLI::App* run = campaign.add_subcommand("run", "begin a campaign, or fly what is left of one");
  run->footer(kExitCodes);
  run->add_option("campaign", request->campaign, "campaign file (TOML), or the folder of a campaign")->required();
  run->add_option("--out", request->out, "folder of a new campaign; runs/campaign-NAME unless given");
  run->add_option("--seeds-from", request->seeds_from,
                  "commit of which seeds = { count = N, from = \"commit\" } are drawn; that of vbar unless given");
  run->add_option("--jobs", request->jobs, "flights at once; local: as many as processors, else 1 for each worker")
      ->check(integer_from(1));
  run->add_option("--engine", request->engine, "where the workers run: local, slurm or command");
  run->add_option("--workers", request->workers, "of slurm and command; by the work unless given")
      ->check(integer_from(1));
  run->add_option("--sbatch", *sbatch, "slurm: options of sbatch, e.g. \"--partition=x --time=2:00:00\"");
  run->add_option("--submit", *submit, "command: what starts a worker, e.g. \"qsub -b y {worker}\"");
  run->add_option("--cases", request->cases, "only these, e.g. 0-99,417");
  run->add_flag("--retry-failed", request->retry_failed, "fly cases again that failed, took too long or were lost");
  run->add_flag("!--no-wait", request->wait, "return when the workers are submitted");
  run->add_flag("--trust", request->trust, kTrustHelp);
  run->add_flag("--quiet", request->quiet, "print nothing but errors");
  run->callback([=, &exit_code] {
    if (request->engine != "slurm" && !sbatch->empty()) throw Refused("--sbatch: needs --engine slurm");
    if ((request->engine == "command") == submit->empty())
      throw Refused("--submit and --engine command need each other");
    if (request->engine == "local" && request->workers > 0) throw Refused("--workers: has no effect here; use --jobs");
    request->engine_options = *sbatch + *submit;
    request->build = {build_version(), kBuildCommit};
    request->stop_requested = stop_requested;
    request->command_line = command_line;
    catch_stop_signals();
    exit_code = campaign::run_campaign(*request);
  });
}

/// Becomes the program that serves the page of the campaign, until it is interrupted.
int serve_status(const std::filesystem::path& root) {
  campaign::Folder(root).require_campaign();
  throw std::runtime_error(files::become(Viewer::program(), {root.string()}));
}

int status(const std::filesystem::path& root, bool watch) {
  const campaign::Folder folder(root);
  catch_stop_signals();
  for (;;) {
    const campaign::Standing standing = campaign::read_standing(folder);
    const std::string text = campaign::status_text(standing, campaign::judge_requirements(folder, standing),
                                                   campaign::jobs_of_campaign(folder));
    fmt::print("{}{}", watch && isatty(STDOUT_FILENO) == 1 ? "\x1b[H\x1b[J" : "", text);
    std::fflush(stdout);
    if (!watch || standing.left_to_fly(false).empty()) return kDone;
    for (int tenth = 0; tenth < 20; ++tenth) {
      if (stop_requested()) return kDone;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
}

void add_status(CLI::App& campaign, int& exit_code) {
  const auto folder = std::make_shared<std::filesystem::path>();
  const auto watch = std::make_shared<bool>(false);
  CLI::App* command = campaign.add_subcommand("status", "how a campaign stands");
  command->add_option("folder", *folder, kFolderHelp)->required();
  const auto view = std::make_shared<bool>(false);
  CLI::Option* const watch_flag =
      command->add_flag("--watch", *watch, "print again every two seconds until every case has its result");
  command->add_flag("--view", *view, "serve the page of the campaign on 127.0.0.1 while it is flown (vbar watch)")
      ->excludes(watch_flag);
  command->callback([=, &exit_code] { exit_code = *view ? serve_status(*folder) : status(*folder, *watch); });
}

int report(const std::filesystem::path& root) {
  const campaign::Folder folder(root);
  const campaign::Standing standing = campaign::read_standing(folder);
  campaign::write_results(folder, standing);
  const campaign::WrittenPage written = campaign::write_page(folder.root());
  fmt::print("{}results  {}\npage     {}\n", campaign::status_text(standing, written.requirements, {}),
             folder.results().string(), written.page.string());
  return standing.results.conflicts.empty() ? kDone : kFailed;
}

void add_report(CLI::App& campaign, int& exit_code) {
  const auto folder = std::make_shared<std::filesystem::path>();
  CLI::App* command = campaign.add_subcommand("report", "write results.csv and campaign.html of what has flown so far");
  command->add_option("folder", *folder, kFolderHelp)->required();
  command->callback([=, &exit_code] { exit_code = report(*folder); });
}

int exit_code_of(campaign::Rerun::Verdict verdict) {
  switch (verdict) {
    case campaign::Rerun::Verdict::kIdentical:
    case campaign::Rerun::Verdict::kNothingToCompare:
      return kDone;
    case campaign::Rerun::Verdict::kDifferent:
      return kDifferent;
    case campaign::Rerun::Verdict::kInterrupted:
      return kInterrupted;
    case campaign::Rerun::Verdict::kFailed:
      break;
  }
  return kFailed;
}

void add_rerun(CLI::App& campaign, int& exit_code) {
  const auto folder = std::make_shared<std::filesystem::path>(), out = std::make_shared<std::filesystem::path>();
  const auto number = std::make_shared<std::size_t>(0);
  CLI::App* command =
      campaign.add_subcommand("rerun", "fly a case again with all its records; are its outputs the same bits?");
  command->add_option("folder", *folder, kFolderHelp)->required();
  command->add_option("case", *number, "number of the case")->required();
  command->add_option("--out", *out, "run folder; runs/NUMBER of the campaign unless given");
  const auto trust = std::make_shared<bool>(false);
  command->add_flag("--trust", *trust, kTrustHelp);
  command->callback([=, &exit_code] {
    catch_stop_signals();
    const campaign::Rerun done = campaign::rerun(campaign::Folder(*folder), *number, *out, *trust, stop_requested);
    fmt::print("{}\n", done.sentence);
    if (!done.folder.empty()) fmt::print("run  {}\n", done.folder.string());
    exit_code = exit_code_of(done.verdict);
  });
}

void add_export(CLI::App& campaign) {
  const auto folder = std::make_shared<std::filesystem::path>(), to = std::make_shared<std::filesystem::path>();
  CLI::App* command = campaign.add_subcommand(
      "export", "pack the cases that are left to fly, with program, data and mission, for another computer");
  command->footer(
      "There `./fly.sh` flies them with the program in it, `./fly.sh BUNDLE/vbar` with the libraries of a\n"
      "portable bundle, and packs results.tar.gz for vbar campaign import.");
  command->add_option("folder", *folder, kFolderHelp)->required();
  command->add_option("--to", *to, "archive (.tar.gz, .tgz) or folder; NAME-cases.tar.gz unless given");
  command->callback([=] {
    const campaign::Exported done = campaign::export_cases(campaign::Folder(*folder), *to);
    fmt::print("cases    {}\nexport   {}\n", done.cases, done.to.string());
  });
}

void add_import(CLI::App& campaign, int& exit_code) {
  const auto folder = std::make_shared<std::filesystem::path>(), from = std::make_shared<std::filesystem::path>();
  CLI::App* command = campaign.add_subcommand("import", "take results of exported cases, of the same program and data");
  command->add_option("folder", *folder, kFolderHelp)->required();
  command->add_option("results", *from, "results.tar.gz, or the exported folder that was flown")->required();
  command->callback([=, &exit_code] {
    const campaign::Imported done = campaign::import_results(campaign::Folder(*folder), *from);
    fmt::print("results  {} taken, {} were known, {} left to fly\n", done.taken, done.known, done.left);
    exit_code = report(*folder);
  });
}

void add_worker(CLI::App& campaign, int& exit_code, const campaign::CommandLine& command_line) {
  const auto request = std::make_shared<campaign::WorkerRequest>();
  CLI::App* command =
      campaign.add_subcommand("worker", "fly share K of N of the cases, K from 0 on: a task of an engine");
  command->add_option("folder", request->folder, kFolderHelp)->required();
  command->add_option("k", request->k, "number of this worker")->required();
  command->add_option("n", request->n, "number of workers")->required();
  command->add_option("--todo", request->todo, "numbers of the cases, one a line; all without a result unless given");
  command->add_option("--jobs", request->jobs, "flights at once")->check(integer_from(1));
  command->add_flag("--trust", request->trust, kTrustHelp);
  command->callback([=, &exit_code] {
    catch_stop_signals();
    request->stop_requested = stop_requested;
    request->command_line = command_line;
    exit_code = campaign::run_worker(*request);
  });
}

}  // namespace

void add_campaign_command(CLI::App& program, int& exit_code, const campaign::CommandLine& command_line) {
  CLI::App* campaign = program.add_subcommand("campaign", "fly a mission many times: seeds, sweeps, dispersed keys");
  campaign->require_subcommand(1);
  add_run(*campaign, exit_code, command_line);
  add_status(*campaign, exit_code);
  add_report(*campaign, exit_code);
  add_rerun(*campaign, exit_code);
  add_export(*campaign);
  add_import(*campaign, exit_code);
  add_worker(*campaign, exit_code, command_line);
}

}  // namespace vbar::app
