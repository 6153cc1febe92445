#pragma once
// Propagation of the truth of a mission: from start to end without flight software, sensors or burns.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/report/propagation_record.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::app {

class Propagation {
 public:
  /// PropagationRecord::incomplete_reason of one that was stopped.
  static constexpr const char* kInterruption = "interrupted";

  /// Told each row, in order of time and, at one time, of the mission's spacecraft.
  using RowSink = std::function<void(std::size_t spacecraft, const report::EphemerisRow& row)>;

  /// Loads the data and puts the spacecraft on their orbits. `mission` must outlive it. Throws what TruthModel and
  /// place_spacecraft throw.
  Propagation(const mission::Mission& mission, const std::filesystem::path& data_directory);

  /// Every `step` of the mission from its start, and its end.
  [[nodiscard]] std::vector<fsw::GpsTime> sampling_times() const;
  [[nodiscard]] std::vector<std::string> names() const;

  /// Flies. A spacecraft that re-enters, and whatever else stops the truth, makes the record incomplete, as does
  /// `stop_requested`, asked at each sampling time. `progress` receives the simulated span.
  report::PropagationRecord run(const RowSink& sink, const std::function<void(fsw::Duration)>& progress,
                                const std::function<bool()>& stop_requested);

 private:
  class DecayMeter;

  [[nodiscard]] fsw::Vector3 drag_eci(std::size_t truth_index);
  void sample(std::vector<DecayMeter>& decay, const RowSink& sink, report::PropagationRecord& record);

  const mission::Mission& mission_;
  truth::TruthModel truth_;
  truth::EarthRotation earth_rotation_;
  std::vector<std::size_t> truth_index_;  ///< index in the truth of each spacecraft of the mission
};

}  // namespace vbar::app
