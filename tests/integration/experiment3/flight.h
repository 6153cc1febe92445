#pragma once
// Whole flights of missions/experiment3.toml and what is asked of them.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fsw/packets/messages.h"
#include "tests/integration/rendezvous/flown_mission.h"
#include "tests/support/figures.h"

namespace vbar::test {

/// Errors of one flight from its first fix on.
struct Flight {
  FlownMission flown;
  std::optional<double> first_fix_s;  ///< after the start
  double mean_position_m = 0.0;
  double mean_velocity_mps = 0.0;
  accuracy::Largest largest_position_m;
};

/// Flies it from this seed. Fails the test if it does not come to its end.
Flight fly_experiment3(std::uint64_t seed, std::vector<std::string> overrides = {}, const Wrap& wrap = {});

/// Telemetry of one kind, decoded, in order.
template <class Message>
std::vector<Message> telemetry_of(const FlownMission& flown);

}  // namespace vbar::test
