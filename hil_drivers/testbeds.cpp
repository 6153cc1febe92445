#include "hil_drivers/testbeds.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "hil_drivers/external/external_kind.h"
#include "hil_drivers/grand/grand_kind.h"
#ifdef VBAR_OPTICAL_STIMULATOR
#include "hil_drivers/optical_stimulator/stimulator_kind.h"
#endif
#ifdef VBAR_TRON
#include "hil_drivers/tron/tron_kind.h"
#endif

namespace vbar::testbeds {
namespace {

#ifdef VBAR_OPTICAL_STIMULATOR
using optical_stimulator::kOpticalStimulator;
#else
/// In the place of a driver whose libraries were not there when this program was built.
const TestbedKind kOpticalStimulator{
    {"optical_stimulator",
     [](const mission::TableReader& section) -> std::shared_ptr<const mission::TestbedSettings> {
       section.refuse("", "a testbed whose driver this program was built without",
                      "a program built with libsdl2-dev, libaravis-dev and libusb-1.0-0-dev (ci/install.sh test)");
     }},
    nullptr};
#endif

#ifdef VBAR_TRON
using tron::kTron;
#else
const TestbedKind kTron{{"tron",
                         [](const mission::TableReader& section) -> std::shared_ptr<const mission::TestbedSettings> {
                           section.refuse(
                               "", "a testbed whose driver this program was built without",
                               "a program built with libaravis-dev and libusb-1.0-0-dev (ci/install.sh test)");
                         }},
                        nullptr};
#endif

constexpr const TestbedKind* kTestbedKinds[] = {&grand::kGrand, &kOpticalStimulator, &kTron, &external::kExternal};

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
