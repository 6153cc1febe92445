#include "hil_drivers/testbeds.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "hil_drivers/grand/grand_kind.h"

namespace vbar::testbeds {
namespace {

constexpr const TestbedKind* kTestbedKinds[] = {&grand::kGrand};

}  // namespace

std::span<const TestbedKind* const> testbed_kinds() {
  return kTestbedKinds;
}

const TestbedKind* find_testbed(std::string_view name) {
  const auto found = std::ranges::find_if(kTestbedKinds, [&](const TestbedKind* kind) { return kind->name == name; });
  return found == std::end(kTestbedKinds) ? nullptr : *found;
}

std::shared_ptr<TestbedRun> OpenTestbeds::run_of(const TestbedKind& kind, const RunContext& context) {
  if (const auto known = by_name_.find(kind.name); known != by_name_.end()) return known->second;
  const auto& testbeds = context.mission.testbeds;
  const auto of_mission = std::ranges::find(testbeds, kind.name, &mission::Testbed::name);
  if (of_mission == testbeds.end())
    throw std::logic_error("the mission has no [testbed." + std::string(kind.name) + "]");
  auto run = kind.open(*of_mission->settings, context);
  by_name_.emplace(kind.name, run);
  runs_.push_back(run);
  return run;
}

}  // namespace vbar::testbeds
