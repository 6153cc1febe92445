#pragma once
// Generator whose datagrams and control lines the mission file describes (IFEN: no interface document is public).

#include "hil_drivers/grand/generators/generator.h"

namespace vbar::grand {

extern const GeneratorKind kTemplateKind;

}  // namespace vbar::grand
