#pragma once
// One run: a true world, sources, links, a flight computer and actuators around one queue of events. All of them come
// from outside (assembly.h makes them from a mission); nothing here depends on the kind of a source.
//
// At one instant things happen in this order: measurements are taken, packets arrive, a waypoint is judged, the flight
// software steps, burns are executed. So a burn at a waypoint's own time counts as after it, and a step sees what was
// measured at its own time if the link is fast enough.

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host_sim/engine/clock.h"
#include "host_sim/engine/event_queue.h"
#include "host_sim/engine/link_model.h"
#include "host_sim/faults/run_observer.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/packet_encoder.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

using Source = twins::NamedSource;

/// Times of the events of a run.
struct Timetable {
  struct Burn {
    fsw::GpsTime time;
    fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
    std::int32_t id = 0;  ///< its number in reports: one that the flight software never gives
  };
  fsw::GpsTime start;  ///< first flight step
  fsw::GpsTime end;
  engine::Cadence step{fsw::GpsTime{}, fsw::duration_of_seconds(60)};  ///< after the first
  fsw::Duration compute_latency;  ///< from a step to the moment its outputs take effect
  std::uint8_t spacecraft = 0;    ///< as in packet headers
  engine::ClockSettings clock;
  std::vector<fsw::GpsTime> waypoints;
  std::vector<Burn> burns;                   ///< that the flight software did not ask for
  std::vector<twins::Packet> first_packets;  ///< telecommands that the first step brings
  /// Telecommands that arrive later, at the first step from then on.
  struct Uplink {
    fsw::GpsTime time;
    std::vector<twins::Packet> packets;
  };
  std::optional<Uplink> uplink;
};

/// Participants of a run. All references must outlive it.
struct World {
  twins::TrueWorld& truth;
  std::span<const Source> sources;
  twins::Actuator& thruster;
  pil::FlightComputer& flight_computer;
  engine::LinkModel& board_link;  ///< between sources or actuators and the flight computer
  engine::WallClock& wall;
  std::span<RunObserver* const> observers;
  std::function<void(fsw::Duration)> progress = {};  ///< gets the simulated span after each step; may be empty
  std::function<bool()> stop_requested = {};         ///< asked often; may be empty
  /// Uncommanded burns whose times, the present or later, have become known; asked at the start and after
  /// each event. May be empty.
  std::function<std::vector<Timetable::Burn>()> more_burns = {};
};

/// Facts about a run that has ended.
struct RunFacts {
  struct OfSource {
    std::string name;
    std::int64_t epochs = 0;
    std::int64_t failures = 0;
    std::string last_failure;
    engine::Lateness late;  ///< measurements started late; real time only
  };
  bool complete = false;  ///< it came to its end
  fsw::Duration simulated;
  // Wall-clock time, s; the shares are parts of `wall_s`.
  double wall_s = 0.0, truth_s = 0.0, flight_s = 0.0, link_s = 0.0, sources_s = 0.0;
  std::string cost_unit = "none";  ///< unit of pil::StepReport::count
  engine::DeadlineReport deadlines;
  std::vector<OfSource> sources;
};

class Simulation {
 public:
  Simulation(const World& world, const Timetable& timetable);

  /// Flies. True if it came to its end, false if it was stopped. Throws what the world throws, std::runtime_error for a
  /// source that does not answer within its time limit and std::logic_error for one that delivers before it measured,
  /// each naming the source.
  bool run();

  /// Returns the facts after run(), however it ended.
  [[nodiscard]] const RunFacts& facts() const { return facts_; }

 private:
  // Priorities: the order of what happens at one instant.
  struct TakeMeasurement {
    static constexpr std::int32_t kPriority = 0;
    std::size_t source;
  };
  /// Packets that a source has been making since it measured.
  struct CollectPending {
    static constexpr std::int32_t kPriority = 5;
    std::size_t source;
    fsw::GpsTime epoch;
    std::shared_ptr<std::future<twins::Completion>> completion;
    bool bypasses_link;
  };
  struct DeliverPacket {
    static constexpr std::int32_t kPriority = 10;
    twins::Packet packet;
  };
  struct JudgeWaypoint {
    static constexpr std::int32_t kPriority = 20;
    std::size_t index;
  };
  struct StepFlight {
    static constexpr std::int32_t kPriority = 30;
  };
  struct ExecuteBurn {
    static constexpr std::int32_t kPriority = 40;
    maneuver_command command;
    fsw::GpsTime time;  ///< tag of the command
  };
  struct ReportBurn {
    static constexpr std::int32_t kPriority = 40;
    twins::Execution execution;
  };
  struct ExecutePrescribedBurn {
    static constexpr std::int32_t kPriority = 40;
    std::size_t index;
  };
  using Event = std::variant<TakeMeasurement, CollectPending, DeliverPacket, JudgeWaypoint, StepFlight, ExecuteBurn,
                             ExecutePrescribedBurn, ReportBurn>;

  void handle(const TakeMeasurement& taken);
  void handle(const CollectPending& collected);
  void handle(const DeliverPacket& delivery);
  void handle(const JudgeWaypoint& judged);
  void handle(const StepFlight&);
  void handle(const ExecuteBurn& burn);
  void handle(const ExecutePrescribedBurn& prescribed);
  void handle(const ReportBurn& ended);

  template <class E>
  void schedule(fsw::GpsTime time, E event);
  void schedule_timetable();
  void schedule_more_burns();
  void schedule_prescribed(std::size_t index);
  void schedule_measurement(std::size_t source, fsw::GpsTime from);
  bool wait_until_due(const Event& event);
  void fly();
  [[nodiscard]] bool stop_requested() const { return world_.stop_requested && world_.stop_requested(); }
  [[nodiscard]] bool wait_for(const CollectPending& pending);
  void record(fsw::GpsTime time, const std::optional<twins::LoggedImage>& recording);
  void pass_on(std::vector<twins::Packet> packets, fsw::GpsTime available, bool bypasses_link);
  void send_to_flight(twins::Packet packet, fsw::GpsTime sent);
  void note(fsw::GpsTime time, std::string_view source, std::span<const twins::Note> notes);
  void fail(std::size_t source, fsw::GpsTime epoch, const std::string& reason);
  void take_commands(const pil::StepResult& answer);
  void point(const fsw::packets::PacketView& packet, fsw::GpsTime effective);
  void execute(const maneuver_command& command, fsw::GpsTime burn_time);
  [[nodiscard]] maneuver_command prescribed_command(std::size_t index) const;
  void report_execution(const twins::Execution& execution);
  [[nodiscard]] twins::Packet make_tick();
  [[nodiscard]] double mission_seconds(fsw::GpsTime time) const { return fsw::seconds(time - timetable_.start); }

  World world_;
  Timetable timetable_;
  engine::RunClock clock_;
  engine::EventQueue<Event> events_;
  twins::PacketEncoder ticks_;
  std::vector<twins::Packet> arrived_;  ///< for the next step
  std::uint32_t step_ = 0;
  bool interrupted_ = false;
  RunFacts facts_;
};

}  // namespace vbar::app
