#pragma once
// GenICam description (GenApi 1.1 schema) of the emulated camera.

#include <string>
#include <vector>

#include "hil_drivers/gige/device/features.h"

namespace vbar::gige {

[[nodiscard]] std::string genicam_xml(const Description& description, const std::vector<Feature>& features);

}  // namespace vbar::gige
