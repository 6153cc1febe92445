#include "host_sim/campaign/case_flight.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/app/exit_codes.h"
#include "host_sim/files/own_program.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/text_file.h"

namespace vbar::campaign {
namespace {

namespace fs = std::filesystem;
using End = CaseFlight::End;

std::vector<std::string> arguments_of(const CaseFlight::Request& request, const fs::path& run_folder) {
  std::vector<std::string> command{"run", (request.folder.root() / request.plan.mission_file).string(), "--quiet",
                                   "--out", run_folder.string()};
  for (const std::string& override : overrides_of(request.plan, request.one, request.full_record))
    command.insert(command.end(), {"--set", override});
  return command;
}

std::unique_ptr<io::ChildProcess> start(const CaseFlight::Request& request, const fs::path& run_folder) {
  const std::string program = fs::absolute(request.folder.program()).string();
  std::vector<std::string> arguments = arguments_of(request, run_folder);
  if (request.command_line != nullptr)
    return std::make_unique<io::ChildProcess>([&] { return (*request.command_line)(arguments); }, program);
  std::vector<std::string> words = files::words_that_start(program);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return std::make_unique<io::ChildProcess>(words, std::vector<io::FileDescriptor>());
}

fs::path make_run_folder(const CaseFlight::Request& request) {
  const fs::path run_folder = request.folder.flying() / request.attempt;
  std::error_code error;
  fs::create_directories(request.folder.flying(), error);
  if (!fs::create_directory(run_folder, error))
    throw std::runtime_error(run_folder.string() + ": cannot be made: " + (error ? error.message() : "it exists"));
  return run_folder;
}

/// The last line that the process printed, without the program's name.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  text.erase(0, text.rfind('\n') + 1);  // npos + 1 is 0
  return text.starts_with("vbar: ") ? text.substr(6) : text;
}

/// A reason of the computer's, that says nothing of the case: a file that could not be written.
bool is_of_the_computer(const std::string& reason) {
  const std::array<std::string, 5> signs{"cannot be written", "cannot be made", "cannot be locked",
                                         std::generic_category().message(ENOSPC),
                                         std::generic_category().message(EDQUOT)};
  return std::ranges::any_of(signs, [&](const std::string& sign) { return reason.find(sign) != std::string::npos; });
}

Json read_summary_of(const fs::path& run_folder) {
  try {
    return Json::parse(files::read_text_file(report::summary_file(run_folder)), nullptr, false);
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

std::string text_in(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

bool is_true(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key] == true;
}

bool has_fault_without_effect(const Numbers& numbers) {
  return find_number(numbers, "sensor_figures.faults.without_effect").value_or(0.0) > 0.0;
}

}  // namespace

Computer this_computer() {
  std::array<char, 256> name{};
  Computer computer{::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown", "unknown"};
  std::ifstream lines("/proc/cpuinfo");
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("model name")) continue;
    computer.processor = line.substr(std::min(line.find(": ") + 2, line.size()));
    break;
  }
  return computer;
}

CaseFlight::CaseFlight(const Request& request)
    : one_(request.one),
      attempt_(request.attempt),
      identity_(identity_of(request.plan, request.one)),
      time_limit_s_(request.plan.case_time_limit_s),
      run_folder_(make_run_folder(request)),
      child_(start(request, run_folder_)),
      started_(std::chrono::steady_clock::now()) {}

/// Ends the process, and removes a run folder that was not collected.
CaseFlight::~CaseFlight() {
  child_->terminate(std::chrono::milliseconds(0));
  std::error_code ignored;
  fs::remove_all(run_folder_, ignored);
}

std::optional<End> CaseFlight::poll() {
  if (child_->has_ended()) return judge();
  const double flown_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  if (time_limit_s_ <= 0.0 || flown_s < time_limit_s_) return std::nullopt;
  over_time_ = true;
  child_->terminate(std::chrono::milliseconds(0));
  return judge();
}

End CaseFlight::judge() {
  Result result;
  result.number = one_.number;
  result.attempt = attempt_;
  result.case_sha256 = identity_;
  const Computer computer = this_computer();
  result.host = computer.host;
  result.processor = computer.processor;
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  result.cpu_s = child_->processor_time_s();
  if (over_time_) {
    result.state = State::kOverTime;
    result.reason = fmt::format("not complete after {:g} s", time_limit_s_);
    return {End::Kind::kResult, std::move(result)};
  }
  if (child_->killed_by() || child_->exit_status() == app::kInterrupted)
    return {End::Kind::kKilled, std::move(result), child_->killed_by() ? child_->status_text() : "interrupted"};
  const Json summary = read_summary_of(run_folder_);
  const int status = child_->exit_status().value_or(app::kFailed);
  const bool has_verdict = status == app::kDone || status == app::kNeverNavigated || status == app::kNotAchieved;
  if (!has_verdict || !is_true(summary, "complete")) return judge_failure(std::move(result), summary);
  result.numbers = numbers_of(summary);
  result.verdict = text_in(summary, "verdict");
  result.commands_sha256 = text_in(summary, "commands_sha256");
  result.telemetry_sha256 = text_in(summary, "telemetry_sha256");
  result.waypoints_sha256 = waypoints_sha256(summary);
  if (status == app::kNeverNavigated) result.reason = "never navigated: no estimate was valid";
  if (has_fault_without_effect(result.numbers)) {
    result.state = State::kVoid;
    result.reason = "a fault of the scenario never took effect";
  }
  return {End::Kind::kResult, std::move(result)};
}

End CaseFlight::judge_failure(Result result, const Json& summary) const {
  const int status = child_->exit_status().value_or(app::kFailed);
  std::string reason = text_in(summary, "incomplete_reason");
  const std::string said = last_line(child_->output_tail());
  const bool has_reason = !reason.empty() && !reason.starts_with("running in process");
  if (!has_reason) reason = said.empty() ? child_->status_text() : said;
  if (status == app::kFailed && !is_of_the_computer(reason) && !is_of_the_computer(said)) {
    result.state = State::kFailed;
    result.reason = reason;
    return {End::Kind::kResult, std::move(result)};
  }
  // Refused although it was loaded, or a program that does not even start.
  return {End::Kind::kTrouble, std::move(result), reason};
}

}  // namespace vbar::campaign
