// vbar serve: a digital sensor of a mission at the other end of an exchange with a run (hil_drivers/external).

#include <algorithm>
#include <memory>

#include <fmt/core.h>

#include "hil_drivers/external/batch_server.h"
#include "hil_drivers/external/served_source.h"
#include "host_sim/app/build_info.h"
#include "host_sim/app/commands.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/io/byte_channels.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "pil_bridge/stream_transport.h"

namespace vbar::app {
namespace {

/// A run that is stopped in a debugger is waited for; one that is gone closes the line.
constexpr std::chrono::hours kPatience{24};

std::unique_ptr<twins::PacketSource> make_source(const mission::Mission& mission, const external::Opening& opening) {
  auto made = sensors::make_sources(mission, flying_spacecraft(mission), mission::data_directory(), nullptr);
  const auto found = std::ranges::find(made.sources, opening.name, &twins::NamedSource::name);
  if (found == made.sources.end())
    throw std::runtime_error(fmt::format("the mission has no source \"{}\"", opening.name));
  return std::move(found->packets);
}

}  // namespace

int serve_command(const ServeOptions& options) {
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  external::SpacecraftNumbers numbers;
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) numbers.add(spacecraft.name, spacecraft.number);
  external::ServedSource source([&](const external::Opening& opening) { return make_source(mission, opening); },
                                std::move(numbers));
  pil::StreamTransport line(
      io::adopt_socket(io::FileDescriptor(options.stream), fmt::format("descriptor {}", options.stream)));
  external::BatchServer server(line, fmt::format("vbar {}, {}", build_version(), mission.name),
                               [&](std::span<const twins::Packet> batch) { return source.answer(batch); });
  server.run(kPatience);
  return kDone;
}

}  // namespace vbar::app
