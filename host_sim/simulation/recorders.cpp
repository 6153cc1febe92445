#include "host_sim/simulation/recorders.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/io/udp_socket.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/lcm_mirror.h"
#include "host_sim/report/provenance.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::app {

namespace {

/// The packets of a step as records, inputs first.
template <class Take>
void for_each_record(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
                     std::span<const pil::Packet> outputs, const Take& take) {
  for (const pil::Packet& packet : inputs) take(twins::PacketRecord{step, time, true, packet});
  for (const pil::Packet& packet : outputs) take(twins::PacketRecord{step, time, false, packet});
}

}  // namespace

class PacketRecorders::Log final : public RunObserver {
 public:
  Log(const std::filesystem::path& file, mission::ImagesInLog images, twins::EventCheck check)
      : writer_(file, images == mission::ImagesInLog::kTiles ? Tiles::kWhole : Tiles::kAsRuns, std::move(check)) {}
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override {
    for_each_record(step, time, inputs, outputs, [this](const twins::PacketRecord& record) { writer_.write(record); });
    writer_.end_step();
  }
  void on_recipe(fsw::GpsTime time, const twins::LoggedImage& recipe) override { writer_.write_recipe(time, recipe); }
  void on_recording(fsw::GpsTime time, const twins::LoggedImage& recording) override {
    writer_.write_recording(time, recording);
  }
  void finish() { writer_.finish(); }

 private:
  using Tiles = twins::ImageLogWriter::Tiles;
  twins::ImageLogWriter writer_;
};

class PacketRecorders::Hash final : public RunObserver {
 public:
  void on_step(std::uint32_t, fsw::GpsTime, std::span<const pil::Packet>,
               std::span<const pil::Packet> outputs) override {
    for (const pil::Packet& packet : outputs) hash_.add(packet);
  }
  [[nodiscard]] const report::OutputHash& get() const { return hash_; }

 private:
  report::OutputHash hash_;
};

class PacketRecorders::Mirror final : public RunObserver {
 public:
  explicit Mirror(const std::string& url) : mirror_(url) {}
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override {
    for_each_record(step, time, inputs, outputs,
                    [this](const twins::PacketRecord& record) { mirror_.publish(record); });
  }

 private:
  report::LcmMirror mirror_;
};

/// Each space packet as one datagram. It never fails a run: what the network does not accept is lost.
class PacketRecorders::Datagrams final : public RunObserver {
 public:
  explicit Datagrams(const mission::UdpAddress& peer) : socket_(peer.host, peer.port, 0, 0) {}
  void on_step(std::uint32_t, fsw::GpsTime, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override {
    for (const std::span<const pil::Packet> packets : {inputs, outputs})
      for (const pil::Packet& packet : packets) send(packet);
  }

 private:
  void send(const pil::Packet& packet) {
    try {
      socket_.send(packet);
    } catch (const io::ChannelError&) {
    }
  }
  io::UdpSocket socket_;
};

PacketRecorders::PacketRecorders(const mission::Mission& mission, const std::filesystem::path& folder,
                                 twins::EventCheck check)
    : hash_(std::make_unique<Hash>()) {
  if (mission.record.packets)
    log_ = std::make_unique<Log>(report::packet_log_file(folder), mission.record.images, std::move(check));
  if (mission.lcm.mirror) mirror_ = std::make_unique<Mirror>(mission.lcm.url);
  if (mission.telemetry.udp.port != 0) datagrams_ = std::make_unique<Datagrams>(mission.telemetry.udp);
  if (log_) observers_.push_back(log_.get());
  observers_.push_back(hash_.get());
  if (mirror_) observers_.push_back(mirror_.get());
  if (datagrams_) observers_.push_back(datagrams_.get());
}

PacketRecorders::~PacketRecorders() = default;

void PacketRecorders::finish() {
  if (log_) log_->finish();
}

std::string PacketRecorders::commands_sha256() const {
  return hash_->get().commands_sha256();
}
std::string PacketRecorders::telemetry_sha256() const {
  return hash_->get().telemetry_sha256();
}

namespace {

using fsw::Vector3;
using fsw::Vector6;
using fsw::orbit::CartesianState;
using fsw::orbit::QnsElements;

report::Triple triple(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
report::Triple triple(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

report::Sextuple sextuple(const Vector6& v) {
  return {v(0), v(1), v(2), v(3), v(4), v(5)};
}
report::Sextuple sextuple(const double (&v)[6]) {
  return {v[0], v[1], v[2], v[3], v[4], v[5]};
}

/// Clears the state: values that navigation does not have are empty in the table.
void forget_state(report::EstimateRow& row) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  row.relative_position_rtn.fill(kUnknown);
  row.relative_velocity_rtn.fill(kUnknown);
  row.sigma_rtn.fill(kUnknown);
  row.a_roe_mean_m.fill(kUnknown);
}

double distance(const report::Triple& a, const report::Triple& b) {
  return report::magnitude({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

/// Whether these are the bytes of a packet and, if it is one of vbar's messages, of that message.
bool is_valid(const pil::Packet& bytes) {
  const auto packet = fsw::packets::parse_packet(bytes);
  if (!packet.ok()) return false;
  bool is_known = false, is_valid = false;
  fsw::packets::for_each_message([&]<class Message>() {
    if (fsw::packets::MessageTraits<Message>::kApid != packet.value().header.apid) return;
    is_known = true;
    is_valid = fsw::packets::decode<Message>(packet.value()).ok();
  });
  return is_valid || !is_known;
}

QnsElements mean_elements(const CartesianState& state) {
  const auto osculating = fsw::orbit::qns_from_cartesian(state);
  if (!osculating.ok()) throw std::runtime_error("a true state is no orbit any more");
  const auto mean = fsw::orbit::mean_from_osculating(osculating.value());
  if (!mean.ok()) throw std::runtime_error("a true orbit has no mean elements");
  return mean.value();
}

}  // namespace

void FlightRecorder::on_truth(fsw::GpsTime time, const PairTruth& truth) {
  report::TruthRow row;
  row.time_s = mission_seconds(time);
  row.servicer_position_eci = triple(truth.servicer.position_eci);
  row.servicer_velocity_eci = triple(truth.servicer.velocity_eci);
  row.target_position_eci = triple(truth.target.position_eci);
  row.target_velocity_eci = triple(truth.target.velocity_eci);
  const auto relative = fsw::orbit::relative_state_rtn(truth.servicer, truth.target);
  row.relative_position_rtn = triple(relative.position_rtn);
  row.relative_velocity_rtn = triple(relative.velocity_rtn);
  const Vector6 roe = fsw::orbit::roe_from_qns(mean_elements(truth.servicer), mean_elements(truth.target));
  row.a_roe_mean_m = sextuple(mission_.guidance.reference_semi_major_axis_m * roe);
  record_.truth.push_back(row);
}

void FlightRecorder::on_attitudes(fsw::GpsTime time, const std::vector<NamedAttitude>& attitudes) {
  for (const NamedAttitude& named : attitudes) {
    const Eigen::Quaterniond& q = named.attitude.q_body_eci;
    record_.attitudes.push_back(
        {mission_seconds(time), named.spacecraft, {q.w(), q.x(), q.y(), q.z()}, triple(named.attitude.rate_body)});
  }
}

// Control error: the true RTN position of the target minus the one that the commanded mean ROE give on the true
// servicer orbit.
void FlightRecorder::on_waypoint(const mission::Waypoint& waypoint, const PairTruth& truth) {
  const double a = mission_.guidance.reference_semi_major_axis_m;
  const QnsElements servicer_mean = mean_elements(truth.servicer);
  const auto desired = fsw::orbit::relative_state_from_mean_roe(servicer_mean, waypoint.a_roe_m / a);
  if (!desired.ok()) throw std::runtime_error("a waypoint gives no orbit about the servicer");
  const auto actual = fsw::orbit::relative_state_rtn(truth.servicer, truth.target);

  report::WaypointRow row;
  row.index = waypoint.index;
  row.time_s = mission_seconds(waypoint.time);
  row.a_roe_desired_m = sextuple(waypoint.a_roe_m);
  row.a_roe_actual_m = sextuple(a * fsw::orbit::roe_from_qns(servicer_mean, mean_elements(truth.target)));
  row.desired_position_rtn = triple(desired.value().position_rtn);
  row.actual_position_rtn = triple(actual.position_rtn);
  row.control_error_m = distance(row.desired_position_rtn, row.actual_position_rtn);
  record_.waypoints.push_back(row);
}

void FlightRecorder::on_answer(fsw::GpsTime time, const pil::StepResult& answer) {
  report::EstimateRow row;
  row.time_s = mission_seconds(time);
  row.step_cost = answer.report.count;
  row.stack_bytes = answer.report.stack_bytes;
  count_output(answer);
  for (const pil::Packet& bytes : answer.packets) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;  // hashed and logged as it came; it only has no row
    if (packet.value().header.apid == fsw::packets::Apid::kManeuverCommand) {
      on_command(time, packet.value());
    } else {
      on_any_telemetry(row.time_s, packet.value());
      on_telemetry(row, packet.value());
    }
  }
  record_.estimates.push_back(row);
}

void FlightRecorder::count_output(const pil::StepResult& answer) {
  if (!answer.has_flown) return;
  report::FlightOutput& output = record_.summary.flight_output;
  ++output.steps;
  output.packets += answer.packets.size();
  if (answer.trouble.status != 0) {
    ++output.steps_failed;
    output.last_status = answer.trouble.status;
  }
  if (answer.packets.empty()) ++output.steps_silent;
  for (const pil::Packet& packet : answer.packets) output.packets_invalid += is_valid(packet) ? 0 : 1;
  output.packets_dropped += answer.trouble.packets_dropped;
  output.inputs_refused += answer.trouble.inputs_refused;
}

/// Every message of telemetry that no module makes rows of.
void FlightRecorder::on_any_telemetry(double step_time_s, const fsw::packets::PacketView& packet) {
  if (report::is_in_table_of_module(record_.extensions, packet.header.apid)) return;
  const auto record = [&]<class Message>(std::vector<report::TelemetryRow<Message>>& rows) {
    if (const auto message = fsw::packets::decode<Message>(packet); message.ok())
      rows.push_back({mission_seconds(packet.header.time), step_time_s, message.value()});
  };
  std::apply([&](auto&... rows) { (record(rows), ...); }, record_.telemetry);
}

/// Fills the row of the step.
void FlightRecorder::on_telemetry(report::EstimateRow& row, const fsw::packets::PacketView& packet) {
  if (const auto navigation = fsw::packets::decode<telemetry_navigation>(packet); navigation.ok()) {
    const telemetry_navigation& m = navigation.value();
    row.step = m.step;
    row.navigation_source = m.source;
    row.navigation_valid = m.valid;
    row.relative_position_rtn = triple(m.relative_position_rtn);
    row.relative_velocity_rtn = triple(m.relative_velocity_rtn);
    row.sigma_rtn = sextuple(m.sigma_rtn);
    row.a_roe_mean_m = sextuple(m.a_roe_mean_m);
    if (m.valid == 0) forget_state(row);
  } else if (const auto control = fsw::packets::decode<telemetry_control>(packet); control.ok()) {
    const telemetry_control& m = control.value();
    row.a_roe_desired_m = sextuple(m.a_roe_desired_m);
    row.predicted_a_roe_error_m = sextuple(m.predicted_a_roe_error_m);
    row.mode = m.mode;
    row.active_solver = m.active_solver;
    row.waypoint_index = m.waypoint_index;
    row.planned_burns = m.planned_burns;
    row.solver_status = report::solver_statuses(m);
    row.safety_status = m.safety_status;
    row.planned_dv_mps = m.planned_dv;
    row.passive_safety_distance_m = m.passive_safety_distance_m;
    row.commanded_dv_mps = m.commanded_dv;
  }
}

void FlightRecorder::on_command(fsw::GpsTime step_time, const fsw::packets::PacketView& packet) {
  const auto command = fsw::packets::decode<maneuver_command>(packet);
  if (command.ok()) add_maneuver(step_time, packet.header.time, command.value());
}

void FlightRecorder::on_prescribed(fsw::GpsTime time, const maneuver_command& command) {
  add_maneuver(time, time, command);
}

void FlightRecorder::add_maneuver(fsw::GpsTime command_time, fsw::GpsTime burn_time, const maneuver_command& command) {
  report::ManeuverRow row;
  row.maneuver_id = command.maneuver_id;
  row.waypoint_index = command.waypoint_index;
  row.solver = command.solver;
  row.command_time_s = mission_seconds(command_time);
  row.execution_time_s = mission_seconds(burn_time);
  row.commanded_dv_rtn_mps = triple(command.dv_rtn);
  record_.maneuvers.push_back(row);
}

void FlightRecorder::on_execution(fsw::GpsTime time, const executed_maneuver& executed) {
  for (report::ManeuverRow& row : record_.maneuvers) {
    if (row.maneuver_id != executed.maneuver_id || row.execution_time_s != mission_seconds(time)) continue;
    row.accepted = executed.accepted != 0;
    row.executed_dv_rtn_mps = triple(executed.dv_rtn);
  }
}

}  // namespace vbar::app
