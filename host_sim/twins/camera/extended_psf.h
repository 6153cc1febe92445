#pragma once
// Point-spread function of an extended object: many thousand points that fill tens of pixels each way.
//
// The points are gathered on a grid whose nodes divide the pixels evenly, by the weights of a quadratic
// B-spline (Hockney and Eastwood 1981, "triangular-shaped cloud"), so that the spread of a node over the pixels is the
// same for all nodes at the same place of a pixel: one set of weights for rows and columns. The spline widens by a
// quarter of a step's square; the Gaussian is narrower by that. A wide halo is the
// image of the narrow core, spread again.

#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::twins::camera {

class ExtendedPsf {
 public:
  struct Settings {
    double core_sigma_px = 0.0;
    double halo_sigma_px = 0.0;
    double halo_fraction = 0.0;
  };

  explicit ExtendedPsf(const Settings& settings);

  /// Returns whether the halo is wide enough to be computed from the image of the core.
  [[nodiscard]] bool can_spread() const { return halo_variance_ >= 1.0 || settings_.halo_fraction == 0.0; }

  /// Adds the points, each spread over `core_reach` and `halo_reach` pixels at most. `smear_px`: their common motion
  /// during the exposure, at constant speed. Sums and centroids are exact but for what is beyond the reaches.
  void add(std::span<const ImagePoint> points, const fsw::Vector2& smear_px, double core_reach, double halo_reach,
           PhotonImage& image);

 private:
  /// Pixels x to before x + width, and y to before y + height.
  struct Box {
    int x = 0, y = 0, width = 0, height = 0;
  };

  std::span<const ImagePoint> within_reach(std::span<const ImagePoint> points, double margin, const Region& region);
  void gather(std::span<const ImagePoint> points, const fsw::Vector2& smear_px, const Box& box);
  void spread_core(const Box& from, const Box& canvas, double reach);
  void spread_halo(const Box& canvas, double reach);
  void add_canvas(const std::vector<float>& light, double fraction, const Box& canvas, PhotonImage& image) const;

  Settings settings_;
  int nodes_a_pixel_;
  double core_sigma_;  // less the widening by the grid
  double halo_variance_;
  // Work space.
  std::vector<ImagePoint> near_;
  std::vector<float> grid_, row_, phases_, canvas_, halo_, half_;
  std::size_t grid_width_ = 0, grid_height_ = 0;
};

}  // namespace vbar::twins::camera
