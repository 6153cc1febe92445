#pragma once
// The testbeds and clocks of a program. Its main function installs them, so that nothing in host_sim depends on a
// driver.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/engine/clock.h"
#include "host_sim/sensors/testbed.h"

namespace vbar::testbeds {

/// What a program has drivers for.
struct Drivers {
  std::vector<const TestbedKind*> testbeds;
  std::vector<const engine::WallClockSource*> clocks;  ///< beside engine::kMonotonicClock
};

/// Makes these the testbeds and clocks of this program: once, before the first mission is read. A program without this
/// call has digital twins only.
void install(Drivers drivers);

/// Thrown where this program meets a testbed whose driver only `program` has, which is beside it: to be caught where
/// the command line is parsed, and nowhere before, hence no std::exception.
struct DriverElsewhere {
  std::filesystem::path program;
};

/// Throws DriverElsewhere unless vbar_hil, which has the drivers of all testbeds, is missing or is this program.
void leave_to_vbar_hil();

[[nodiscard]] std::span<const TestbedKind* const> testbed_kinds();

[[nodiscard]] std::span<const engine::WallClockSource* const> testbed_clocks();

/// Returns null if there is no testbed of that name, as for the sources "digital" and "recorded".
[[nodiscard]] const TestbedKind* find_testbed(std::string_view name);

/// Throws DriverElsewhere if the driver of this testbed is in another program; has no effect if no testbed has that
/// name. Without the other program a report leaves out what its driver would add.
void require_driver(std::string_view name);

/// Does the same for all testbeds: before their tables and keys are listed.
void require_all_drivers();

/// The testbeds that the sensors of one run use, each opened by the first that does.
class OpenTestbeds {
 public:
  /// Throws what the testbed throws, and std::logic_error for one that the mission does not have.
  std::shared_ptr<TestbedRun> run_of(const TestbedKind& kind, const RunContext& context);

  [[nodiscard]] const std::vector<std::shared_ptr<TestbedRun>>& runs() const { return runs_; }

 private:
  std::map<std::string, std::shared_ptr<TestbedRun>, std::less<>> by_name_;
  std::vector<std::shared_ptr<TestbedRun>> runs_;
};

}  // namespace vbar::testbeds
