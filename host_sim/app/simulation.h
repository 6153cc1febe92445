#pragma once
// One run of a mission: truth, sensors, links, flight computer and actuators around one queue of events.
//
// At one instant things happen in this order: measurements are taken, packets arrive, a waypoint is judged, the flight
// software steps, burns are executed. So a burn at a waypoint's own time counts as after it, and a step sees what was
// measured at its own time if the link is fast enough.

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "host_sim/app/flight_recorder.h"
#include "host_sim/app/line_usage.h"
#include "host_sim/engine/clock.h"
#include "host_sim/engine/event_queue.h"
#include "host_sim/engine/link_model.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/truth_model.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

/// Sees every packet of a run as it crosses the border of the flight computer.
class PacketObserver {
 public:
  PacketObserver() = default;
  PacketObserver(const PacketObserver&) = delete;
  PacketObserver& operator=(const PacketObserver&) = delete;
  virtual ~PacketObserver() = default;
  /// All packets of a step, the tick last, and the answer to them.
  virtual void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
                       std::span<const pil::Packet> outputs) = 0;
  /// From what packets that are yet to come can be made again (twins::Measurement::recipe).
  virtual void on_recipe(fsw::GpsTime /*time*/, std::span<const std::uint8_t> /*recipe*/) {}
};

class Simulation {
 public:
  /// All references must outlive the simulation. `progress` is told the simulated span after each step;
  /// `stop_requested` is asked before each (both may be empty).
  struct Surroundings {
    pil::FlightComputer& flight_computer;
    engine::WallClock& wall;
    std::span<PacketObserver* const> observers;
    std::function<void(fsw::Duration)> progress;
    std::function<bool()> stop_requested;
  };

  Simulation(const mission::Mission& mission, const std::filesystem::path& data_directory,
             const Surroundings& surroundings, report::RunRecord& record);

  /// Flies the mission. True if it came to its end, false if it was stopped. Throws what truth, twins and flight
  /// computer throw; the record then holds what was flown.
  bool run();

 private:
  struct TakeMeasurement {
    std::size_t sensor;
  };
  /// What a sensor has been making since it measured.
  struct CollectPending {
    std::shared_ptr<std::future<std::vector<twins::Packet>>> packets;
    bool bypasses_link;
  };
  struct DeliverPacket {
    pil::Packet packet;
  };
  struct JudgeWaypoint {
    std::size_t index;
  };
  struct StepFlight {};
  struct ExecuteBurn {
    maneuver_command command;
  };
  /// One that the mission file prescribes.
  struct ExecutePrescribedBurn {
    std::size_t index;
  };
  using Event = std::variant<TakeMeasurement, CollectPending, DeliverPacket, JudgeWaypoint, StepFlight, ExecuteBurn,
                             ExecutePrescribedBurn>;

  void handle(const TakeMeasurement& taken);
  void handle(const CollectPending& collected);
  void handle(const DeliverPacket&);
  void handle(const JudgeWaypoint&);
  void handle(const StepFlight&);
  void handle(const ExecuteBurn&);
  void handle(const ExecutePrescribedBurn& prescribed);

  void schedule(fsw::GpsTime time, Event event);
  void schedule_the_known();
  void schedule_measurement(std::size_t sensor, fsw::GpsTime from);
  twins::Measurement measure_now(twins::PacketSource& sensor);
  [[nodiscard]] twins::TruthSnapshot snapshot();
  void execute(const maneuver_command& command);
  [[nodiscard]] std::vector<NamedAttitude> all_attitudes() const;
  void pass_on(std::vector<twins::Packet> packets, fsw::GpsTime available, bool bypasses_link);
  void send_to_flight(pil::Packet packet, fsw::GpsTime sent);
  void report_execution(const twins::Execution& execution);
  void queue_telecommands();
  void take_commands(const pil::StepResult& answer);
  void point(const fsw::packets::PacketView& packet, fsw::GpsTime effective);
  [[nodiscard]] pil::Packet make_tick();
  [[nodiscard]] PairTruth pair_truth() const;
  void summarise(double wall_s, bool complete);

  const mission::Mission& mission_;
  const mission::Spacecraft& servicer_;
  Surroundings surroundings_;
  report::RunRecord& record_;
  std::filesystem::path data_directory_;
  FlightRecorder recorder_;
  truth::TruthModel truth_;
  std::size_t servicer_index_ = 0;
  std::size_t target_index_ = 0;
  std::vector<std::unique_ptr<twins::PacketSource>> sensors_;
  std::unique_ptr<twins::Actuator> thruster_;
  engine::LinkModel board_link_;
  truth::EarthRotation earth_rotation_;
  LineUsage line_;
  engine::RunClock clock_;
  engine::EventQueue<Event> events_;
  std::vector<pil::Packet> arrived_;  ///< for the next step
  std::uint32_t step_ = 0;
  std::uint16_t tick_sequence_ = 0;
  std::string cost_unit_ = "none";
  double flight_compute_s_ = 0.0;
  double link_s_ = 0.0;
};

}  // namespace vbar::app
