#pragma once
// Common parts of the servers of the three protocols.

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/grand/bench/control/control_servers.h"

namespace vbar::grand::bench {

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
