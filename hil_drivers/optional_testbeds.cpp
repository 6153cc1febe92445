// With the drivers of the benches, as far as their libraries were there when this program was built.

#include "hil_drivers/testbeds.h"

#ifdef VBAR_OPTICAL_STIMULATOR
#include "hil_drivers/optical_stimulator/stimulator_run.h"
#endif
#ifdef VBAR_TRON
#include "hil_drivers/tron/tron_run.h"
#endif

namespace vbar::testbeds {
namespace {

#ifdef VBAR_OPTICAL_STIMULATOR
using optical_stimulator::kOpticalStimulator;
#else
const TestbedKind kOpticalStimulator{{"optical_stimulator", read_without_driver}, nullptr};
#endif

#ifdef VBAR_TRON
using tron::kTron;
#else
const TestbedKind kTron{{"tron", read_without_driver}, nullptr};
#endif

constexpr const TestbedKind* kOptionalTestbeds[] = {&kOpticalStimulator, &kTron};

}  // namespace

std::span<const TestbedKind* const> optional_testbeds() {
  return kOptionalTestbeds;
}

}  // namespace vbar::testbeds
