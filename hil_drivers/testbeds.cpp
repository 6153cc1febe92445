#include "hil_drivers/testbeds.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "hil_drivers/bench_kinds.h"
#include "hil_drivers/external/external_kind.h"
#include "hil_drivers/grand/grand_kind.h"
#include "host_sim/files/own_program.h"

namespace vbar::testbeds {
namespace {

/// Throws unless vbar_hil is missing, or is this program.
void leave_to_vbar_hil() {
  if (auto program = files::program_beside("hil"); !program.empty()) throw DriverElsewhere{std::move(program)};
}

bool has_driver(const TestbedKind* kind) {
  return kind->open != nullptr;
}

}  // namespace

std::shared_ptr<const mission::TestbedSettings> read_without_driver(const mission::TableReader& section) {
  leave_to_vbar_hil();
  section.refuse("", "a testbed whose driver is not beside this program",
                 "vbar_hil beside it, which cmake --build --preset host makes with the packages of ci/install.sh test "
                 "(libsdl2-dev, libxrandr-dev, libaravis-dev, libusb-1.0-0-dev)");
}

std::span<const TestbedKind* const> testbed_kinds() {
  static const std::vector<const TestbedKind*> kKinds = [] {
    std::vector<const TestbedKind*> kinds{&grand::kGrand, &external::kExternal};
    kinds.insert(kinds.begin() + 1, bench_kinds().begin(), bench_kinds().end());
    return kinds;
  }();
  return kKinds;
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
