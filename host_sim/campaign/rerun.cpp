#include "host_sim/campaign/rerun.h"

#include <chrono>
#include <cstdlib>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "host_sim/app/exit_codes.h"
#include "host_sim/campaign/case_flight.h"
#include "host_sim/campaign/copies.h"
#include "host_sim/campaign/kept_runs.h"
#include "host_sim/campaign/trust.h"
#include "host_sim/campaign/worker.h"

namespace vbar::campaign {
namespace {

namespace fs = std::filesystem;

/// "commands and waypoints differ from the record (...)"; empty if nothing does.
std::string differences(const Result& before, const Result& now) {
  std::vector<std::string> parts;
  const auto compare = [&parts](const char* name, const std::string& then, const std::string& again) {
    if (then != again)
      parts.push_back(fmt::format("{} {}..., on record {}...", name, again.substr(0, 16), then.substr(0, 16)));
  };
  compare("commands", before.commands_sha256, now.commands_sha256);
  compare("telemetry", before.telemetry_sha256, now.telemetry_sha256);
  compare("waypoints", before.waypoints_sha256, now.waypoints_sha256);
  return fmt::format("{}", fmt::join(parts, "; "));
}

Rerun compare(const Result* before, const Result& now) {
  const auto number = now.number;
  if (before == nullptr)
    return {Rerun::Verdict::kNothingToCompare, fmt::format("case {}: no result on record", number)};
  if (before->state != now.state)
    return {Rerun::Verdict::kDifferent, fmt::format("case {}: {} ({}), on record {}", number, name_of(now.state),
                                                    now.reason, name_of(before->state))};
  if (now.state != State::kComplete && now.state != State::kVoid)
    return {Rerun::Verdict::kIdentical, fmt::format("case {}: {} again: {}", number, name_of(now.state), now.reason)};
  const std::string what = differences(*before, now);
  if (what.empty())
    return {Rerun::Verdict::kIdentical,
            fmt::format("case {}: commands, telemetry and waypoints have the same bits as on record", number)};
  const std::string other = before->processor == now.processor ? ""
                                                               : fmt::format("; on another processor: {}, on record {}",
                                                                             now.processor, before->processor);
  return {Rerun::Verdict::kDifferent, fmt::format("case {}: differs: SHA-256 of {}{}", number, what, other)};
}

fs::path take_folder(const Folder& folder, const CaseFlight& flight, const fs::path& out) {
  if (out.empty()) return folder.root() / keep_run(folder, flight.run_folder(), flight.one().number);
  fs::copy(flight.run_folder(), out, fs::copy_options::recursive);  // may be on another disk
  return out;
}

}  // namespace

Rerun rerun(const Folder& folder, std::size_t number, const fs::path& out, bool is_trusted,
            const std::function<bool()>& stop_requested) {
  const Standing standing = read_standing(folder);
  if (number >= standing.cases.size())
    throw app::Refused(fmt::format("case {}: unknown; accepted: 0 to {}", number, standing.cases.size() - 1));
  std::error_code error;
  if (!out.empty() && fs::exists(out, error)) throw app::Refused(out.string() + ": exists; name another folder");
  check_trust(folder, standing.plan, standing.cases, is_trusted);
  check_copies(folder);
  ::setenv("VBAR_DATA", fs::absolute(folder.data()).c_str(), 1);
  const std::string attempt = fmt::format("{}.{}.0", name_of_case(number), new_worker_name("rerun"));
  CaseFlight flight({folder, standing.plan, standing.cases[number], attempt, true});
  for (;;) {
    if (stop_requested()) return {Rerun::Verdict::kInterrupted, fmt::format("case {}: interrupted", number)};
    const std::optional<CaseFlight::End> end = flight.poll();
    if (!end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    if (end->kind != CaseFlight::End::Kind::kResult)
      return {Rerun::Verdict::kFailed, fmt::format("case {}: {}", number, end->reason)};
    Rerun done = compare(standing.status_of(number).result, end->result);
    done.folder = take_folder(folder, flight, out);
    return done;
  }
}

}  // namespace vbar::campaign
