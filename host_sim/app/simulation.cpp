#include "host_sim/app/simulation.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/initial_attitudes.h"
#include "host_sim/app/initial_orbits.h"
#include "host_sim/app/make_twins.h"
#include "host_sim/report/summarise.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/ideal_navigation/ideal_navigation_kind.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/twins/camera/camera_sensor.h"

namespace vbar::app {
namespace {

using fsw::GpsTime;
using fsw::packets::Apid;

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

engine::WallClock::Span wall_span(double s) {
  return std::chrono::duration_cast<engine::WallClock::Span>(std::chrono::duration<double>(s));
}

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

template <class Message>
pil::Packet make_packet(GpsTime time, std::uint8_t spacecraft, std::uint16_t sequence, const Message& message) {
  fsw::packets::PacketHeader header;
  header.time = time;
  header.spacecraft = spacecraft;
  header.sequence_count = sequence & 0x3FFFU;
  pil::Packet packet(fsw::packets::kMaxPacketBytes);
  const auto size = fsw::packets::encode(header, message, packet);
  if (!size.ok()) throw std::runtime_error("a message cannot be sent: it holds a number that is not finite");
  packet.resize(size.value());
  return packet;
}

// Order of things that happen at one instant (simulation.h).
constexpr std::int32_t kPriorityOf[] = {0, 5, 10, 20, 30, 40, 40};

}  // namespace

Simulation::Simulation(const mission::Mission& mission, const std::filesystem::path& data_directory,
                       const Surroundings& surroundings, report::RunRecord& record)
    : mission_(mission),
      servicer_(complete_servicer(mission)),
      surroundings_(surroundings),
      record_(record),
      data_directory_(data_directory),
      recorder_(mission, servicer_, record),
      truth_(truth_settings(mission, data_directory)),
      board_link_(mission.board_link, engine::RandomStream(mission.seed, servicer_.name + "/board_link")),
      earth_rotation_(truth_.data().earth_orientation, mission.epoch),
      line_(*servicer_.flight_computer, mission.step, surroundings.flight_computer.statistics()),
      clock_(mission.clock, surroundings.wall),
      events_(mission.start_time()) {
  place_spacecraft(mission, truth_);
  set_attitudes(mission, data_directory, truth_);
  servicer_index_ = truth_.index_of(servicer_.name);
  target_index_ = truth_.index_of(servicer_.observes());
  sensors_ = make_sensors(mission, servicer_, data_directory);
  thruster_ = make_thruster(mission, servicer_);
}

bool Simulation::run() {
  const double started = wall_seconds();
  bool complete = false;
  const auto finish = [&] {
    recorder_.finish();
    summarise(wall_seconds() - started, complete);
    report::evaluate(record_);
  };
  try {
    schedule_the_known();
    clock_.start(mission_.start_time());
    while (auto next = events_.pop()) {
      const bool is_step = std::holds_alternative<StepFlight>(next->event);
      if (is_step && !clock_.begin_step(events_.now(), surroundings_.stop_requested)) break;
      std::visit([this](const auto& event) { handle(event); }, next->event);
      if (is_step && surroundings_.progress) surroundings_.progress(events_.now() - mission_.start_time());
      if (is_step && surroundings_.stop_requested && surroundings_.stop_requested()) break;
    }
    complete = events_.empty();
  } catch (...) {
    finish();
    throw;
  }
  finish();
  return complete;
}

void Simulation::schedule(GpsTime time, Event event) {
  const std::int32_t priority = kPriorityOf[event.index()];
  static_cast<void>(events_.schedule(time, priority, std::move(event)));  // never before now: callers see to it
}

/// Measurements, waypoints and steps are a timetable; packets and burns come of what happens.
void Simulation::schedule_the_known() {
  for (std::size_t sensor = 0; sensor < sensors_.size(); ++sensor) {
    schedule_measurement(sensor, mission_.start_time());
  }
  schedule(mission_.start_time(), StepFlight{});
  for (std::size_t k = 0; k < mission_.waypoints.size(); ++k) {
    const GpsTime time = mission_.waypoints[k].time;
    if (time >= mission_.start_time() && time <= mission_.end_time()) schedule(time, JudgeWaypoint{k});
  }
  for (std::size_t k = 0; k < mission_.burns.size(); ++k) schedule(mission_.burns[k].time, ExecutePrescribedBurn{k});
  queue_telecommands();
}

/// The flight software is told its mission before its first step.
void Simulation::queue_telecommands() {
  const sensors::TelecommandContext context{
      mission_, servicer_, data_directory_, *truth_.data().earth_orientation,
      [this](std::string_view spacecraft) { return truth_.state(truth_.index_of(std::string(spacecraft))); }};
  for (twins::Packet& packet : sensors::telecommands_of(context)) arrived_.push_back(std::move(packet));
}

void Simulation::schedule_measurement(std::size_t sensor, GpsTime from) {
  const auto epoch = sensors_[sensor]->next_epoch(from);
  if (epoch && *epoch <= mission_.end_time()) schedule(*epoch, TakeMeasurement{sensor});
}

void Simulation::handle(const TakeMeasurement& taken) {
  const GpsTime now = events_.now();
  truth_.advance_to(now);
  twins::Measurement measurement = measure_now(*sensors_[taken.sensor]);
  if (!measurement.recipe.empty())
    for (PacketObserver* observer : surroundings_.observers) observer->on_recipe(now, measurement.recipe);
  // A sensor that fails an epoch has nothing to say; the flight software coasts.
  pass_on(std::move(measurement.packets), measurement.available, measurement.bypasses_link);
  if (measurement.pending.valid()) {
    using Pending = std::future<std::vector<twins::Packet>>;
    schedule(measurement.available,
             CollectPending{std::make_shared<Pending>(std::move(measurement.pending)), measurement.bypasses_link});
  }
  schedule_measurement(taken.sensor, now + fsw::Duration{1});
}

void Simulation::handle(const CollectPending& collected) {
  pass_on(collected.packets->get(), events_.now(), collected.bypasses_link);
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

/// In lock-step simulated time waits for a sensor that needs longer.
twins::Measurement Simulation::measure_now(twins::PacketSource& sensor) {
  const twins::TruthSnapshot truth = snapshot();
  recorder_.on_measured(truth);
  while (true) {
    twins::Measurement measurement = sensor.measure(truth);
    if (measurement.status != twins::MeasurementStatus::kLater) return measurement;
    if (surroundings_.stop_requested && surroundings_.stop_requested()) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

std::vector<NamedAttitude> Simulation::all_attitudes() const {
  std::vector<NamedAttitude> all;
  for (const mission::Spacecraft& spacecraft : mission_.spacecraft) {
    if (!spacecraft.attitude) continue;
    all.push_back({spacecraft.name, truth_.attitude(truth_.index_of(spacecraft.name))});
  }
  return all;
}

twins::TruthSnapshot Simulation::snapshot() {
  twins::TruthSnapshot truth;
  truth.time = events_.now();
  truth.R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(fsw::seconds(events_.now() - mission_.epoch));
  for (const mission::Spacecraft& spacecraft : mission_.spacecraft) {
    const std::size_t index = truth_.index_of(spacecraft.name);
    twins::SpacecraftTruth& one = truth.spacecraft.emplace_back();
    one.name = spacecraft.name;
    one.orbit = truth_.state(index);
    if (truth_.has_attitude(index)) one.attitude = truth_.attitude(index);
  }
  return truth;
}

void Simulation::send_to_flight(pil::Packet packet, GpsTime sent) {
  const engine::Transfer transfer = board_link_.send(sent);
  if (!transfer.lost) schedule(transfer.delivery, DeliverPacket{std::move(packet)});
}

void Simulation::handle(const DeliverPacket& delivery) {
  arrived_.push_back(delivery.packet);
}

void Simulation::handle(const JudgeWaypoint& judged) {
  truth_.advance_to(events_.now());
  recorder_.on_waypoint(mission_.waypoints[judged.index], pair_truth());
}

void Simulation::handle(const StepFlight&) {
  const GpsTime now = events_.now();
  truth_.advance_to(now);
  recorder_.on_truth(now, pair_truth());
  recorder_.on_attitudes(now, all_attitudes());

  arrived_.push_back(make_tick());
  const std::vector<pil::Packet> inputs = std::exchange(arrived_, {});
  const double before = wall_seconds();
  const pil::StepResult answer = surroundings_.flight_computer.step(step_, inputs);
  const double exchange_s = wall_seconds() - before;
  clock_.end_exchange(wall_span(exchange_s), wall_span(answer.compute_wall_s));
  if (answer.report.present) cost_unit_ = answer.report.unit;
  flight_compute_s_ += answer.compute_wall_s;
  link_s_ += exchange_s - answer.compute_wall_s;
  line_.after_step(surroundings_.flight_computer.statistics());

  for (PacketObserver* observer : surroundings_.observers) observer->on_step(step_, now, inputs, answer.packets);
  recorder_.on_inputs(now, inputs);
  recorder_.on_answer(now, answer);
  take_commands(answer);
  ++step_;
  if (now + mission_.step <= mission_.end_time()) schedule(now + mission_.step, StepFlight{});
}

pil::Packet Simulation::make_tick() {
  tick message{};
  message.step = step_;
  message.period_ns = mission_.step.ns;
  return make_packet(events_.now(), servicer_.number, tick_sequence_++, message);
}

/// Commands take effect once the flight computer has had its compute latency; one that asks for an earlier time is
/// refused.
void Simulation::take_commands(const pil::StepResult& answer) {
  const GpsTime effective = events_.now() + servicer_.flight_computer->compute_latency;
  for (const pil::Packet& bytes : answer.packets) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    if (packet.value().header.apid == Apid::kPointingCommand) point(packet.value(), effective);
    if (packet.value().header.apid != Apid::kManeuverCommand) continue;
    const auto command = fsw::packets::decode<maneuver_command>(packet.value());
    if (!command.ok()) continue;
    const GpsTime time = packet.value().header.time;
    if (time < effective) {
      report_execution(thruster_->execute(command.value(), time, effective));
    } else if (time <= mission_.end_time()) {
      schedule(time, ExecuteBurn{command.value()});
    }
  }
}

/// The platform follows from the moment it is told.
void Simulation::point(const fsw::packets::PacketView& packet, GpsTime effective) {
  const auto command = fsw::packets::decode<pointing_command>(packet);
  if (!command.ok() || !servicer_.attitude || !std::holds_alternative<mission::Commanded>(*servicer_.attitude)) return;
  const double(&boresight)[3] = command.value().boresight_rtn;
  const double(&rate)[3] = command.value().boresight_rate_rtn;
  const fsw::Vector3 rate_rtn(rate[0], rate[1], rate[2]);
  const double late_s = fsw::seconds(effective - packet.header.time);
  const fsw::Vector3 boresight_rtn = fsw::Vector3(boresight[0], boresight[1], boresight[2]) + late_s * rate_rtn;
  static_cast<void>(truth_.command_pointing(servicer_index_, effective, boresight_rtn, rate_rtn));
}

void Simulation::handle(const ExecuteBurn& burn) {
  execute(burn.command);
}

/// Numbers below zero, which the flight software never gives.
void Simulation::handle(const ExecutePrescribedBurn& prescribed) {
  maneuver_command command{};
  command.maneuver_id = -1 - static_cast<std::int32_t>(prescribed.index);
  command.waypoint_index = -1;
  command.solver = waypoint::kSolverNone;
  const fsw::Vector3& dv_rtn = mission_.burns[prescribed.index].dv_rtn;
  std::copy(dv_rtn.begin(), dv_rtn.end(), command.dv_rtn);
  recorder_.on_prescribed(events_.now(), command);
  execute(command);
}

void Simulation::execute(const maneuver_command& command) {
  const GpsTime now = events_.now();
  truth_.advance_to(now);
  const twins::Execution execution = thruster_->execute(command, now, now);
  const double(&dv)[3] = execution.maneuver.dv_rtn;
  truth_.apply_impulse_rtn(servicer_index_, {dv[0], dv[1], dv[2]});
  report_execution(execution);
}

void Simulation::report_execution(const twins::Execution& execution) {
  recorder_.on_execution(execution.time, execution.maneuver);
  send_to_flight(execution.packet, events_.now());
}

PairTruth Simulation::pair_truth() const {
  return {truth_.state(servicer_index_), truth_.state(target_index_)};
}

void Simulation::summarise(double wall_s, bool complete) {
  report::Summary& summary = record_.summary;
  summary.mission = mission_.name;
  summary.seed = mission_.seed;
  summary.complete = complete;
  summary.flight_computer = mission::name_of(servicer_.flight_computer->target);
  summary.flight_software = surroundings_.flight_computer.description();
  summary.target = servicer_.observes();
  summary.flight_step.unit = cost_unit_;
  const auto* const camera_settings = mission::find_settings<sensors::CameraSensor>(servicer_);
  const auto* const gnss = mission::find_settings<sensors::GnssSensor>(servicer_);
  const auto* const navigation = mission::find_settings<sensors::NavigationSensor>(servicer_);
  const bool is_by_pose = camera_settings != nullptr && camera_settings->use == sensors::CameraNavigation::kPose;
  summary.navigation = is_by_pose                   ? "pose"
                       : camera_settings != nullptr ? "angles_only"
                       : gnss != nullptr            ? "gnss"
                                                    : navigation->source;
  summary.gnss = gnss != nullptr ? gnss->source : "";
  summary.camera = camera_settings != nullptr ? camera_settings->source : "";
  summary.static_floor_m = sensors::gnss_static_floor_m(mission_, servicer_);
  // What a link delivers after the end is of no interest.
  summary.simulated_s = fsw::seconds(std::min(events_.now(), mission_.end_time()) - mission_.start_time());
  summary.wall_s = wall_s;
  summary.speed_factor = wall_s > 0.0 ? summary.simulated_s / wall_s : 0.0;

  const pil::LinkStatistics link = surroundings_.flight_computer.statistics();
  summary.link = {link.bytes_sent + link.bytes_received, link.frames_resent, link.frames_rejected,
                  link.frames_duplicated, link.strangers_ignored};
  line_.summarise(summary.link);
  const engine::DeadlineReport& deadlines = clock_.report();
  summary.deadlines = {deadlines.step_late.count, deadlines.woke_late.count, deadlines.link_late.count,
                       deadlines.simulation_late.count};
  summary.wall_share.truth_s = truth_.statistics().wall_s;
  summary.wall_share.flight_s = flight_compute_s_;
  summary.wall_share.link_s = link_s_;
  summary.wall_share.other_s = wall_s - summary.wall_share.truth_s - flight_compute_s_ - link_s_;
  for (const auto& sensor : sensors_) {
    auto* const camera = dynamic_cast<twins::camera::CameraSensor*>(sensor.get());
    if (camera == nullptr) continue;
    const twins::camera::ImagingTime spent = camera->time_spent();
    summary.wall_share.render_s = spent.render_s;
    summary.wall_share.detector_s = spent.detector_s;
    summary.wall_share.packing_s = spent.packing_s;
  }
}

}  // namespace vbar::app
