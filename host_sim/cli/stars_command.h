#pragma once
// vbar stars: attitude of a camera by its images of stars, and its lens.

#include <filesystem>
#include <string>
#include <vector>

namespace vbar::app {

struct StarsOptions {
  std::vector<std::filesystem::path> images;
  double focal_length_px = 0.0;
  double search_percent = 0.0;             ///< focal lengths about the given one that are tried
  std::vector<double> principal_point_px;  ///< x, y; empty: middle of the image
  std::vector<double> distortion;          ///< k1, k2, p1, p2, k3; empty: none
  double centroid_floor_px = 0.3;
  double detection_sigmas = 5.0;
  std::string utc;              ///< of the images, for aberration; empty: left out
  bool calibrate = false;       ///< the lens is fitted to the stars of all images
  std::filesystem::path table;  ///< CSV of the stars; empty: none
};

/// kFailed if an image is not identified.
int stars_command(const StarsOptions& options);

}  // namespace vbar::app
