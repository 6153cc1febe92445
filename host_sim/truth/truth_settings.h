#pragma once
// Settings of the truth model of a run: time, gravity, forces, accuracy and data files.

#include <filesystem>
#include <string>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/forces/force_model.h"

namespace vbar::truth {

struct TruthSettings {
  fsw::GpsTime epoch;       ///< start of the run
  fsw::GpsTime end;         ///< last instant that will be asked for: the data must reach it; before the epoch: unknown
  int gravity_degree = 60;  ///< 0 (point mass) to that of the gravity file
  int gravity_order = 60;   ///< 0 to the degree
  bool permanent_tide = true;  ///< a tide-free gravity model gets the permanent deformation of the Earth
  ForceModel forces;           ///< beside gravity
  double tolerance = 1e-12;    ///< local error a step, in units of the orbit's size: kSmallestTolerance to
                               ///< kLargestTolerance
  int threads = 1;             ///< maximum number of spacecraft propagated concurrently; same bits for any

  // Data files: absolute, or from the data folder. Space weather is read only if a force needs it. A file that is named
  // must hold the data of the run; what the data folder holds ("bundled") is used where it does, else nothing.
  std::filesystem::path data_directory;
  std::filesystem::path gravity_file = "gravity/ggm05s_120.txt";
  std::filesystem::path earth_orientation_file = kBundled;  ///< or kNone
  std::filesystem::path space_weather_file = kBundled;      ///< or kConstant
  double constant_f107 = 150.0;                             ///< flux of kConstant, 1e-22 W/m^2/Hz
  double constant_ap = 15.0;
  bool accept_predictions = true;  ///< accepts predicted Earth orientation and space weather in published files

  static constexpr const char* kBundled = "bundled";
  static constexpr const char* kNone = "none";
  static constexpr const char* kConstant = "constant";

  /// Smallest tolerance: below it rounding would determine the step size.
  static constexpr double kSmallestTolerance = 1e-14;
  /// Largest tolerance: above it the error of a day reaches the size of the orbit: the steps no longer resolve the
  /// forces.
  static constexpr double kLargestTolerance = 1e-6;
};

/// Initial state and properties of a spacecraft.
struct SpacecraftSettings {
  std::string name;
  fsw::orbit::CartesianState osculating;  ///< position and velocity in GCRF
  SurfaceProperties surface;              ///< used by forces on the surface only
  bool burns_last = false;                ///< its burns have a duration (thrust_force.h)
};

}  // namespace vbar::truth
