#include "host_sim/sensors/installed_testbeds.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host_sim/files/own_program.h"

namespace vbar::testbeds {
namespace {

Drivers& installed() {
  static Drivers drivers;
  return drivers;
}

bool has_driver(const TestbedKind* kind) {
  return kind->open != nullptr;
}

}  // namespace

void install(Drivers drivers) {
  installed() = std::move(drivers);
}

void leave_to_vbar_hil() {
  if (auto program = files::program_beside("hil"); !program.empty()) throw DriverElsewhere{std::move(program)};
}

std::span<const TestbedKind* const> testbed_kinds() {
  return installed().testbeds;
}

std::span<const engine::WallClockSource* const> testbed_clocks() {
  return installed().clocks;
}

const TestbedKind* find_testbed(std::string_view name) {
  const auto kinds = testbed_kinds();
  const auto found = std::ranges::find(kinds, name, &TestbedKind::name);
  return found == kinds.end() ? nullptr : *found;
}

void require_driver(std::string_view name) {
  if (const TestbedKind* const kind = find_testbed(name); kind != nullptr && !has_driver(kind)) leave_to_vbar_hil();
}

void require_all_drivers() {
  if (!std::ranges::all_of(testbed_kinds(), has_driver)) leave_to_vbar_hil();
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
