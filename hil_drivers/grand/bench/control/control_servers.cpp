#include "hil_drivers/grand/bench/control/control_servers.h"

#include "hil_drivers/grand/bench/control/control_common.h"

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

}  // namespace vbar::grand::bench
