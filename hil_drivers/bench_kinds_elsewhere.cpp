// Without the drivers of the benches. Nothing else may be in this file: a program that defines bench_kinds() itself
// must not need it from the library.

#include "hil_drivers/bench_kinds.h"

namespace vbar::testbeds {
namespace {

const TestbedKind kOpticalStimulator{{"optical_stimulator", read_without_driver}, nullptr};
const TestbedKind kTron{{"tron", read_without_driver}, nullptr};

constexpr const TestbedKind* kBenchKinds[] = {&kOpticalStimulator, &kTron};

}  // namespace

std::span<const TestbedKind* const> bench_kinds() {
  return kBenchKinds;
}

}  // namespace vbar::testbeds
