#pragma once
// The truth model of a mission, its spacecraft in place, as the world of a run.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/report/propagation_folder.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/truth_model.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::app {

class RunTruth final : public twins::TrueWorld, public twins::TruthOutlook {
 public:
  /// Starts at the mission's start; `servicer` is the spacecraft that flies. Throws what truth, orbits and attitudes
  /// throw.
  RunTruth(const mission::Mission& mission, const mission::Spacecraft& servicer,
           const std::filesystem::path& data_directory);

  void advance_to(fsw::GpsTime time) override { truth_.advance_to(time); }
  [[nodiscard]] twins::TruthSnapshot snapshot(twins::TruthDetail detail) override;
  void apply_impulse_rtn(const fsw::Vector3& dv_rtn) override { truth_.apply_impulse_rtn(servicer_, dv_rtn); }
  void begin_burn(const truth::ThrustArc& arc) override { truth_.begin_burn(servicer_, arc); }
  void point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn, const fsw::Vector3& boresight_rate_rtn) override;
  [[nodiscard]] double wall_s() const override { return truth_.statistics().wall_s; }

  /// Returns the truth within the last integration step; where that ends before `time`, perturbations are constant from
  /// there on (a micrometre in a second), and an attitude continues with its angular acceleration.
  [[nodiscard]] twins::TruthSnapshot at(fsw::GpsTime time) override;

  [[nodiscard]] const truth::TruthModel& model() const { return truth_; }

 private:
  [[nodiscard]] double mission_seconds(fsw::GpsTime time) const { return fsw::seconds(time - epoch_); }
  void add_accelerations(std::size_t index, twins::SpacecraftTruth& one) const;

  fsw::GpsTime epoch_;
  truth::TruthModel truth_;
  truth::EarthRotation earth_rotation_;
  std::size_t servicer_ = 0;
  bool is_pointed_ = false;  ///< the servicer's attitude is commanded
  std::vector<std::string> names_;
  std::vector<std::size_t> indices_;  ///< index in the truth of each name
};

// Propagation of the truth of a mission: from start to end without flight software, sensors or burns.

class Propagation {
 public:
  /// PropagationRecord::incomplete_reason of one that was stopped.
  static constexpr const char* kInterruption = "interrupted";

  /// Receives each row: those of one spacecraft in order of time, those of different ones from several threads at once.
  using RowSink = std::function<void(std::size_t spacecraft, const report::EphemerisRow& row)>;

  /// Loads the data and puts the spacecraft on their orbits. `mission` must outlive it. Throws what TruthModel and
  /// place_spacecraft throw.
  Propagation(const mission::Mission& mission, const std::filesystem::path& data_directory);

  /// Every `step` of the mission from its start, and its end.
  [[nodiscard]] std::vector<fsw::GpsTime> sampling_times() const;
  [[nodiscard]] std::vector<std::string> names() const;

  /// Flies. A spacecraft that re-enters, and whatever else stops the truth, makes the record incomplete, as does
  /// `stop_requested`, asked after each tenth of a second of work or so. `progress` receives the simulated span.
  report::PropagationRecord run(const RowSink& sink, const std::function<void(fsw::Duration)>& progress,
                                const std::function<bool()>& stop_requested);

 private:
  class DecayMeter;

  /// A sampling time and the Earth's orientation then.
  struct Sampling {
    fsw::GpsTime time;
    double time_s = 0.0;  ///< since the mission's epoch
    fsw::Matrix3 R_itrf_gcrf;
  };

  [[nodiscard]] std::size_t samplings_at_once() const;
  [[nodiscard]] fsw::Vector3 drag_eci(std::size_t truth_index);
  [[nodiscard]] report::EphemerisRow row_at(const Sampling& sampling, std::size_t truth_index) const;
  void fly_through(std::span<const fsw::GpsTime> times, std::vector<DecayMeter>& decay, const RowSink& sink,
                   report::PropagationRecord& record);

  const mission::Mission& mission_;
  truth::TruthModel truth_;
  truth::EarthRotation earth_rotation_;
  std::vector<std::size_t> truth_index_;    ///< index in the truth of each spacecraft of the mission
  std::vector<std::size_t> mission_place_;  ///< place in the mission of each spacecraft of the truth
  std::vector<double> sampling_s_;          ///< time spent on the rows of each spacecraft of the mission, drag included
};

}  // namespace vbar::app
