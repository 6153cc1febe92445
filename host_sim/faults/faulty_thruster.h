#pragma once
// A thruster whose burns are too small or too large while a fault is present, or that reports what it did not do.

#include <memory>
#include <vector>

#include "host_sim/faults/fault_schedule.h"
#include "host_sim/twins/actuator.h"

namespace vbar::faults {

/// First number of uncommanded impulses; the numbers of flight software stay below.
inline constexpr std::int32_t kFirstUncommanded = 1'000'000'000;

class FaultyThruster final : public twins::Actuator {
 public:
  FaultyThruster(std::unique_ptr<twins::Actuator> thruster, std::shared_ptr<FaultSchedule> schedule);

  /// A report that is not to be sent has no packet.
  twins::Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) override;

 private:
  std::unique_ptr<twins::Actuator> thruster_;
  std::shared_ptr<FaultSchedule> schedule_;
};

/// An impulse of a thruster that is stuck open.
struct UncommandedImpulse {
  fsw::GpsTime time;
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
  std::int32_t id = 0;
};

/// Impulses of thrusters that are stuck open: one each second of such a fault, from its middle.
class UncommandedImpulses {
 public:
  explicit UncommandedImpulses(std::shared_ptr<const FaultSchedule> schedule);

  /// Returns the impulses of faults whose beginning has become known since the last call.
  [[nodiscard]] std::vector<UncommandedImpulse> take();

 private:
  std::shared_ptr<const FaultSchedule> schedule_;
  std::vector<bool> is_taken_;  ///< for each fault
  std::int32_t next_id_ = kFirstUncommanded;
};

}  // namespace vbar::faults
