#pragma once
// Remote interfaces of the emulated generator on 127.0.0.1: control connections over TCP and trajectory samples over
// UDP, in the protocol of one kind of generator. They call the engine; the engine calls them back.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/grand/bench/generator/engine.h"
#include "hil_drivers/grand/wire/template_format.h"

namespace vbar::grand::bench {

enum class ControlProtocol { kSkydel, kSimgen, kTemplate };

struct ControlSettings {
  ControlProtocol protocol = ControlProtocol::kSkydel;
  /// Ports of control connections: one per vehicle for Skydel, and for a template whose datagrams are distinguished by
  /// their port; otherwise one. Beyond the end of the list, or for 0, any free port is used.
  std::vector<std::uint16_t> control_ports = {};
  /// Ports of samples: one per vehicle for Skydel; otherwise none, the UDP port has the number of the control port.
  std::vector<std::uint16_t> hil_ports = {};
  std::uint32_t engine_latency_ms = 40;       ///< as reported by Skydel
  std::uint32_t streaming_buffer_ms = 200;    ///< as reported by Skydel
  wire::TemplateFormat template_format = {};  ///< format of the template
};

/// Faults of the remote interface. A command is named as on the wire: "SetHilTjoin", "RU", or the text of a line of the
/// template. An empty text is without effect.
struct ControlFaults {
  std::string refused_command = {};                 ///< answered by an error...
  std::string refusal = "refused by the scenario";  ///< ...with this text
  std::string unanswered_command = {};              ///< neither executed nor answered
  std::string closing_command = {};                 ///< the connection is closed instead of an answer
  bool is_silent = false;            ///< no command is executed or answered, no vehicle information is sent
  bool refuses_connections = false;  ///< a new connection is closed at once
};

struct ControlStatistics {
  std::uint64_t commands = 0;
  std::uint64_t refused = 0;          ///< commands answered by an error
  std::uint64_t malformed = 0;        ///< frames, lines or datagrams that do not decode
  std::uint64_t samples = 0;          ///< samples given to the engine
  std::uint64_t samples_refused = 0;  ///< samples not given to it: no trajectory is expected yet
  std::uint64_t faults_applied = 0;   ///< answers changed by ControlFaults
};

class ControlServers {
 public:
  ControlServers() = default;
  ControlServers(const ControlServers&) = delete;
  ControlServers& operator=(const ControlServers&) = delete;
  virtual ~ControlServers() = default;

  /// Returns the ports bound, in the order of the settings.
  [[nodiscard]] virtual std::vector<std::uint16_t> control_ports() const = 0;
  [[nodiscard]] virtual std::vector<std::uint16_t> hil_ports() const = 0;

  virtual void set_faults(const ControlFaults& faults) = 0;
  /// Closes every connection, as a generator that ends does; new ones are accepted.
  virtual void close_connections() = 0;

  [[nodiscard]] virtual ControlStatistics statistics() const = 0;
};

/// Binds and listens; the work is done by `context`. All three arguments outlive the servers. Throws
/// std::runtime_error, one sentence, if a port is not available.
std::unique_ptr<ControlServers> make_control_servers(boost::asio::io_context& context, Engine& engine,
                                                     const ControlSettings& settings);

}  // namespace vbar::grand::bench
