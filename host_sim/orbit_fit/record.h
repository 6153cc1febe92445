#pragma once
// What a fit leaves: a table for people, and a folder with the residuals, a page and the mission of the fitted orbit.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/orbit_fit/arc.h"
#include "host_sim/orbit_fit/batch.h"
#include "host_sim/orbit_fit/burn_search.h"

namespace vbar::orbit_fit {

/// Distances between prediction and file over one day behind the arc.
struct PredictedDay {
  int day = 0;  ///< from 1
  double rms_m = 0.0, largest_m = 0.0;
  fsw::Vector3 rms_rtn = fsw::Vector3::Zero();
};

struct FitRecord {
  std::string mission;     ///< whose forces act
  std::string spacecraft;  ///< its name in the mission
  std::string file;        ///< of the positions
  Arc positions;           ///< of the arc and behind it
  double arc_s = 0.0;      ///< length of the arc
  FittedOrbit fitted;
  std::optional<Break> found_break;         ///< what impulses would explain beside the burns of the fit
  std::vector<fsw::Vector3> residuals_rtn;  ///< at all positions
  bool ocean_tides = false;
};

/// Returns the days behind the arc that have positions.
[[nodiscard]] std::vector<PredictedDay> predicted_days(const FitRecord& record);

/// Returns the fit in lines for people: residuals, estimates, burns, break and prediction.
[[nodiscard]] std::string fit_table(const FitRecord& record);

/// Returns a mission of the forces of the fit and the fitted spacecraft at the begin of the arc, which vbar propagate
/// and vbar run read; its areas are multiplied by the estimated scales. What it cannot hold (burns, empirical
/// accelerations, ocean tides, further drag scales) is stated in comments. Throws std::domain_error for a scale below 0
/// and for an equatorial orbit.
[[nodiscard]] std::string fitted_mission(const FitRecord& record, const FittedDynamics& dynamics);

/// Writes residuals.csv, fit.html and <spacecraft>.toml. Returns the reason why there is no mission, if so; empty
/// otherwise. Throws std::runtime_error that names a file that cannot be written.
[[nodiscard]] std::string write_fit(const std::filesystem::path& folder, const FitRecord& record,
                                    const FittedDynamics& dynamics);

}  // namespace vbar::orbit_fit
