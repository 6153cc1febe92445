#pragma once
// The testbeds of this program.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil_drivers/testbed.h"

namespace vbar::testbeds {

/// Thrown where this program meets a testbed whose driver only `program` has, which is beside it: to be caught where
/// the command line is parsed, and nowhere before, hence no std::exception.
struct DriverElsewhere {
  std::filesystem::path program;
};

[[nodiscard]] std::span<const TestbedKind* const> testbed_kinds();

/// Null if there is none of that name, as of the sources "digital" and "recorded".
[[nodiscard]] const TestbedKind* find_testbed(std::string_view name);

/// Throws DriverElsewhere if the driver of this testbed is in another program; no testbed of that name: no effect.
/// Without the other program a report leaves out what its driver would add.
void require_driver(std::string_view name);

/// As above, of all testbeds: before their tables and keys are listed.
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
