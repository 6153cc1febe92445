// The kinds of RF generators. A further one is a folder beside these and one line here.

#include "hil_drivers/grand/generators/generator.h"

#include <array>

namespace vbar::grand {

std::span<const GeneratorKind* const> generator_kinds() {
  static const std::array kKinds = {&kSkydelKind, &kSimgenKind, &kTemplateKind};
  return kKinds;
}

}  // namespace vbar::grand
