#pragma once
// Display map by measured dots: lens terms, then a polynomial field for the residuals of the lens terms.

#include <vector>

#include "hil_drivers/optical_stimulator/calibration/lens_fit.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "hil_drivers/optical_stimulator/optics/display_map.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::optical_stimulator::calibrate {

struct GeometryFit {
  DisplayMapParameters map;
  LensTerms lens_sigma;
  double field_sigma_px = 0.0;
  double left_out_rms_px = 0.0;  ///< an axis, of the third of the dots by which the degree was chosen
  int dots_used = 0;             ///< without outliers
};

/// Fits from `start`: size of the display, and lens terms near the solution. The degree of the field and the weight of
/// its smoothness are those that predict a third of the dots, left out and spread over the whole grid, best; the field
/// is then fitted to all dots. Throws std::runtime_error if the fit does not converge or the dots are too few.
[[nodiscard]] GeometryFit fit_geometry(const std::vector<Dot>& dots, const DisplayMapParameters& start);

/// Holds a dot that was not used in the fit.
struct Residual {
  fsw::Vector2 camera_px;
  fsw::Vector2 error_arcsec;  ///< where the map says that the camera sees it less where it does, along x and y
};
[[nodiscard]] std::vector<Residual> residuals_of(const DisplayMap& map, const std::vector<Dot>& dots);

/// Returns the figures of all residuals, or of those in a region of the camera.
[[nodiscard]] ResidualFigures figures_of(const std::vector<Residual>& residuals);
[[nodiscard]] std::vector<Residual> in_region(const std::vector<Residual>& residuals,
                                              const twins::camera::Region& region);

/// Returns the figures of the whole detector and of the region, with the field and without; the goals of procedure.h.
[[nodiscard]] HeldOutResiduals held_out_residuals(const DisplayMapParameters& map, const std::vector<Dot>& dots,
                                                  const twins::camera::Region& region);

}  // namespace vbar::optical_stimulator::calibrate
