#pragma once
// Reader of the frame strip in an image of the camera.

#include <cstdint>
#include <span>

#include "hil_drivers/optical_stimulator/strip/strip_layout.h"

namespace vbar::optical_stimulator {

enum class StripStatus {
  kRead,
  kNone,      ///< no cell differs from the others
  kMirrored,  ///< left and right are exchanged
  kDamaged,   ///< mark or check are wrong: covered, or read in part
};

struct StripReading {
  StripStatus status = StripStatus::kNone;
  std::uint16_t frame = 0;  ///< if it has been read
  double black_dn = 0.0;    ///< mean of the darkest cell
  double white_dn = 0.0;    ///< level of the brightest cells; if the strip has been read: of the references
};

/// Reads the strip of `dn`: an image of that width, the strip's rows first; at least kStripRows rows. Cells that differ
/// by less than `contrast_dn` are not a strip. Throws std::invalid_argument for an image without the rows.
[[nodiscard]] StripReading read_strip(std::span<const std::uint16_t> dn, int width, double contrast_dn);

}  // namespace vbar::optical_stimulator
