#pragma once
// A thruster whose burns are too small or too large while a fault is present, or that reports what it did not do.

#include <memory>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/twins/actuator.h"

namespace vbar::faults {

/// Numbers of impulses that nobody commanded begin here; flight software never gets there.
inline constexpr std::int32_t kFirstUncommanded = 1'000'000'000;

class FaultyThruster final : public twins::Actuator {
 public:
  FaultyThruster(std::unique_ptr<twins::Actuator> thruster, std::vector<mission::Fault> faults);

  /// A report that is not to be sent has no packet.
  twins::Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) override;

 private:
  std::unique_ptr<twins::Actuator> thruster_;
  std::vector<mission::Fault> faults_;
};

/// An impulse of a thruster that is stuck open.
struct UncommandedImpulse {
  fsw::GpsTime time;
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
  std::int32_t id = 0;
};

/// One each second of such faults, from its middle.
[[nodiscard]] std::vector<UncommandedImpulse> uncommanded_impulses(const std::vector<mission::Fault>& faults);

}  // namespace vbar::faults
