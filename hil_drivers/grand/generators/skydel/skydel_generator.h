#pragma once
// Skydel (Safran): one instance per vehicle, each with a control connection and a port for samples; the first is the
// main instance of the start by 1PPS.

#include "hil_drivers/grand/generators/generator.h"

namespace vbar::grand {

extern const GeneratorKind kSkydelKind;

}  // namespace vbar::grand
