#pragma once
// The purpose of crops.

#include <string_view>

namespace vbar::training {

/// Purpose of a crop. Held-out crops show materials near those of the target's own file, unlike all crops of the other
/// kinds.
enum class CropKind { kTraining, kCalibration, kHeldOut };

[[nodiscard]] constexpr std::string_view name_of(CropKind kind) {
  switch (kind) {
    case CropKind::kCalibration:
      return "calibration";
    case CropKind::kHeldOut:
      return "held_out";
    case CropKind::kTraining:
      break;
  }
  return "training";
}

}  // namespace vbar::training
