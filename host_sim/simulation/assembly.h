#pragma once
// The life of a run's sources: started before it, stopped after it, however it ends.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/faults/fault_schedule.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/io/serial_line.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/sensors/testbed.h"
#include "host_sim/simulation/run_truth.h"
#include "host_sim/simulation/simulation.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::app {

class StartedSources {
 public:
  /// Starts none yet. `sources` must outlive this.
  explicit StartedSources(std::span<const Source> sources) : sources_(sources) {}
  /// Stops what is still started.
  ~StartedSources() { stop(twins::StopReason::kInterrupted); }
  StartedSources(const StartedSources&) = delete;
  StartedSources& operator=(const StartedSources&) = delete;

  /// Starts those that are not, in order. If one refuses, all that were started, that one included, are stopped, and
  /// std::runtime_error says which and why.
  void start(fsw::GpsTime first_epoch);

  /// Stops those that were started, the last first, even if one of them throws: its name and reason are returned, empty
  /// if all went well.
  std::string stop(twins::StopReason reason);

 private:
  std::span<const Source> sources_;
  std::size_t started_ = 0;  ///< from the first
};

// Makes the twin of the thruster of a mission file.

/// `spacecraft` must have a thruster.
std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft);

// Telecommands that bring a flight under way from one version of its mission to another.

/// Returns the telecommands of `wanted` whose content is not among `sent`, dated `time`. Throws std::runtime_error for
/// one that sets up the flight software before its first step (all but guidance, waypoints, safety and mode), and for
/// one that was sent and cannot be revoked.
[[nodiscard]] std::vector<twins::Packet> changed_telecommands(const std::vector<twins::Packet>& sent,
                                                              const std::vector<twins::Packet>& wanted,
                                                              fsw::GpsTime time);

// Composition root: makes truth, sources and thruster of a mission, and flies them with a flight computer.

class AssembledMission {
 public:
  /// Environment of a run.
  struct Surroundings {
    pil::FlightComputer& flight_computer;
    engine::WallClock& wall;
    std::span<RunObserver* const> observers;
    std::function<void(fsw::Duration)> progress;  ///< as in World
    std::function<bool()> stop_requested;         ///< as in World
    std::filesystem::path folder = {};            ///< run folder, for files of testbeds; empty: none are kept
  };

  /// `mission` must outlive it. Throws what truth, orbits, attitudes, twins and their data throw, and
  /// std::runtime_error for a mission that cannot be flown.
  AssembledMission(const mission::Mission& mission, const std::filesystem::path& data_directory,
                   const sensors::MakeSources& make_sources = sensors::make_sources);
  AssembledMission(const AssembledMission&) = delete;
  AssembledMission& operator=(const AssembledMission&) = delete;

  /// Before fly(): until `time` it is flown as `before`, another version of the mission, and the telecommands that
  /// differ are sent to the flight software then. Throws std::runtime_error for one that cannot be given in flight.
  void branch_from(const mission::Mission& before, fsw::GpsTime time);

  /// Makes the truth and the sources ready, before there is a run folder. Throws as StartedSources::start.
  void start();

  /// Flies and fills the record, then stops the sources, however the run ended. Throws as Simulation::run; the record
  /// then holds what was flown. Starts the sources unless start() was called. To be called once.
  bool fly(const Surroundings& surroundings, report::RunRecord& record);

  /// Returns the receiver that is to be connected to the flight computer, of a source that was started.
  [[nodiscard]] std::optional<io::WiredReceiver> wired_receiver() const;

  /// Returns why the line to the flight computer is too slow for the first step; empty if it is fast enough.
  [[nodiscard]] std::string slow_line() const;

  [[nodiscard]] const RunFacts& facts() const { return facts_; }
  /// Returns notes on data that are missing, predicted or used in part.
  [[nodiscard]] std::vector<std::string> data_notes() const;
  [[nodiscard]] std::span<const Source> sources() const { return made_.sources; }

 private:
  [[nodiscard]] twins::TrueWorld& truth();
  [[nodiscard]] twins::TruthOutlook& outlook();

  const mission::Mission& mission_;
  const mission::Spacecraft& servicer_;
  std::filesystem::path data_directory_;
  std::shared_ptr<faults::FaultSchedule> faults_;
  RunTruth model_;                                      ///< stays at the start if the truth is a testbed's
  std::unique_ptr<testbeds::TestbedTruth> of_testbed_;  ///< null: the truth is the model
  sensors::MadeSources made_;
  std::unique_ptr<twins::Actuator> thruster_;
  engine::LinkModel board_link_;
  Timetable timetable_;
  std::vector<twins::Packet> telecommands_;  ///< telecommands that a flight computer needs when it starts
  RunFacts facts_;
  StartedSources started_{made_.sources};  // last: it stops the sources
};

}  // namespace vbar::app
