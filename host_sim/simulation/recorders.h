#pragma once
// Recorders of the packets of a run: the log, the hashes and, if the mission asks for them, the LCM bus and
// datagrams to a ground system.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "host_sim/faults/run_observer.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/twins/packet_log.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

class PacketRecorders {
 public:
  /// Starts packets.lcmlog in `folder` and the LCM mirror and the datagrams, each if the mission asks for it. `check`
  /// is that of the log. Throws std::runtime_error.
  PacketRecorders(const mission::Mission& mission, const std::filesystem::path& folder, twins::EventCheck check = {});
  ~PacketRecorders();
  PacketRecorders(const PacketRecorders&) = delete;
  PacketRecorders& operator=(const PacketRecorders&) = delete;

  [[nodiscard]] std::span<RunObserver* const> observers() const { return observers_; }

  /// Writes everything to the files at the end of the run. Throws std::runtime_error that names a file that cannot be
  /// written.
  void finish();

  /// Returns the SHA-256 of the maneuver commands, and that of all telemetry, so far.
  [[nodiscard]] std::string commands_sha256() const;
  [[nodiscard]] std::string telemetry_sha256() const;

 private:
  class Log;
  class Hash;
  class Mirror;
  class Datagrams;
  std::unique_ptr<Log> log_;
  std::unique_ptr<Hash> hash_;
  std::unique_ptr<Mirror> mirror_;
  std::unique_ptr<Datagrams> datagrams_;
  std::vector<RunObserver*> observers_;
};

// Turns what happens in a run into the rows of its record: truth, telemetry, maneuvers, waypoints
// met.

/// True states of the pair that flies.
struct PairTruth {
  fsw::orbit::CartesianState servicer;
  fsw::orbit::CartesianState target;
};

/// True attitude of a spacecraft that has one.
struct NamedAttitude {
  std::string spacecraft;
  truth::AttitudeState attitude;
};

class FlightRecorder {
 public:
  FlightRecorder(const mission::Mission& mission, report::RunRecord& record) : mission_(mission), record_(record) {}

  /// Truth at the time of a flight step.
  void on_truth(fsw::GpsTime time, const PairTruth& truth);

  /// Attitudes at the time of a flight step.
  void on_attitudes(fsw::GpsTime time, const std::vector<NamedAttitude>& attitudes);

  /// Truth at the time of a waypoint, before any burn of that instant.
  void on_waypoint(const mission::Waypoint& waypoint, const PairTruth& truth);

  /// The flight software's answer to a step: its telemetry becomes a row, its commands maneuvers yet to be executed.
  void on_answer(fsw::GpsTime time, const pil::StepResult& answer);

  /// A burn of the mission file is about to happen.
  void on_prescribed(fsw::GpsTime time, const maneuver_command& command);

  /// Records the execution of a command.
  void on_execution(fsw::GpsTime time, const executed_maneuver& executed);

 private:
  [[nodiscard]] double mission_seconds(fsw::GpsTime time) const { return fsw::seconds(time - mission_.epoch); }
  void on_any_telemetry(double step_time_s, const fsw::packets::PacketView& packet);
  void on_telemetry(report::EstimateRow& row, const fsw::packets::PacketView& packet);
  void count_output(const pil::StepResult& answer);
  void on_command(fsw::GpsTime step_time, const fsw::packets::PacketView& packet);
  void add_maneuver(fsw::GpsTime command_time, fsw::GpsTime burn_time, const maneuver_command& command);

  const mission::Mission& mission_;
  report::RunRecord& record_;
};

}  // namespace vbar::app
