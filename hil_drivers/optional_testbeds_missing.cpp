// Without the drivers of the benches. Nothing else may be in this file: a program that defines optional_testbeds()
// itself must not need it from the library.

#include "hil_drivers/testbeds.h"

namespace vbar::testbeds {
namespace {

const TestbedKind kOpticalStimulator{{"optical_stimulator", read_without_driver}, nullptr};
const TestbedKind kTron{{"tron", read_without_driver}, nullptr};

constexpr const TestbedKind* kOptionalTestbeds[] = {&kOpticalStimulator, &kTron};

}  // namespace

std::span<const TestbedKind* const> optional_testbeds() {
  return kOptionalTestbeds;
}

}  // namespace vbar::testbeds
