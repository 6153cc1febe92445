#pragma once
// Interface of the emulated generator for its control protocols: the servers (../control) call it, it calls them back.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/wire/template_format.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::grand::bench {

enum class EngineState { kIdle, kConfigured, kArmed, kStreaming, kStopped, kError };

/// State and counters of one vehicle.
struct VehicleReport {
  fsw::Duration time;     ///< end of the motion so far, since start
  int extrapolation = 0;  ///< 0 deterministic, 1 non-deterministic (the join of the last sample has ended), 2 snap
  double extrapolated_s = 0.0;  ///< time since the last sample
  std::uint64_t samples = 0, late = 0, doubled = 0, snaps = 0;
  std::uint64_t out_of_order = 0;  ///< older than the sample in use, ignored
  std::uint64_t rejected = 0;      ///< not usable: not finite, not in an orbit, more than 10 s ahead
};

/// Engine of the generator. Single-threaded: everything is called from the event loop of the program.
class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  [[nodiscard]] virtual std::size_t vehicles() const = 0;
  [[nodiscard]] virtual EngineState state() const = 0;
  [[nodiscard]] virtual std::string error() const = 0;

  /// Discards configuration and motion.
  virtual void reset() = 0;
  /// Each command returns an empty text, or the reason of a rejection, one sentence.
  virtual std::string set_start_time(fsw::GpsTime time) = 0;
  virtual std::string set_join(fsw::Duration join) = 0;
  virtual std::string arm() = 0;
  /// Begins to radiate: in lock-step at once and as far as the samples reach; in real time `delay` after the last edge
  /// of the 1PPS (PPS0).
  virtual std::string start(fsw::Duration delay) = 0;
  virtual void stop() = 0;

  /// Processes a sample; one whose time has passed is used from now on and counted as late.
  virtual void sample(std::size_t vehicle, const TrajectorySample& sample) = 0;

  [[nodiscard]] virtual VehicleReport report(std::size_t vehicle) const = 0;
  /// Returns the motion at a time at most a block before report().time: a generator sends it back as vehicle
  /// information.
  [[nodiscard]] virtual TrajectorySample flown(std::size_t vehicle, fsw::Duration time) const = 0;
  /// Returns CLOCK_REALTIME, ms, at the PPS edge after which start() counts; 0 before it.
  [[nodiscard]] virtual std::int64_t system_time_at_pps0_ms() const = 0;

  /// Called by the engine whenever it has moved the vehicle further and all bytes that left the receiver by then have
  /// been written to its lines. Several servers may listen.
  std::vector<std::function<void(std::size_t vehicle)>> on_progress;
  /// Called at the next edge of the 1PPS, once, then forgotten (WaitAndResetPPS).
  std::vector<std::function<void()>> on_next_edge;
};

// Remote interfaces of the emulated generator on 127.0.0.1: control connections over TCP and trajectory samples over
// UDP, in the protocol of one kind of generator. They call the engine; the engine calls them back.

enum class ControlProtocol { kSkydel, kSimgen, kTemplate };

/// Version that the emulated generator states of itself.
inline constexpr std::string_view kEmulatedVersion = "vbar_grand_bench (emulated)";

struct ControlSettings {
  ControlProtocol protocol = ControlProtocol::kSkydel;
  /// Ports of control connections: one per vehicle for Skydel, and for a template whose datagrams are distinguished by
  /// their port; otherwise one. Beyond the end of the list, or for 0, any free port is used.
  std::vector<std::uint16_t> control_ports = {};
  /// Ports of samples: one per vehicle for Skydel; otherwise none, the UDP port has the number of the control port.
  std::vector<std::uint16_t> hil_ports = {};
  std::uint32_t engine_latency_ms = 40;       ///< as reported by Skydel: advance of the engine before the radio
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

// Common parts of the servers of the three protocols.

/// Error of a command that is not executed: one sentence for the client.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class FaultEffect { kNone, kRefusal, kNoAnswer, kClosing };
/// Returns the fault of the scenario for this command; it is counted.
FaultEffect fault_of(const ControlFaults& faults, std::string_view command, ControlStatistics& statistics);

inline std::uint16_t port_at(const std::vector<std::uint16_t>& ports, std::size_t index) {
  return index < ports.size() ? ports[index] : std::uint16_t{0};
}

std::unique_ptr<ControlServers> make_skydel_server(boost::asio::io_context& context, Engine& engine,
                                                   const ControlSettings& settings);
std::unique_ptr<ControlServers> make_simgen_server(boost::asio::io_context& context, Engine& engine,
                                                   const ControlSettings& settings);
std::unique_ptr<ControlServers> make_template_server(boost::asio::io_context& context, Engine& engine,
                                                     const ControlSettings& settings);

}  // namespace vbar::grand::bench
