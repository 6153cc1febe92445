#pragma once
// Spirent SimGEN: one connection for commands; motion of all vehicles as datagrams to the UDP port of the same number
// in real time, as lines of the connection in lock-step.

#include "hil_drivers/grand/generators/generator.h"

namespace vbar::grand {

extern const GeneratorKind kSimgenKind;

}  // namespace vbar::grand
