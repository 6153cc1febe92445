#pragma once
// Check that a camera answers at all, faster than by the repeated commands of Aravis (2.5 s each).

#include <chrono>
#include <string>

namespace vbar::gige {

/// Returns the address of this computer that routes to `address` (IPv4); nothing is sent. Throws std::invalid_argument
/// for a text that is not an address, std::runtime_error without a route.
[[nodiscard]] std::string routing_address(const std::string& address);

/// Asks for a register (GVCP, to this address only), `tries` times with `wait` for an acknowledge, whatever its status.
[[nodiscard]] bool camera_answers(const std::string& address, int tries, std::chrono::milliseconds wait);

}  // namespace vbar::gige
