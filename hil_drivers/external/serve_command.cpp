#include "hil_drivers/external/serve_command.h"

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/core.h>

#include "hil_drivers/external/source_server.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/io/byte_channel.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/load.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/run_truth.h"
#include "pil_bridge/transport.h"

namespace vbar::external {
namespace {

/// A run that is stopped in a debugger is waited for; one that is gone closes the line.
constexpr std::chrono::hours kPatience{24};

std::unique_ptr<twins::PacketSource> make_source(const mission::Mission& mission, const Opening& opening) {
  auto made = sensors::make_sources(mission, app::flying_spacecraft(mission), mission::data_directory(), nullptr);
  const auto found = std::ranges::find(made.sources, opening.name, &twins::NamedSource::name);
  if (found == made.sources.end())
    throw std::runtime_error(fmt::format("the mission has no source \"{}\"", opening.name));
  return std::move(found->packets);
}

/// Answers as the source that the first batch names.
class Served {
 public:
  explicit Served(const mission::Mission& mission)
      : mission_(mission),
        numbers_(numbers_of(mission)),
        source_([&mission](const Opening& opening) { return make_source(mission, opening); }) {}

  std::vector<twins::Packet> answer(std::span<const twins::Packet> packets) {
    const Batch batch = batch_of(packets, numbers_);
    if (!truth_ && batch.opening && batch.opening->name == kTruth) truth_.emplace(make_truth(), numbers_);
    return truth_ ? truth_->answer(batch) : source_.answer(batch);
  }

 private:
  [[nodiscard]] ServedTruth::Make make_truth() const {
    return [&mission = mission_] {
      return std::make_unique<app::RunTruth>(mission, app::flying_spacecraft(mission), mission::data_directory());
    };
  }

  const mission::Mission& mission_;
  SpacecraftNumbers numbers_;
  ServedSource source_;
  std::optional<ServedTruth> truth_;
};

}  // namespace

int serve_command(const ServeOptions& options, const std::string& version) {
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  Served served(mission);
  pil::StreamTransport line(
      io::adopt_socket(io::FileDescriptor(options.stream), fmt::format("descriptor {}", options.stream)));
  BatchServer server(line, fmt::format("vbar {}, {}", version, mission.name),
                     [&](std::span<const twins::Packet> batch) { return served.answer(batch); });
  server.run(kPatience);
  return app::kDone;
}

}  // namespace vbar::external
