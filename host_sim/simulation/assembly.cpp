#include "host_sim/simulation/assembly.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "fsw/packets/message_traits.h"
#include "fsw/packets/packet.h"
#include "host_sim/faults/fault_injection.h"
#include "host_sim/faults/fault_log.h"
#include "host_sim/faults/fault_schedule.h"
#include "host_sim/installation/expected_accelerations.h"
#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/report/summarise.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/initial_state.h"
#include "host_sim/simulation/recorders.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/finite_thruster.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::app {

void StartedSources::start(fsw::GpsTime first_epoch) {
  while (started_ < sources_.size()) {
    const Source& source = sources_[started_++];
    try {
      source.packets->start(first_epoch);
    } catch (const std::exception& error) {
      stop(twins::StopReason::kFailed);
      throw std::runtime_error(fmt::format("source {}: {}", source.name, error.what()));
    }
  }
}

std::string StartedSources::stop(twins::StopReason reason) {
  std::string trouble;
  for (std::size_t k = std::exchange(started_, 0); k-- > 0;) {
    try {
      sources_[k].packets->stop(reason);
    } catch (const std::exception& error) {
      if (!trouble.empty()) trouble += "; ";
      trouble += fmt::format("source {} could not be stopped: {}", sources_[k].name, error.what());
    }
  }
  return trouble;
}

std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft) {
  const mission::Thruster& thruster = *spacecraft.thruster;
  const engine::RandomStream stream(mission.seed, spacecraft.name + "/thruster");
  const twins::BurnErrors errors{thruster.magnitude_error, thruster.pointing_error_rad};
  if (!thruster.finite) {
    return std::make_unique<twins::IdealThruster>(
        twins::IdealThruster::Settings{.spacecraft_number = spacecraft.number, .errors = errors}, stream);
  }
  const twins::FiniteThruster::Settings settings{
      .spacecraft_number = spacecraft.number,
      .errors = errors,
      .thruster = *thruster.finite,
      .mass_kg = true_surface(mission, spacecraft).mass_kg,
      .nominal_mass_kg = spacecraft.surface.mass_kg,
  };
  return std::make_unique<twins::FiniteThruster>(settings, stream);
}

namespace {

using fsw::packets::Apid;
using fsw::packets::PacketView;

/// Telecommands that the flight software accepts in any step; the others initialise it.
constexpr std::array kInFlight{Apid::kGncConfiguration, Apid::kWaypointTable, Apid::kModeCommand,
                               Apid::kSafetyConfiguration};

/// Parses a telecommand of this program, which is whole.
PacketView view_of(const twins::Packet& packet) {
  return fsw::packets::parse_packet(packet).value();
}

bool is_for_same(const PacketView& a, const PacketView& b) {
  return a.header.apid == b.header.apid && a.header.unit == b.header.unit;
}

std::string name_of(const PacketView& view) {
  return fsw::packets::message_name(view.header.apid);
}

twins::Packet dated(const PacketView& view, fsw::GpsTime time) {
  fsw::packets::PacketHeader header = view.header;
  header.time = time;
  twins::Packet packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::write_packet(header, view.payload, packet).value());
  return packet;
}

}  // namespace

std::vector<twins::Packet> changed_telecommands(const std::vector<twins::Packet>& sent,
                                                const std::vector<twins::Packet>& wanted, fsw::GpsTime time) {
  const auto same_in = [](const std::vector<twins::Packet>& packets, const PacketView& view) {
    return std::ranges::find_if(packets, [&](const twins::Packet& one) { return is_for_same(view_of(one), view); });
  };
  for (const twins::Packet& packet : sent)
    if (const PacketView view = view_of(packet); same_in(wanted, view) == wanted.end())
      throw std::runtime_error("it takes back the telecommand " + name_of(view) + ", which was sent");
  std::vector<twins::Packet> changed;
  for (const twins::Packet& packet : wanted) {
    const PacketView view = view_of(packet);
    const auto before = same_in(sent, view);
    if (before != sent.end() && std::ranges::equal(view_of(*before).payload, view.payload)) continue;
    if (std::ranges::find(kInFlight, view.header.apid) == kInFlight.end())
      throw std::runtime_error("it changes the telecommand " + name_of(view) +
                               ", which is given before the first step");
    changed.push_back(dated(view, time));
  }
  return changed;
}

namespace {

/// The spacecraft that flies, with all it needs to.
const mission::Spacecraft& complete_servicer(const mission::Mission& mission) {
  const mission::Spacecraft& servicer = flying_spacecraft(mission);
  for (const mission::Spacecraft& other : mission.spacecraft) {
    if (&other != &servicer && other.flight_computer) {
      throw std::runtime_error("spacecraft \"" + other.name +
                               "\" has a flight computer too; one in a mission is supported");
    }
  }
  if (servicer.observes().empty())
    throw std::runtime_error("spacecraft \"" + servicer.name +
                             "\" has no sensor that observes another spacecraft; one is needed to navigate by");
  if (!servicer.thruster) throw std::runtime_error("spacecraft \"" + servicer.name + "\" has no thruster");
  return servicer;
}

PairTruth pair_in(const twins::TruthSnapshot& truth, const mission::Spacecraft& servicer) {
  return {truth.find(servicer.name)->orbit, truth.find(servicer.observes())->orbit};
}

std::vector<twins::Packet> telecommands_at_start(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                                 const std::filesystem::path& data_directory,
                                                 const truth::TruthModel& truth) {
  const auto state_at_start = [&](std::string_view spacecraft) {
    return truth.state(truth.index_of(std::string(spacecraft)));
  };
  mission::Mission covered =
      sensors::with_expected_accelerations(mission, servicer, truth.data(), state_at_start(servicer.name)).mission;
  sensors::limit_burns(servicer, covered.guidance.configuration);
  return sensors::telecommands_of({covered, servicer, data_directory, *truth.data().earth_orientation, state_at_start});
}

Timetable timetable_of(const mission::Mission& mission, const mission::Spacecraft& servicer,
                       const std::filesystem::path& data_directory, const truth::TruthModel& truth) {
  Timetable timetable;
  timetable.start = mission.start_time();
  timetable.end = mission.end_time();
  timetable.step = mission.step;
  timetable.compute_latency = servicer.flight_computer->compute_latency;
  timetable.spacecraft = servicer.number;
  timetable.clock = mission.clock;
  for (const mission::Waypoint& waypoint : mission.waypoints) timetable.waypoints.push_back(waypoint.time);
  // Numbers below zero are those of burns that the ground announces.
  for (const mission::PrescribedBurn& burn : mission.burns) {
    const auto id = -1 - static_cast<std::int32_t>(timetable.burns.size());
    timetable.burns.push_back({burn.time, burn.dv_rtn, id});
  }
  timetable.first_packets = telecommands_at_start(mission, servicer, data_directory, truth);
  return timetable;
}

/// The truth of a testbed, if the mission has it as its source; `model` stands at the start.
std::unique_ptr<testbeds::TestbedTruth> truth_of_testbed(const mission::Mission& mission,
                                                         const mission::Spacecraft& servicer,
                                                         const std::filesystem::path& data_directory, RunTruth& model) {
  if (mission.truth_source == mission::kTruthModel) return nullptr;
  const testbeds::TestbedKind* const kind = testbeds::find_testbed(mission.truth_source);
  const auto testbed = std::ranges::find(mission.testbeds, mission.truth_source, &mission::Testbed::name);
  if (kind == nullptr || kind->make_truth == nullptr || testbed == mission.testbeds.end())
    throw std::logic_error("the mission has no testbed \"" + mission.truth_source + "\" that supplies the truth");
  return kind->make_truth(*testbed->settings,
                          {mission, servicer, data_directory, model.snapshot(twins::TruthDetail::kAccelerations),
                           model.model().data().earth_orientation});
}

/// Enters the events of a run into its record.
class Recording final : public RunObserver {
 public:
  Recording(const mission::Mission& mission, const mission::Spacecraft& servicer, report::RunRecord& record)
      : mission_(mission),
        servicer_(servicer),
        recorder_(mission, record),
        evaluations_(sensors::make_evaluations(mission, servicer, record)),
        record_(record) {}

  void on_note(fsw::GpsTime time, std::string_view source, const twins::Note& note) override {
    const auto value = std::isnan(note.value) ? std::nullopt : std::optional<double>(note.value);
    add_note(time, source, note.name, value, note.text);
  }
  void on_failure(fsw::GpsTime time, std::string_view source, std::string_view reason) override {
    add_note(time, source, "failure", std::nullopt, reason);
  }
  void on_measured(std::string_view source, const twins::TruthSnapshot& truth) override {
    const auto found = std::ranges::find(evaluations_, source, &sensors::NamedEvaluation::source);
    if (found != evaluations_.end()) found->evaluation->on_measured(truth);
  }
  void on_waypoint(std::size_t waypoint, const twins::TruthSnapshot& truth) override {
    recorder_.on_waypoint(mission_.waypoints[waypoint], pair_in(truth, servicer_));
  }
  void on_truth(const twins::TruthSnapshot& truth) override {
    recorder_.on_truth(truth.time, pair_in(truth, servicer_));
    std::vector<NamedAttitude> attitudes;
    for (const twins::SpacecraftTruth& one : truth.spacecraft)
      if (one.attitude) attitudes.push_back({one.name, *one.attitude});
    recorder_.on_attitudes(truth.time, attitudes);
  }
  void on_step(std::uint32_t, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet>) override {
    for (const auto& [source, evaluation] : evaluations_) evaluation->on_inputs(time, inputs);
  }
  void on_answer(fsw::GpsTime time, const pil::StepResult& answer) override {
    recorder_.on_answer(time, answer);
    if (evaluations_.empty()) return;
    const std::vector<fsw::packets::PacketView> packets = parsed(answer.packets);
    for (const auto& [source, evaluation] : evaluations_) evaluation->on_answer(time, packets);
  }
  void on_prescribed(fsw::GpsTime time, const maneuver_command& command) override {
    recorder_.on_prescribed(time, command);
  }
  void on_execution(fsw::GpsTime time, const executed_maneuver& executed) override {
    recorder_.on_execution(time, executed);
  }
  void finish() {
    for (const auto& [source, evaluation] : evaluations_) evaluation->finish();
  }

 private:
  /// Returns the valid packets; invalid ones are in the log only.
  static std::vector<fsw::packets::PacketView> parsed(std::span<const pil::Packet> packets) {
    std::vector<fsw::packets::PacketView> views;
    for (const pil::Packet& bytes : packets)
      if (const auto packet = fsw::packets::parse_packet(bytes); packet.ok()) views.push_back(packet.value());
    return views;
  }
  void add_note(fsw::GpsTime time, std::string_view source, std::string_view name, std::optional<double> value,
                std::string_view text) {
    record_.notes.push_back(
        {fsw::seconds(time - mission_.epoch), std::string(source), std::string(name), value, std::string(text)});
  }

  const mission::Mission& mission_;
  const mission::Spacecraft& servicer_;
  FlightRecorder recorder_;
  std::vector<sensors::NamedEvaluation> evaluations_;
  report::RunRecord& record_;
};

/// Counts the bytes of the line to the flight computer.
class LineWatch final : public RunObserver {
 public:
  LineWatch(const mission::Mission& mission, const mission::Spacecraft& servicer, const pil::FlightComputer& computer)
      : computer_(computer), usage_(*servicer.flight_computer, mission.step.shortest_period(), computer.statistics()) {}
  void on_step(std::uint32_t, fsw::GpsTime, std::span<const pil::Packet>, std::span<const pil::Packet>) override {
    usage_.after_step(computer_.statistics());
  }
  void summarise(report::Summary::Link& summary) const {
    const pil::LinkStatistics link = computer_.statistics();
    summary = {link.bytes_sent + link.bytes_received, link.frames_resent, link.frames_rejected, link.frames_duplicated,
               link.strangers_ignored};
    summary.wired_bytes = link.wired.bytes;
    summary.wired_bytes_dropped = link.wired.dropped;
    summary.wired_bytes_missing = link.wired.missing;
    summary.wired_timeouts = link.wired.timeouts;
    usage_.summarise(summary);
  }

 private:
  const pil::FlightComputer& computer_;
  LineUsage usage_;
};

/// The clock of the run, or that of a testbed once its time has started.
class SelectedClock final : public engine::WallClock {
 public:
  explicit SelectedClock(engine::WallClock& of_run) : clock_(&of_run) {}
  void select(engine::WallClock& of_testbed) { clock_ = &of_testbed; }
  Span now() override { return clock_->now(); }
  Span start_of_run() override { return clock_->start_of_run(); }
  void sleep_until(Span wake) override { clock_->sleep_until(wake); }

 private:
  engine::WallClock* clock_;
};

void summarise_mission(const mission::Mission& mission, const mission::Spacecraft& servicer, report::Summary& summary) {
  summary.mission = mission.name;
  summary.seed = mission.seed;
  summary.target = servicer.observes();
  summary.flight_computer = mission::name_of(servicer.flight_computer->target);
  if (servicer.thruster && servicer.thruster->max_thrust_n > 0.0)
    summary.thrust =
        report::Thrust{.max_thrust_n = servicer.thruster->max_thrust_n, .mass_kg = servicer.surface.mass_kg};
  sensors::add_facts(mission, servicer, summary);
}

void summarise_run(const RunFacts& facts, std::span<const Source> sources, report::Summary& summary) {
  summary.complete = facts.complete;
  summary.simulated_s = fsw::seconds(facts.simulated);
  summary.wall_s = facts.wall_s;
  summary.speed_factor = facts.wall_s > 0.0 ? summary.simulated_s / facts.wall_s : 0.0;
  summary.deadlines = {facts.deadlines.step_late.count, facts.deadlines.woke_late.count,
                       facts.deadlines.link_late.count, facts.deadlines.simulation_late.count};
  report::Summary::WallShare& share = summary.wall_share;
  share.truth_s = facts.truth_s;
  share.flight_s = facts.flight_s;
  share.link_s = facts.link_s;
  share.other_s = std::max(0.0, facts.wall_s - facts.truth_s - facts.flight_s - facts.link_s);
  const std::size_t first = summary.sources.size();
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const RunFacts::OfSource& of = facts.sources[k];
    summary.sources.push_back({of.name, sources[k].kind, of.epochs, of.failures, of.last_failure, of.late.count,
                               std::chrono::duration<double>(of.late.worst).count(), 0});
  }
  for (std::size_t k = 0; k < sources.size(); ++k) {
    for (const twins::Note& spent : sources[k].packets->statistics()) {
      if (spent.name == twins::kPacketsRejected)
        summary.sources[first + k].packets_rejected = static_cast<std::uint64_t>(spent.value);
      if (spent.name == "render_s") share.render_s += spent.value;
      if (spent.name == "detector_s") share.detector_s += spent.value;
      if (spent.name == "packing_s") share.packing_s += spent.value;
    }
  }
}

/// Wraps the sources that have faults; the others are unchanged.
sensors::MadeSources with_faults(sensors::MadeSources made, const std::shared_ptr<faults::FaultSchedule>& schedule) {
  for (Source& source : made.sources) {
    const auto is_of_it = [&](const mission::Fault& fault) { return faults::is_of_source(fault, source.name); };
    if (std::ranges::any_of(schedule->faults(), is_of_it))
      source.packets = std::make_unique<faults::FaultySource>(std::move(source.packets), schedule, source.name);
  }
  return made;
}

std::unique_ptr<twins::Actuator> with_faults(std::unique_ptr<twins::Actuator> thruster,
                                             const std::shared_ptr<faults::FaultSchedule>& schedule) {
  if (schedule->faults().empty()) return thruster;
  return std::make_unique<faults::FaultyThruster>(std::move(thruster), schedule);
}

}  // namespace

AssembledMission::AssembledMission(const mission::Mission& mission, const std::filesystem::path& data_directory,
                                   const sensors::MakeSources& make_sources)
    : mission_(mission),
      servicer_(complete_servicer(mission)),
      data_directory_(data_directory),
      faults_(std::make_shared<faults::FaultSchedule>(mission.faults, servicer_.name, servicer_.observes())),
      model_(mission, servicer_, data_directory),
      of_testbed_(truth_of_testbed(mission, servicer_, data_directory, model_)),
      made_(with_faults(make_sources(mission, servicer_, data_directory, &outlook()), faults_)),
      thruster_(with_faults(make_thruster(mission, servicer_), faults_)),
      board_link_(mission.board_link, engine::RandomStream(mission.seed, servicer_.name + "/board_link")),
      timetable_(timetable_of(mission, servicer_, data_directory, model_.model())),
      telecommands_(timetable_.first_packets) {
  check_guidance_domain(mission, servicer_, model_.model().state(servicer_.name));
}

twins::TrueWorld& AssembledMission::truth() {
  if (of_testbed_) return *of_testbed_;
  return model_;
}

twins::TruthOutlook& AssembledMission::outlook() {
  if (of_testbed_) return *of_testbed_;
  return model_;
}

std::vector<std::string> AssembledMission::data_notes() const {
  std::vector<std::string> notes = model_.model().data().notes;
  notes.insert(notes.end(), made_.data_notes.begin(), made_.data_notes.end());
  const std::vector<std::string> of_navigation =
      sensors::with_expected_accelerations(mission_, servicer_, model_.model().data(),
                                           model_.model().state(servicer_.name))
          .notes;
  notes.insert(notes.end(), of_navigation.begin(), of_navigation.end());
  const std::string of_burns = sensors::note_on_burns(servicer_, mission_.guidance.configuration);
  if (!of_burns.empty()) notes.push_back(of_burns);
  return notes;
}

void AssembledMission::start() {
  if (of_testbed_) of_testbed_->start();
  started_.start(timetable_.start);
}

void AssembledMission::branch_from(const mission::Mission& before, fsw::GpsTime time) {
  timetable_.first_packets = telecommands_at_start(before, flying_spacecraft(before), data_directory_, model_.model());
  timetable_.uplink = {time, changed_telecommands(timetable_.first_packets, telecommands_, time)};
}

std::optional<io::WiredReceiver> AssembledMission::wired_receiver() const {
  for (const Source& source : made_.sources)
    if (auto receiver = source.packets->wired_receiver()) return receiver;
  return std::nullopt;
}

std::string AssembledMission::slow_line() const {
  return app::slow_line(*servicer_.flight_computer, mission_.step.shortest_period(), timetable_.first_packets);
}

bool AssembledMission::fly(const Surroundings& surroundings, report::RunRecord& record) {
  start();
  Recording recording(mission_, servicer_, record);
  LineWatch line(mission_, servicer_, surroundings.flight_computer);
  std::vector<RunObserver*> observers(surroundings.observers.begin(), surroundings.observers.end());
  observers.insert(observers.end(), {&recording, &line});
  faults::FaultLog fault_log(mission_, *faults_, servicer_.name, servicer_.observes(), record);
  // Events first: a fault that begins with an event has begun when its observer sees the same packets.
  if (!mission_.faults.empty()) observers.insert(observers.end(), {faults_.get(), &fault_log});
  faults::UncommandedImpulses impulses(faults_);
  faults::FaultyComputer faulty_computer(
      surroundings.flight_computer, faults_, [this] { return connect_flight_computer(servicer_, wired_receiver()); },
      telecommands_);
  pil::FlightComputer& flight_computer =
      faults::concern_computer(mission_.faults) ? faulty_computer : surroundings.flight_computer;
  SelectedClock wall(surroundings.wall);
  const World world{truth(),
                    made_.sources,
                    *thruster_,
                    flight_computer,
                    board_link_,
                    wall,
                    observers,
                    surroundings.progress,
                    surroundings.stop_requested,
                    [&impulses] {
                      std::vector<Timetable::Burn> burns;
                      for (const faults::UncommandedImpulse& impulse : impulses.take())
                        burns.push_back({impulse.time, impulse.dv_rtn, impulse.id});
                      return burns;
                    }};
  Simulation simulation(world, timetable_);

  const auto finish = [&](twins::StopReason reason) {
    facts_ = simulation.facts();
    const std::string trouble = started_.stop(reason);
    for (const auto& testbed : made_.testbeds) testbed->finish();
    recording.finish();
    summarise_mission(mission_, servicer_, record.summary);
    if (of_testbed_) {
      of_testbed_->stop();
      record.summary.sources.push_back({"truth", mission_.truth_source, of_testbed_->exchanges(), 0, {}, 0, 0.0, 0});
    }
    summarise_run(facts_, made_.sources, record.summary);
    record.summary.flight_software = surroundings.flight_computer.description();
    record.summary.flight_step.unit = facts_.cost_unit;
    line.summarise(record.summary.link);
    report::evaluate(record);
    fault_log.finish();  // adds its figures to the summary
    return trouble;
  };
  bool complete = false;
  try {
    for (const auto& testbed : made_.testbeds) {
      testbed->begin(record, surroundings.folder);
      if (engine::WallClock* const clock = testbed->clock()) wall.select(*clock);
    }
    complete = simulation.run();
  } catch (...) {
    finish(twins::StopReason::kFailed);
    throw;
  }
  const std::string trouble = finish(complete ? twins::StopReason::kCompleted : twins::StopReason::kInterrupted);
  if (!trouble.empty()) throw std::runtime_error(trouble);
  return complete;
}

}  // namespace vbar::app
