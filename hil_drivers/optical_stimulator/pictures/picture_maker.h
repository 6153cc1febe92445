#pragma once
// From the photo-electrons that each pixel of the display shall cause in the camera to the picture that it shows.
//
// Points are found in the image itself: a maximum whose patch holds nearly all light about it. No list of points from
// the renderer is needed, an object that is a point at a distance is treated as one until it is not, and points that
// overlap are extended light, as they must be.
//
// A point's counts are matched (display_light.h). One that asks for more than a pixel can emit is drawn as an even
// square of its light, nine full pixels at most, about its centroid. Extended light is rounded with error diffusion in
// linear light (Floyd and Steinberg 1976) and clipped at the full count, which keeps its shape. What is not shown is
// counted.

#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/pictures/display_light.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::optical_stimulator {

// Dots of known place and light, for calibration and self check.

/// Draws a Gaussian dot of that total light and sigma about `centre` with matched counts, over what the picture shows
/// there. False, and nothing drawn, if its patch does not lie on the picture. At most a full pixel's light is put on a
/// pixel.
bool draw_dot(const DisplayLight& light, const fsw::Vector2& centre, double sigma_px, double electrons,
              Picture& picture);

struct PictureFigures {
  int points = 0;          ///< drawn with matched counts
  int clipped_points = 0;  ///< points of which not all light is shown
  double wanted_electrons = 0.0;
  double clipped_electrons = 0.0;  ///< wanted but not shown, as no pixel is brighter than full
};

class PictureMaker {
 public:
  explicit PictureMaker(const DisplayLight& light) : light_(light) {}

  /// Draws `wanted` (rows of a region of the display) into its region of `picture`, whose size must be the display's;
  /// pixels outside stay. A pure function of `wanted`. Throws std::invalid_argument for a region beyond the display.
  PictureFigures draw(const twins::camera::PhotonImage& wanted, Picture& picture);

 private:
  struct Point {
    int x = 0, y = 0;
    double electrons = 0.0;  // light of the patch
  };

  [[nodiscard]] double wanted_at(int x, int y) const;
  void find_points();
  [[nodiscard]] bool is_maximum(int x, int y) const;
  [[nodiscard]] bool is_compact(Point& point) const;
  void draw_point(const Point& point, Picture& picture, PictureFigures& figures);
  [[nodiscard]] Patch<double> square_about(const Point& point, const Patch<double>& wanted, double electrons) const;
  void draw_extended(Picture& picture, PictureFigures& figures);

  const DisplayLight& light_;
  const twins::camera::PhotonImage* wanted_ = nullptr;
  std::vector<Point> points_;  // work space, as all below
  std::vector<char> is_drawn_;
  std::vector<float> errors_, next_errors_;
};

}  // namespace vbar::optical_stimulator
