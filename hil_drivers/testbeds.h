#pragma once
// The testbeds of this program.

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil_drivers/testbed.h"

namespace vbar::testbeds {

[[nodiscard]] std::span<const TestbedKind* const> testbed_kinds();

/// Null if there is none of that name, as of the sources "digital" and "recorded".
[[nodiscard]] const TestbedKind* find_testbed(std::string_view name);

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
