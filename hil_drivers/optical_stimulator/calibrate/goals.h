#pragma once
// Goals of a calibration, on dots that the fit did not use.

namespace vbar::optical_stimulator::calibrate {

inline constexpr double kRegionMeanGoal_arcsec = 1.5, kRegionP95Goal_arcsec = 3.0;
inline constexpr double kDetectorMeanGoal_arcsec = 2.5, kDetectorP95Goal_arcsec = 5.0;

inline constexpr double kArcsecPerRad = 206264.80624709636;

}  // namespace vbar::optical_stimulator::calibrate
