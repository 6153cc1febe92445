// Emulated SimGEN: remote commands as lines, motion as lines or datagrams.

#include <fmt/format.h>

#include "emulators/grand/control/line_server.h"
#include "hil_drivers/grand/wire/simgen.h"

namespace vbar::grand::bench {
namespace {

using wire::SimgenCommand;
using wire::SimgenStatus;

class SimgenServer final : public LineServer {
 public:
  SimgenServer(boost::asio::io_context& context, Engine& engine, const ControlSettings& settings)
      : LineServer(context, engine, settings, 1) {
    serve();
  }

 private:
  using Handler = std::optional<std::string> (SimgenServer::*)(const SimgenCommand& command, const Answer& later);
  struct Command {
    std::string_view name;
    Handler handler;
  };
  static const std::vector<Command>& commands() {
    using S = SimgenServer;
    static const std::vector<Command> kCommands = {{"*IDN?", &S::identify},
                                                   {"NULL", &S::status_only},
                                                   {"START_TIME", &S::set_start_time},
                                                   {"MOT", &S::move},
                                                   {"TR", &S::set_trigger},
                                                   {"SCENARIO_ITERATION_RATE", &S::iteration_rate},
                                                   {"AR", &S::arm_scenario},
                                                   {"AR_NOWAIT", &S::arm_scenario},
                                                   {"RU", &S::run},
                                                   {"RU_NOWAIT", &S::run},
                                                   {"EN", &S::end},
                                                   {"TIME", &S::time}};
    return kCommands;
  }

  std::optional<std::string> execute(const std::string& line, const Answer& later) override {
    const SimgenCommand command = wire::parse_simgen_command(line);
    for (const Command& candidate : commands())
      if (candidate.name == command.name) return (this->*candidate.handler)(command, later);
    throw Refusal(fmt::format("the command {} is unknown to the emulated SimGEN", wire::printable(command.name)));
  }
  [[nodiscard]] std::string command_of(const std::string& line) const override {
    try {
      return wire::parse_simgen_command(line).name;
    } catch (const wire::WireError&) {
      return {};
    }
  }
  [[nodiscard]] std::string refusal_of(const std::string& reason) const override { return reply("", reason); }

  void take_datagram(std::size_t, std::span<const std::uint8_t> datagram) override {
    take_motion(wire::decode_mot(datagram));
  }
  void take_motion(const wire::SimgenMotion& motion) {
    TrajectorySample sample = motion.sample;
    if (!motion.is_timed) sample.time = time_into_run();
    take_sample(motion.vehicle - 1, sample);
  }

  std::optional<std::string> identify(const SimgenCommand&, const Answer&) {
    return reply("Spirent Communications,emulated SimGEN,0,0");
  }
  std::optional<std::string> status_only(const SimgenCommand&, const Answer&) { return reply(""); }
  std::optional<std::string> iteration_rate(const SimgenCommand&, const Answer&) { return reply("10"); }

  std::optional<std::string> set_start_time(const SimgenCommand& command, const Answer&) {
    begin_configuration(wire::start_of(command).time);
    return reply("");
  }
  std::optional<std::string> move(const SimgenCommand& command, const Answer&) {
    const wire::SimgenMotion motion = wire::motion_of(command);
    if (stage() == Stage::kIdle) throw Refusal("there is no start time; send START_TIME first");
    if (motion.vehicle > engine().vehicles())
      throw Refusal(fmt::format("vehicle {} of {}", motion.vehicle, engine().vehicles()));
    take_motion(motion);
    return reply("");
  }
  std::optional<std::string> set_trigger(const SimgenCommand& command, const Answer&) {
    const bool is_known = command.arguments.size() == 1 && command.arguments[0].size() == 1 &&
                          command.arguments[0] >= "0" && command.arguments[0] <= "2";
    if (!is_known) throw Refusal("the trigger mode is not 0, 1 or 2");
    if (stage() == Stage::kArmed || stage() == Stage::kRunning) throw Refusal("the scenario is armed or running");
    return reply("");
  }
  std::optional<std::string> arm_scenario(const SimgenCommand&, const Answer&) {
    arm();
    return reply("");
  }
  std::optional<std::string> run(const SimgenCommand&, const Answer& later) {
    start_at_edge([this, later](const std::string& refusal) { later(reply("", refusal)); });
    return std::nullopt;
  }
  std::optional<std::string> end(const SimgenCommand&, const Answer&) {
    if (stage() == Stage::kIdle || stage() == Stage::kConfigured) throw Refusal("the scenario is not running");
    stop_run();
    return reply("");
  }
  std::optional<std::string> time(const SimgenCommand&, const Answer&) {
    if (stage() != Stage::kRunning) throw Refusal("the scenario is loading or has ended");
    return reply(fmt::format("{:.3f}", fsw::seconds(time_into_run())));
  }

  [[nodiscard]] SimgenStatus status() const {
    switch (stage()) {
      case Stage::kArmed:
        return SimgenStatus::kArmed;
      case Stage::kRunning:
        return engine().state() == EngineState::kStreaming ? SimgenStatus::kRunning : SimgenStatus::kEnded;
      case Stage::kEnded:
        return SimgenStatus::kEnded;
      case Stage::kIdle:
      case Stage::kConfigured:
        break;
    }
    return SimgenStatus::kReady;
  }
  [[nodiscard]] std::string reply(const std::string& data, const std::string& error = "") const {
    const std::string reason = error.empty() && engine().state() == EngineState::kError ? engine().error() : error;
    return wire::encode_reply({static_cast<int>(status()), data, reason}) + "\n";
  }
};

}  // namespace

std::unique_ptr<ControlServers> make_simgen_server(boost::asio::io_context& context, Engine& engine,
                                                   const ControlSettings& settings) {
  return std::make_unique<SimgenServer>(context, engine, settings);
}

}  // namespace vbar::grand::bench
