#pragma once
// Wide halo of a camera's lens, from the image of its core.

#include <vector>

#include "host_sim/twins/camera/photon_image.h"

namespace vbar::optical_stimulator::bench {

/// Takes `fraction` of the light of every pixel and spreads it by a Gaussian of `sigma_px` (2 px or more: the halo is
/// computed on sums of 4 x 4 pixels). The light that leaves the image is lost. `work` is reused between calls.
void spread_halo(double fraction, double sigma_px, twins::camera::PhotonImage& image, std::vector<float>& work);

}  // namespace vbar::optical_stimulator::bench
