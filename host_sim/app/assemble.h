#pragma once
// Composition root: makes truth, sources and thruster of a mission, and flies them with a flight computer.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hil_drivers/testbed.h"
#include "host_sim/app/flown_truth.h"
#include "host_sim/app/simulation.h"
#include "host_sim/app/started_sources.h"
#include "host_sim/faults/fault_schedule.h"
#include "host_sim/io/wired_receiver.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {

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
  FlownTruth model_;                                    ///< stays at the start if the truth is a testbed's
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
