#pragma once
// What the truth of a run is made of: its time, gravity, forces, accuracy and data files.

#include <filesystem>
#include <string>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/forces/force_model.h"
#include "host_sim/truth/forces/surface_properties.h"

namespace vbar::truth {

struct TruthSettings {
  fsw::GpsTime epoch;        ///< start of the run
  fsw::GpsTime end;          ///< last instant that will be asked for: the data must reach it; before the epoch: unknown
  int gravity_degree = 60;   ///< 0 (point mass) to that of the gravity file
  int gravity_order = 60;    ///< 0 to the degree
  ForceModel forces;         ///< beside gravity
  double tolerance = 1e-12;  ///< local error a step, in units of the orbit's size: kSmallestTolerance to
                             ///< kLargestTolerance
  int threads = 1;           ///< at most so many spacecraft are propagated at a time; does not change a bit

  // Data files: absolute, or from the data folder. Space weather is read only if a force needs it.
  std::filesystem::path data_directory;
  std::filesystem::path gravity_file = "gravity/ggm05s_120.txt";
  std::filesystem::path earth_orientation_file = "earth/eop_2009_2013.csv";
  std::filesystem::path space_weather_file = "earth/space_weather_2009_2013.csv";

  /// Below it rounding, which a step cannot beat, would decide about the step size.
  static constexpr double kSmallestTolerance = 1e-14;
  /// Above it a day's error is that of an orbit's size: the steps no longer resolve the forces.
  static constexpr double kLargestTolerance = 1e-6;
};

/// A spacecraft as the truth takes it.
struct SpacecraftSettings {
  std::string name;
  fsw::orbit::CartesianState osculating;  ///< position and velocity in GCRF
  SurfaceProperties surface;              ///< only forces on the surface look at it
};

}  // namespace vbar::truth
