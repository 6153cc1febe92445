#pragma once
// Testbeds of this program.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil_drivers/testbed.h"

namespace vbar::testbeds {

/// Thrown where this program needs a testbed whose driver only `program` has, which is beside it. It is caught where
/// the command line is parsed, and nowhere before; hence it is not a std::exception.
struct DriverElsewhere {
  std::filesystem::path program;
};

[[nodiscard]] std::span<const TestbedKind* const> testbed_kinds();

/// Returns the kind of this name; null if there is none, as for the sources "digital" and "recorded".
[[nodiscard]] const TestbedKind* find_testbed(std::string_view name);

/// Throws DriverElsewhere if the driver of this testbed is in another program. Without the other program a report
/// leaves out what its driver would add. The call has no effect if there is no testbed of that name.
void require_driver(std::string_view name);

/// Requires the drivers of all testbeds, before their tables and keys are listed.
void require_all_drivers();

/// Testbeds that the sensors of one run use, each opened by the first that does.
class OpenTestbeds {
 public:
  /// Returns the run of a kind, opened if it is the first call. Throws what the testbed throws, and std::logic_error
  /// for one that the mission does not have.
  std::shared_ptr<TestbedRun> run_of(const TestbedKind& kind, const RunContext& context);

  [[nodiscard]] const std::vector<std::shared_ptr<TestbedRun>>& runs() const { return runs_; }

 private:
  std::map<std::string, std::shared_ptr<TestbedRun>, std::less<>> by_name_;
  std::vector<std::shared_ptr<TestbedRun>> runs_;
};

}  // namespace vbar::testbeds
