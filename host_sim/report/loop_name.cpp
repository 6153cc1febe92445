#include "host_sim/report/loop_name.h"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

namespace vbar::report {
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

}  // namespace vbar::report
