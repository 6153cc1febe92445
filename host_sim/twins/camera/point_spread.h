#pragma once
// Point-spread function of the lens with the smear by camera rotation, integrated over every pixel. The image of a
// point is a Gaussian core and a wide Gaussian halo, drawn along a straight line during the exposure.

#include <array>
#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/extended_psf.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::twins::camera {

class PointSpread {
 public:
  explicit PointSpread(const OpticsSettings& optics);

  /// Adds a point that moves by `smear_px` in total during the exposure, at constant speed.
  void add(const ImagePoint& point, const fsw::Vector2& smear_px, PhotonImage& image);

  /// Adds many points that move alike and belong together: an object, a disc. They are first gathered on a grid, of a
  /// 64th of their extent or a third of the spread, whichever is less, by bilinear weights: sums and centroids stay
  /// exact, and nothing changes as an object grows from a point to many pixels. Beyond kWide_px the grid divides pixels
  /// evenly (extended_psf.h).
  void add(std::span<const ImagePoint> points, const fsw::Vector2& smear_px, PhotonImage& image);

  static constexpr double kWide_px = 96.0;

  /// Returns the distance in pixels from a point of given electrons at which its light is neglected: 0.05 electrons a
  /// pixel, 1e-4 of the light.
  [[nodiscard]] double reach_px(double electrons) const;

 private:
  struct Component {
    double fraction, sigma_px;
    double min_reach;  // sigmas
  };
  struct SmearNode {
    fsw::Vector2 offset;
    double weight;
  };
  /// Pixel integrals of a Gaussian along one axis.
  struct Profile {
    int first = 0;  // pixel
    std::vector<float> weights;
  };

  [[nodiscard]] static double reach_px(const Component& component, double electrons);
  void place_smear_nodes(const fsw::Vector2& smear_px, double sigma_px);
  static void fill(Profile& profile, double centre, double reach, double sigma_px, int begin, int end);
  bool add_wide(std::span<const ImagePoint> points, const fsw::Vector2& smear_px, PhotonImage& image);
  void add_component(const Component& component, std::span<const ImagePoint> points, const fsw::Vector2& smear_px,
                     PhotonImage& image);

  std::array<Component, 2> components_;
  ExtendedPsf wide_;
  std::vector<SmearNode> nodes_;  // work space, as all below
  Profile across_, down_;
  std::vector<float> grid_, row_sums_;
  std::vector<Profile> columns_;
  std::vector<ImagePoint> near_points_;
};

}  // namespace vbar::twins::camera
