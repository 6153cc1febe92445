#pragma once
// Centroid of an object in an image.

#include "fsw/vision/imaging/background.h"
#include "fsw/vision/imaging/components.h"

namespace vbar::fsw::imaging {

struct Centroid {
  bool is_found = false;
  double x = 0.0;  ///< px, from the image's first pixel
  double y = 0.0;
  double sigma_px = 0.0;   ///< each axis, by photon and read noise
  double radius_px = 0.0;  ///< sigma of the Gaussian fitted to the light within the window, along the wider axis
  bool is_cut = false;     ///< its window extends beyond the image or into missing pixels
};

/// Returns the iterated Gaussian-weighted centroid of a point source, starting from the brightest 3 x 3 pixels of its
/// component: SExtractor's windowed positions (docs of SExtractor 2.19, section 10.7.1; for a Gaussian source as good
/// as a fit). The window is somewhat wider than the image of a point, which keeps the bias of sampling below 0.003 px
/// at a width of 0.8 px. The centroid is not found if the iteration diverges or there is no light: then the component's
/// own moments are better.
Centroid windowed_centroid(const ImageView& image, const Background& background, const Component& component,
                           double point_spread_sigma_px, double gain_dn_per_electron);

/// Returns the intensity-weighted mean over the component's pixels.
Centroid component_centroid(const Background& background, const Component& component, double gain_dn_per_electron);

/// Returns the root of the larger eigenvalue of the component's intensity-weighted second moments, px.
double component_radius(const Component& component);

}  // namespace vbar::fsw::imaging
