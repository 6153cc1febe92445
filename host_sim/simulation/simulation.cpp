#include "host_sim/simulation/simulation.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace vbar::app {
namespace {

using fsw::GpsTime;
using fsw::packets::Apid;
using Steady = std::chrono::steady_clock;

/// Adds the wall-clock time of its life to a sum, s.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum_s) : sum_s_(sum_s) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { sum_s_ += elapsed_s(); }
  [[nodiscard]] double elapsed_s() const { return std::chrono::duration<double>(Steady::now() - start_).count(); }

 private:
  double& sum_s_;
  Steady::time_point start_ = Steady::now();
};

engine::WallClock::Span wall_span(double s) {
  return std::chrono::duration_cast<engine::WallClock::Span>(std::chrono::duration<double>(s));
}

}  // namespace

Simulation::Simulation(const World& world, const Timetable& timetable)
    : world_(world),
      timetable_(timetable),
      clock_(timetable.clock, world.wall),
      events_(timetable.start),
      ticks_(timetable.spacecraft, 0),
      arrived_(timetable.first_packets) {
  for (const Source& source : world.sources) facts_.sources.push_back({source.name, 0, 0, {}, {}});
}

bool Simulation::run() {
  const Steady::time_point started = Steady::now();
  const double truth_before_s = world_.truth.wall_s();
  const auto finish = [&] {
    facts_.wall_s = std::chrono::duration<double>(Steady::now() - started).count();
    facts_.truth_s = world_.truth.wall_s() - truth_before_s;
    facts_.deadlines = clock_.report();
    // What a link delivers after the end is of no interest.
    facts_.simulated = std::min(events_.now(), timetable_.end) - timetable_.start;
  };
  try {
    fly();
  } catch (...) {
    finish();
    throw;
  }
  facts_.complete = !interrupted_;
  finish();
  return facts_.complete;
}

void Simulation::fly() {
  schedule_timetable();
  clock_.start(timetable_.start);
  while (auto next = events_.pop()) {
    interrupted_ = !wait_until_due(next->event);
    if (interrupted_) return;
    std::visit([this](const auto& event) { handle(event); }, next->event);
    schedule_more_burns();
    if (interrupted_) return;
  }
}

/// Returns false if the run shall stop.
bool Simulation::wait_until_due(const Event& event) {
  const GpsTime now = events_.now();
  if (std::holds_alternative<StepFlight>(event)) return clock_.begin_step(now, world_.stop_requested);
  const auto* const measurement = std::get_if<TakeMeasurement>(&event);
  engine::Lateness* const late = measurement != nullptr ? &facts_.sources[measurement->source].late : nullptr;
  return clock_.wait_until(now, late, world_.stop_requested);
}

template <class E>
void Simulation::schedule(GpsTime time, E event) {
  if (!events_.schedule(time, E::kPriority, std::move(event)).ok())
    throw std::logic_error(fmt::format("an event at {:.9f} s of the run was scheduled at {:.9f} s, after it",
                                       mission_seconds(time), mission_seconds(events_.now())));
}

/// Measurements, waypoints and steps are known; packets and burns come of what happens.
void Simulation::schedule_timetable() {
  for (std::size_t source = 0; source < world_.sources.size(); ++source) schedule_measurement(source, timetable_.start);
  schedule(timetable_.start, StepFlight{});
  for (std::size_t k = 0; k < timetable_.waypoints.size(); ++k) {
    const GpsTime time = timetable_.waypoints[k];
    if (time >= timetable_.start && time <= timetable_.end) schedule(time, JudgeWaypoint{k});
  }
  for (std::size_t k = 0; k < timetable_.burns.size(); ++k) schedule_prescribed(k);
  schedule_more_burns();
  if (!timetable_.uplink) return;
  for (const twins::Packet& packet : timetable_.uplink->packets)
    schedule(timetable_.uplink->time, DeliverPacket{packet});
}

void Simulation::schedule_more_burns() {
  if (!world_.more_burns) return;
  for (const Timetable::Burn& burn : world_.more_burns()) {
    if (burn.time > timetable_.end) continue;
    timetable_.burns.push_back(burn);
    schedule_prescribed(timetable_.burns.size() - 1);
  }
}

void Simulation::schedule_prescribed(std::size_t index) {
  schedule(timetable_.burns[index].time - world_.thruster.lead(prescribed_command(index)),
           ExecutePrescribedBurn{index});
}

void Simulation::schedule_measurement(std::size_t source, GpsTime from) {
  const auto epoch = world_.sources[source].packets->next_epoch(from);
  if (!epoch || *epoch > timetable_.end) return;
  if (*epoch < from)
    throw std::logic_error(fmt::format("source {}: asked for an epoch from {:.9f} s of the run on, it named {:.9f} s",
                                       world_.sources[source].name, mission_seconds(from), mission_seconds(*epoch)));
  schedule(*epoch, TakeMeasurement{source});
}

void Simulation::handle(const TakeMeasurement& taken) {
  const GpsTime now = events_.now();
  const Source& source = world_.sources[taken.source];
  world_.truth.advance_to(now);
  const twins::TruthSnapshot truth = world_.truth.snapshot(source.packets->truth_detail());
  if (source.packets->truth_is_compared())
    for (RunObserver* observer : world_.observers) observer->on_measured(source.name, truth);

  ++facts_.sources[taken.source].epochs;
  twins::Measurement measurement;
  {
    const Stopwatch watch(facts_.sources_s);
    measurement = source.packets->measure(truth);
  }
  note(now, source.name, measurement.notes);
  // A source that fails an epoch delivers nothing; the flight software coasts.
  if (measurement.status == twins::MeasurementStatus::kFailed) {
    fail(taken.source, now, measurement.reason);
  } else if (measurement.available < now) {
    throw std::logic_error(fmt::format("source {}: packets delivered at {:.9f} s of the run, measured at {:.9f} s",
                                       source.name, mission_seconds(measurement.available), mission_seconds(now)));
  } else {
    if (measurement.recipe)
      for (RunObserver* observer : world_.observers) observer->on_recipe(now, *measurement.recipe);
    record(now, measurement.recording);
    pass_on(std::move(measurement.packets), measurement.available, measurement.bypasses_link);
    if (measurement.pending.valid()) {
      auto completion = std::make_shared<std::future<twins::Completion>>(std::move(measurement.pending));
      schedule(measurement.available,
               CollectPending{taken.source, now, std::move(completion), measurement.bypasses_link});
    }
  }
  schedule_measurement(taken.source, now + fsw::Duration{1});
}

void Simulation::handle(const CollectPending& collected) {
  if (!wait_for(collected)) return;
  const std::string& name = world_.sources[collected.source].name;
  twins::Completion completion;
  try {
    completion = collected.completion->get();
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("source {}: {}", name, error.what()));
  }
  note(collected.epoch, name, completion.notes);
  if (!completion.failure.empty()) fail(collected.source, collected.epoch, completion.failure);
  record(events_.now(), completion.recording);
  pass_on(std::move(completion.packets), events_.now(), collected.bypasses_link);
}

/// Simulated time waits for what is pending. False if the run shall stop.
bool Simulation::wait_for(const CollectPending& pending) {
  const Stopwatch watch(facts_.sources_s);
  const Source& source = world_.sources[pending.source];
  const std::chrono::milliseconds limit = source.packets->wait_limit();
  const Steady::time_point until = Steady::now() + limit;
  while (pending.completion->wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
    interrupted_ = stop_requested();
    if (interrupted_) return false;
    if (Steady::now() >= until)
      throw std::runtime_error(
          fmt::format("source {}: no answer within its time limit of {} s to the measurement at {:.3f} s of the run",
                      source.name, std::chrono::duration<double>(limit).count(), mission_seconds(pending.epoch)));
  }
  return true;
}

/// Records an image before its packets are passed on: an observer that cannot keep it ends the run.
void Simulation::record(GpsTime time, const std::optional<twins::LoggedImage>& recording) {
  if (!recording) return;
  for (RunObserver* observer : world_.observers) observer->on_recording(time, *recording);
}

void Simulation::pass_on(std::vector<twins::Packet> packets, GpsTime available, bool bypasses_link) {
  for (twins::Packet& packet : packets) {
    if (bypasses_link) {
      schedule(available, DeliverPacket{std::move(packet)});
    } else {
      send_to_flight(std::move(packet), available);
    }
  }
}

void Simulation::send_to_flight(twins::Packet packet, GpsTime sent) {
  const engine::Transfer transfer = world_.board_link.send(sent);
  if (!transfer.lost) schedule(transfer.delivery, DeliverPacket{std::move(packet)});
}

void Simulation::note(GpsTime time, std::string_view source, std::span<const twins::Note> notes) {
  for (const twins::Note& one : notes)
    for (RunObserver* observer : world_.observers) observer->on_note(time, source, one);
}

void Simulation::fail(std::size_t source, GpsTime epoch, const std::string& reason) {
  RunFacts::OfSource& facts = facts_.sources[source];
  ++facts.failures;
  facts.last_failure = reason.empty() ? "no reason given" : reason;
  for (RunObserver* observer : world_.observers) observer->on_failure(epoch, facts.name, facts.last_failure);
}

void Simulation::handle(const DeliverPacket& delivery) {
  arrived_.push_back(delivery.packet);
}

void Simulation::handle(const JudgeWaypoint& judged) {
  world_.truth.advance_to(events_.now());
  const twins::TruthSnapshot truth = world_.truth.snapshot(twins::TruthDetail::kStates);
  for (RunObserver* observer : world_.observers) observer->on_waypoint(judged.index, truth);
}

void Simulation::handle(const StepFlight&) {
  const GpsTime now = events_.now();
  world_.truth.advance_to(now);
  const twins::TruthSnapshot truth = world_.truth.snapshot(twins::TruthDetail::kStates);
  for (RunObserver* observer : world_.observers) observer->on_truth(truth);

  arrived_.push_back(make_tick());
  std::vector<twins::Packet> inputs = std::exchange(arrived_, {});
  double exchange_s = 0.0;
  pil::StepResult answer;
  {
    const Stopwatch watch(exchange_s);
    answer = world_.flight_computer.step(step_, inputs);
  }
  clock_.end_exchange(wall_span(exchange_s), wall_span(answer.compute_wall_s));
  if (answer.report.present) facts_.cost_unit = answer.report.unit;
  facts_.flight_s += answer.compute_wall_s;
  facts_.link_s += exchange_s - answer.compute_wall_s;
  // What it received on a line of its own it gave to the flight software before the tick, which is the last.
  inputs.insert(inputs.end() - 1, answer.wired.begin(), answer.wired.end());

  for (RunObserver* observer : world_.observers) {
    observer->on_step(step_, now, inputs, answer.packets);
    observer->on_answer(now, answer);
  }
  take_commands(answer);
  ++step_;
  const GpsTime next = timetable_.step.next_after(now);
  if (next <= timetable_.end) schedule(next, StepFlight{});
  if (world_.progress) world_.progress(now - timetable_.start);
  interrupted_ = stop_requested();
}

twins::Packet Simulation::make_tick() {
  tick message{};
  message.step = step_;
  message.period_ns = (timetable_.step.next_after(events_.now()) - events_.now()).ns;
  return *ticks_.encode(events_.now(), message);  // holds integers only
}

/// Commands take effect once the flight computer has had its compute latency; one that asks for an earlier time is
/// refused.
void Simulation::take_commands(const pil::StepResult& answer) {
  const GpsTime effective = events_.now() + timetable_.compute_latency;
  for (const pil::Packet& bytes : answer.packets) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    for (const Source& source : world_.sources) source.packets->command(packet.value(), effective);
    if (packet.value().header.apid == Apid::kPointingCommand) point(packet.value(), effective);
    if (packet.value().header.apid != Apid::kManeuverCommand) continue;
    const auto command = fsw::packets::decode<maneuver_command>(packet.value());
    if (!command.ok()) continue;
    const GpsTime time = packet.value().header.time;
    const GpsTime begin = time - world_.thruster.lead(command.value());
    if (begin < effective) {
      report_execution(world_.thruster.execute(command.value(), time, effective));
    } else if (begin <= timetable_.end) {
      schedule(begin, ExecuteBurn{command.value(), time});
    }
  }
}

/// The platform follows from the moment the command takes effect.
void Simulation::point(const fsw::packets::PacketView& packet, GpsTime effective) {
  const auto command = fsw::packets::decode<pointing_command>(packet);
  if (!command.ok()) return;
  const double(&boresight)[3] = command.value().boresight_rtn;
  const double(&rate)[3] = command.value().boresight_rate_rtn;
  const fsw::Vector3 rate_rtn(rate[0], rate[1], rate[2]);
  const double late_s = fsw::seconds(effective - packet.header.time);
  const fsw::Vector3 boresight_rtn = fsw::Vector3(boresight[0], boresight[1], boresight[2]) + late_s * rate_rtn;
  world_.truth.point(effective, boresight_rtn, rate_rtn);
}

void Simulation::handle(const ExecuteBurn& burn) {
  execute(burn.command, burn.time);
}

maneuver_command Simulation::prescribed_command(std::size_t index) const {
  maneuver_command command{};
  command.maneuver_id = timetable_.burns[index].id;
  command.waypoint_index = -1;
  command.solver = waypoint::kSolverNone;
  const fsw::Vector3& dv_rtn = timetable_.burns[index].dv_rtn;
  std::copy(dv_rtn.begin(), dv_rtn.end(), command.dv_rtn);
  return command;
}

void Simulation::handle(const ExecutePrescribedBurn& prescribed) {
  const maneuver_command command = prescribed_command(prescribed.index);
  const GpsTime time = timetable_.burns[prescribed.index].time;
  for (RunObserver* observer : world_.observers) observer->on_prescribed(time, command);
  execute(command, time);
}

void Simulation::execute(const maneuver_command& command, GpsTime burn_time) {
  const GpsTime now = events_.now();
  world_.truth.advance_to(now);
  const twins::Execution execution = world_.thruster.execute(command, burn_time, now);
  if (execution.arc) {
    world_.truth.begin_burn(*execution.arc);
    return schedule(now + fsw::nearest_duration(execution.arc->duration_s()), ReportBurn{execution});
  }
  const double(&dv)[3] = execution.maneuver.dv_rtn;
  world_.truth.apply_impulse_rtn({dv[0], dv[1], dv[2]});
  report_execution(execution);
}

void Simulation::handle(const ReportBurn& ended) {
  report_execution(ended.execution);
}

void Simulation::report_execution(const twins::Execution& execution) {
  note(execution.time, "thruster", execution.notes);
  for (RunObserver* observer : world_.observers) observer->on_execution(execution.time, execution.maneuver);
  if (!execution.packet.empty()) send_to_flight(execution.packet, events_.now());
}

}  // namespace vbar::app
