// vbar replay: the recorded packets of a run into a flight computer.

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/twins/camera/recipe_log.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::app {
namespace {

/// The mission as it was flown, with the overrides of then and, over them, those of now.
mission::Mission mission_as_flown(const ReplayOptions& options) {
  std::vector<std::string> overrides;
  std::ifstream lines(options.run_folder / kOverridesCopy);
  for (std::string line; std::getline(lines, line);) overrides.push_back(line);
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  return sensors::load_mission(options.run_folder / kMissionCopy, overrides);
}

struct RecordedStep {
  std::vector<twins::PacketRecord> inputs;
  std::vector<pil::Packet> outputs;
};

twins::PacketLog read_log(const std::filesystem::path& file) {
  twins::PacketLog log = twins::read_packet_log(file);
  if (log.cut_short) fmt::print(stderr, "vbar: {}: ends within a packet; replaying what is whole\n", file.string());
  return log;
}

std::map<std::uint32_t, RecordedStep> steps_of(const twins::PacketLog& log) {
  std::map<std::uint32_t, RecordedStep> steps;
  for (const twins::PacketRecord& record : log.records) {
    RecordedStep& step = steps[record.step];
    if (record.to_flight) {
      step.inputs.push_back(record);
    } else {
      step.outputs.push_back(record.packet);
    }
  }
  return steps;
}

/// What makes the images of the log again; none if it has no recipes.
std::optional<twins::camera::TileRestorer> make_restorer(const mission::Mission& mission, const twins::PacketLog& log) {
  if (log.recipes.empty()) return std::nullopt;
  return twins::camera::TileRestorer(
      log.recipes, sensors::make_image_maker(mission, flying_spacecraft(mission), mission::data_directory()));
}

/// The packets that went to the flight software, with the image tiles made again that the log has none of.
std::vector<pil::Packet> packets_of(const std::vector<twins::PacketRecord>& records,
                                    std::optional<twins::camera::TileRestorer>& restorer) {
  std::vector<pil::Packet> packets;
  for (const twins::PacketRecord& record : records) {
    if (!record.tiles) {
      packets.push_back(record.packet);
    } else if (restorer) {
      for (pil::Packet& tile : restorer->packets_of(*record.tiles)) packets.push_back(std::move(tile));
    } else {
      throw std::runtime_error("the log lacks image tiles and has no recipe to make them from");
    }
  }
  return packets;
}

/// Where two answers part, or nothing.
std::optional<std::string> difference(const std::vector<pil::Packet>& recorded, const std::vector<pil::Packet>& now) {
  for (std::size_t k = 0; k < std::min(recorded.size(), now.size()); ++k) {
    const auto [a, b] = std::ranges::mismatch(recorded[k], now[k]);
    if (a == recorded[k].end() && b == now[k].end()) continue;
    return fmt::format("packet {} differs from byte {} on", k, a - recorded[k].begin());
  }
  if (recorded.size() == now.size()) return std::nullopt;
  return fmt::format("{} packets recorded, {} now", recorded.size(), now.size());
}

}  // namespace

int replay_command(const ReplayOptions& options) {
  const mission::Mission mission = mission_as_flown(options);
  const twins::PacketLog log = read_log(report::packet_log_file(options.run_folder));
  const std::map<std::uint32_t, RecordedStep> steps = steps_of(log);
  std::optional<twins::camera::TileRestorer> restorer = make_restorer(mission, log);
  const std::unique_ptr<pil::FlightComputer> flight_computer = connect_flight_computer(flying_spacecraft(mission));
  for (const auto& [number, step] : steps) {
    if (step.outputs.empty()) continue;  // the run broke off before the answer
    const pil::StepResult answer = flight_computer->step(number, packets_of(step.inputs, restorer));
    if (const auto what = difference(step.outputs, answer.packets)) {
      fmt::print("differs at step {}: {}\n", number, *what);
      return 2;
    }
  }
  flight_computer->close();
  fmt::print("identical: {} steps on {}\n", steps.size(), flight_computer->description());
  return 0;
}

}  // namespace vbar::app
