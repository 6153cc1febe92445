#pragma once
// Deblending: two or more points of light in one component, separated if there is a minimum between them.

#include <array>
#include <cstddef>

#include "fsw/imaging/background.h"
#include "fsw/imaging/components.h"

namespace vbar::fsw::imaging {

struct Blend {
  static constexpr std::size_t kMaxPeaks = 4;
  struct Peak {
    int x = 0;  ///< px, from the image's first pixel
    int y = 0;
    int sum_dn = 0;  ///< sum of the 3 x 3 pixels around, above the background
  };
  std::array<Peak, kMaxPeaks> peaks{};  ///< brightest first
  std::size_t count = 0;
};

/// Returns the maxima of sums of 3 x 3 pixels within the component. Each exceeds the minimum on the straight path to
/// every brighter one by four times the noise of that difference. The path itself exceeds the background by
/// `detection_sigmas`; otherwise it leads to another component. At most kMaxPeaks, the brightest, are returned; 1 for a
/// component of one point.
Blend separate(const ImageView& image, const Background& background, const Component& component,
               double gain_dn_per_electron, double detection_sigmas);

}  // namespace vbar::fsw::imaging
