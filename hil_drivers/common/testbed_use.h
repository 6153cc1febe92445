#pragma once
// The part of a run in which a testbed with a camera is needed, and what follows its failure.

#include <optional>
#include <string>

#include "fsw/core/gps_time.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/report/summary.h"

namespace vbar::testbeds {

/// What follows the failure of a testbed during a run.
enum class OnFailure {
  kStop,  ///< the run ends with one sentence
  kTwin,  ///< the digital twin takes over from the measurement that failed on, until the end of the run
};

/// Reads the key `on_failure` of a testbed, "stop" by default. Throws MissionError.
[[nodiscard]] OnFailure read_on_failure(const mission::TableReader& section);

/// A testbed without a measurement for this long is parked.
inline constexpr fsw::Duration kParkedFor = fsw::duration_of_seconds(3600);

/// Returns whether the camera of that name ("servicer/camera") takes no image within kParkedFor after `time`. Throws
/// std::logic_error for a camera that the mission does not have.
[[nodiscard]] bool is_idle_after(const mission::Mission& mission, const std::string& camera, fsw::GpsTime time);

/// Times at which a run used a testbed, in hours of the mission.
struct TestbedUse {
  std::optional<double> started_h;      ///< for the first image after it was parked; empty: with the run
  std::optional<double> parked_h;       ///< after the last image
  std::optional<double> handed_over_h;  ///< to the digital twin
  double start_wall_s = 0.0;            ///< of the last start, with its checks
  std::string failure;                  ///< reason of the hand-over

  void add_to(report::TestbedFigures& figures) const;
};

}  // namespace vbar::testbeds
