#include "emulators/grand/control/control_servers.h"

namespace vbar::grand::bench {

std::unique_ptr<ControlServers> make_control_servers(boost::asio::io_context& context, Engine& engine,
                                                     const ControlSettings& settings) {
  switch (settings.protocol) {
    case ControlProtocol::kSkydel:
      return make_skydel_server(context, engine, settings);
    case ControlProtocol::kSimgen:
      return make_simgen_server(context, engine, settings);
    case ControlProtocol::kTemplate:
      return make_template_server(context, engine, settings);
  }
  throw std::logic_error("control servers: unknown protocol");
}

FaultEffect fault_of(const ControlFaults& faults, std::string_view command, ControlStatistics& statistics) {
  const auto is = [&](const std::string& name) { return !name.empty() && name == command; };
  FaultEffect effect = FaultEffect::kNone;
  if (faults.is_silent || is(faults.unanswered_command)) effect = FaultEffect::kNoAnswer;
  if (is(faults.refused_command)) effect = FaultEffect::kRefusal;
  if (is(faults.closing_command)) effect = FaultEffect::kClosing;
  if (effect != FaultEffect::kNone) ++statistics.faults_applied;
  return effect;
}

}  // namespace vbar::grand::bench
