#pragma once
// Spacecraft in the testbed: the trajectory of its antenna and its receiver.

#include <optional>

#include "hil_drivers/grand/receiver_link.h"
#include "hil_drivers/grand/trajectory/antenna_trajectory.h"
#include "hil_drivers/testbed.h"

namespace vbar::grand {

struct Vehicle {
  explicit Vehicle(testbeds::ReceiverPlan of) : plan(std::move(of)) {}

  testbeds::ReceiverPlan plan;
  // Members that exist from the start of the testbed on.
  std::optional<AntennaTrajectory> trajectory;
  std::unique_ptr<ReceiverLink> link;
  fsw::Duration last_sample{-1};  ///< time of the last sample sent, since the start
  GeneratorState state{};
};

}  // namespace vbar::grand
