#include "host_sim/report/words.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <vbar/explained_codes.h>
#include <vbar/fields.h>

#include "fsw/faults/fault_table.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/verdict.h"

namespace vbar::report {

namespace {

template <std::size_t size>
std::string name_in(const Code (&codes)[size], int value) {
  const bool known = std::ranges::any_of(codes, [value](const Code& code) { return code.value == value; });
  if (!known) return fmt::format("unknown ({})", value);
  std::string name = word_of({codes, size, false}, value);
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace

std::string mode_name(int mode) {
  return name_in(codes::mode_command_kMode, mode);
}
std::string solver_name(int solver) {
  return solver == waypoint::kSolverKoenigDamico ? "Koenig-D'Amico" : name_in(codes::waypoint_kSolver, solver);
}
std::vector<int> solvers() {
  std::vector<int> all;
  for (const Code& code : codes::waypoint_kSolver)
    if (code.value != waypoint::kSolverNone) all.push_back(code.value);
  return all;
}
std::string status_name(int status) {
  return name_in(codes::telemetry_control_kStatus, status);
}
std::string sighting_name(int status) {
  return name_in(codes::telemetry_image_kStatus, status);
}
std::string pose_sighting_name(int status) {
  return name_in(codes::telemetry_pose_kStatus, status);
}

namespace {

/// Whether the source of sensor data is a testbed.
bool is_testbed(const std::string& source) {
  return !source.empty() && source != "digital" && source != "recorded";
}

std::vector<std::string> testbeds_of(const Summary& summary) {
  std::vector<std::string> testbeds;
  for (const std::string& source : {summary.gnss, summary.camera})
    if (is_testbed(source) && std::ranges::find(testbeds, source) == testbeds.end()) testbeds.push_back(source);
  return testbeds;
}

/// Returns what the testbed reports of itself: "emulated", "hardware"; empty if it reports nothing.
std::string bench_of(const Summary& summary, const std::string& testbed) {
  const auto figures = summary.testbeds.find(testbed);
  if (figures == summary.testbeds.end()) return {};
  const auto bench = figures->second.find("bench");
  if (bench == figures->second.end()) return {};
  const auto* const text = std::get_if<std::string>(&bench->second);
  return text != nullptr ? *text : std::string();
}

/// Returns the name of the flight computer; empty: in the process of the simulation.
std::string computer_name(const std::string& target) {
  constexpr std::array<std::pair<const char*, const char*>, 5> kNames{{{"in_process", ""},
                                                                       {"host_process", "process of its own"},
                                                                       {"zynq_qemu", "emulated Zynq"},
                                                                       {"zynq_linux_qemu", "ARM Linux, emulated"},
                                                                       {"board", "board"}}};
  const auto known = std::ranges::find_if(kNames, [&](const auto& name) { return target == name.first; });
  return known == kNames.end() ? target : known->second;
}

}  // namespace

std::string loop_name(const Summary& summary) {
  const std::string computer = computer_name(summary.flight_computer);
  const std::vector<std::string> testbeds = testbeds_of(summary);
  if (!testbeds.empty()) {
    std::string name = "HIL";
    for (const std::string& testbed : testbeds) {
      const std::string bench = bench_of(summary, testbed);
      name += ", " + (bench.empty() ? "testbed " + testbed : bench + " bench");
    }
    return computer.empty() ? name : name + ", " + computer;
  }
  if (summary.flight_computer == "in_process" || summary.flight_computer == "host_process")
    return "SIL, " + (computer.empty() ? std::string("in process") : computer);
  return computer.empty() ? "not stated" : "PIL, " + computer;
}

std::vector<std::string> emulated_testbeds(const Summary& summary) {
  std::vector<std::string> testbeds = testbeds_of(summary);
  std::erase_if(testbeds, [&](const std::string& testbed) { return bench_of(summary, testbed) != "emulated"; });
  return testbeds;
}

namespace {

constexpr std::string_view kFault = "fault";

std::string response_of(int fault) {
  const fsw::faults::Rule& rule = fsw::faults::kFaultTable[fsw::faults::place_of(fault)];
  const std::string detected =
      rule.window == 1 ? "" : fmt::format(", once {} of {} checks detect it", rule.limit, rule.window);
  switch (rule.response) {
    case fsw::faults::Response::kReport:
      return "reports it" + detected;
    case fsw::faults::Response::kIsolate:
      return "does not use what failed" + detected;
    case fsw::faults::Response::kHold:
      return "plans no burn but a retreat, in a mission with [safety]" + detected;
    case fsw::faults::Response::kRetreat:
      return "retreats, in a mission with [safety]" + detected;
  }
  return {};
}

void add_codes(bool of_faults, std::vector<ExplainedWord>& words) {
  for (const ExplainedCode& code : kExplainedCodes) {
    const bool is_fault = code.quantity == kFault;
    if (is_fault != of_faults) continue;
    words.push_back(
        {code.word, code.quantity, code.owner, code.meaning, is_fault ? response_of(code.value) : "", code.turn});
  }
}

void add_counts(std::vector<ExplainedWord>& words) {
  const telemetry_health health{};
  visit_fields(health, [&](const Field& field, const auto& /*value*/) {
    if (field.codes.count > 0 || std::string_view(field.name) == "step") return;
    words.push_back({field.name, "count", "telemetry_health", field.meaning, "", ""});
  });
}

void add_verdicts(std::vector<ExplainedWord>& words) {
  for (int k = 0; k <= static_cast<int>(Outcome::kIncomplete); ++k) {
    const auto outcome = static_cast<Outcome>(k);
    std::string word(word_of(outcome));
    std::ranges::replace(word, ' ', '_');
    const bool is_by_criteria =
        outcome == Outcome::kNotJudged || outcome == Outcome::kMissed || outcome == Outcome::kUnsafe;
    words.push_back(
        {std::move(word), "verdict", "", std::string(meaning_of(outcome)), "",
         is_by_criteria ? "[[waypoint]], keep_out_radius_m, or [[limit]] in place of a default criterion" : ""});
  }
}

}  // namespace

std::vector<ExplainedWord> explained_words() {
  std::vector<ExplainedWord> words;
  add_codes(true, words);
  add_counts(words);
  add_verdicts(words);
  add_codes(false, words);
  return words;
}

}  // namespace vbar::report
