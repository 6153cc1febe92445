#include "host_sim/simulation/recorded_mission.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/run_folder.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/flight_computer.h"

namespace vbar::app {

std::string_view flight_computer_key(std::string_view assignment) {
  constexpr std::string_view kTable = "flight_computer.";
  std::string_view path = assignment.substr(0, assignment.find('='));
  if (path.starts_with("spacecraft.")) {
    path.remove_prefix(std::string_view("spacecraft.").size());
    path.remove_prefix(std::min(path.find('.'), path.size() - 1) + 1);
  }
  return path.starts_with(kTable) ? path.substr(kTable.size()) : std::string_view();
}

std::vector<std::string> overrides_of_run(const std::filesystem::path& run_folder) {
  std::vector<std::string> overrides;
  std::ifstream lines(run_folder / kOverridesCopy);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) overrides.push_back(line);
  return overrides;
}

namespace {

const mission::FlightComputer& flight_computer_of(const mission::Mission& mission) {
  try {
    return *flying_spacecraft(mission).flight_computer;
  } catch (const std::runtime_error& error) {
    throw Refused(error.what());
  }
}

}  // namespace

void check_trust(const mission::Mission& mission, const std::filesystem::path& run_folder,
                 std::span<const std::string> given, bool is_trusted) {
  const mission::FlightComputer& computer = flight_computer_of(mission);
  if (is_trusted) return;
  const bool is_board = computer.target == mission::FlightTarget::kBoard;
  const bool is_serial = computer.link == mission::FlightLink::kSerial;
  const std::array<std::pair<std::string_view, std::string>, 5> named{
      {{"library", computer.library},
       {"image", computer.image},
       {"device", is_board && is_serial ? computer.device : ""},
       {"address", is_board && !is_serial ? computer.address : ""},
       {"telecommand_key_file", computer.telecommand_key_file}}};
  const auto refuse = [&](const std::string& path, const std::string& value) {
    throw Refused(fmt::format("{}: names {} = \"{}\", which is used only with --trust, or with --set",
                              run_folder.string(), path, value));
  };
  for (const auto& [key, value] : named) {
    const auto is_this = [key = key](const std::string& assignment) { return flight_computer_key(assignment) == key; };
    if (value.empty() || std::ranges::any_of(given, is_this)) continue;
    refuse(fmt::format("flight_computer.{}", key), value);
  }
  const mission::UdpAddress& udp = mission.telemetry.udp;
  const auto is_udp = [](const std::string& assignment) { return assignment.starts_with("telemetry.udp="); };
  if (udp.port != 0 && std::ranges::none_of(given, is_udp))
    refuse("telemetry.udp", fmt::format("{}:{}", udp.host, udp.port));
}

report::Summary summary_of_run(const std::filesystem::path& run_folder) {
  try {
    return report::read_summary(report::summary_file(run_folder));
  } catch (const std::runtime_error& error) {
    throw Refused(error.what());
  }
}

}  // namespace vbar::app
