// The kinds of RF generators. A further one is a folder beside these and one line here.

#include <array>

#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/generators/simgen/simgen_generator.h"
#include "hil_drivers/grand/generators/skydel/skydel_generator.h"
#include "hil_drivers/grand/generators/template_format/template_generator.h"

namespace vbar::grand {

std::span<const GeneratorKind* const> generator_kinds() {
  static const std::array kKinds = {&kSkydelKind, &kSimgenKind, &kTemplateKind};
  return kKinds;
}

}  // namespace vbar::grand
