#include "tests/unit/fsw/gnc/small_world.h"

#include "fsw/guidance/management.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnc::test {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

// Mean elements of the paper's servicer (its osculating table by first-order Brouwer theory).
const orbit::QnsElements kServicerMean{7078138.944,          0.00104134174,         1.5923745e-5,
                                       98.1853293 * kDegree, -90.0001291 * kDegree, -0.6886792 * kDegree};

orbit::CartesianState state_of(const orbit::QnsElements& mean) {
  const auto osculating = orbit::osculating_from_mean(mean);
  EXPECT_TRUE(osculating.ok());
  return orbit::cartesian_from_qns(osculating.value()).value();
}

orbit::QnsElements mean_of(const orbit::CartesianState& state) {
  return orbit::mean_from_osculating(orbit::qns_from_cartesian(state).value()).value();
}

/// In pieces that the short coast of the flight software's library accepts.
void coast(orbit::CartesianState& state, double seconds_to_go) {
  while (seconds_to_go > 0.0) {
    const double piece = seconds_to_go < 3600.0 ? seconds_to_go : 3600.0;
    const auto coasted = orbit::propagate_j2(state, piece);
    ASSERT_TRUE(coasted.ok());
    state = coasted.value();
    seconds_to_go -= piece;
  }
}

void copy(const Vector3& from, double (&to)[3]) {
  for (int k = 0; k < 3; ++k) to[k] = from(k);
}

Vector6 roe(double da, double dl, double dex, double dey, double dix, double diy) {
  return (Vector6() << da, dl, dex, dey, dix, diy).finished();
}

}  // namespace

waypoint waypoint_at(std::int32_t index, std::int64_t s, std::int8_t control_mode, const Vector6& a_roe_m) {
  waypoint w{};
  w.index = index;
  w.control_mode = control_mode;
  w.gps_time_ns = at(s).ns;
  for (int k = 0; k < 6; ++k) w.a_roe_m[k] = a_roe_m(k);
  return w;
}

waypoint_table table_of(std::initializer_list<waypoint> waypoints) {
  waypoint_table table{};
  table.reference_semi_major_axis_m = kReferenceA;
  for (const waypoint& w : waypoints) table.waypoints[table.count++] = w;
  return table;
}

waypoint_table paper_waypoints() {
  constexpr std::int64_t kHour = 3600;
  return table_of(
      {waypoint_at(0, 0, 0, roe(-2000, -75000, 0, 0, 0, 0)),
       waypoint_at(1, 6 * kHour, 0, roe(-87, -50000, 0, 1000, 0, 1000)),
       waypoint_at(2, 12 * kHour, 0, roe(-70, -25000, 0, 500, 0, 500)),
       waypoint_at(3, 18 * kHour, 0, roe(-17, -5000, 0, 500, 0, 500)),
       waypoint_at(4, 24 * kHour, 0, roe(0, -1000, 0, 30, 0, 30)),
       waypoint_at(5, 28 * kHour, 0, roe(0, -600, 0, 18, 0, 18)),
       waypoint_at(6, 32 * kHour, 0, roe(0, -200, 0, 6, 0, 6)), waypoint_at(7, 36 * kHour, 0, roe(0, -100, 0, 3, 0, 3)),
       waypoint_at(8, 39 * kHour, 1, roe(-0.5, -10, 0, 2, 0, 1)), waypoint_at(9, 40 * kHour, 1, roe(0, -7, 1, 0, 2, 0)),
       waypoint_at(10, 41 * kHour + 900, 1, roe(0, -8.5, 1, 0, 1, 0))});
}

gnc_configuration configuration() {
  return guidance::Management().configuration();
}

mode_command mode(std::int8_t number) {
  mode_command command{};
  command.mode = number;
  return command;
}

SmallWorld::SmallWorld(const Vector6& a_roe_m)
    : servicer_(state_of(kServicerMean)),
      target_(state_of(orbit::qns_from_roe(kServicerMean, a_roe_m / kReferenceA))) {}

void SmallWorld::advance_to(GpsTime time) {
  coast(servicer_, seconds(time - time_));
  coast(target_, seconds(time - time_));
  if (differential_drag != 0.0) {
    target_ = orbit::apply_impulse_rtn(target_, {0.0, differential_drag * seconds(time - time_), 0.0});
  }
  time_ = time;
}

void SmallWorld::add_a_da(double metres) {
  const double n = orbit::mean_motion(kReferenceA);
  target_ = orbit::apply_impulse_rtn(target_, {0.0, 0.5 * n * metres, 0.0});
}

void SmallWorld::apply(const Vector3& dv_rtn) {
  servicer_ = orbit::apply_impulse_rtn(servicer_, dv_rtn);
}

ideal_navigation SmallWorld::measurement() const {
  ideal_navigation message{};
  copy(servicer_.position_eci, message.servicer_position_eci);
  copy(servicer_.velocity_eci, message.servicer_velocity_eci);
  copy(target_.position_eci, message.target_position_eci);
  copy(target_.velocity_eci, message.target_velocity_eci);
  return message;
}

Vector6 SmallWorld::a_roe_m() const {
  return kReferenceA * orbit::roe_from_qns(mean_of(servicer_), mean_of(target_));
}

Answer Flight::step() {
  if (measures) send(world.measurement());
  for (; !reports_.empty(); reports_.pop_front()) EXPECT_EQ(article.deliver(reports_.front()), 0);
  const Answer answer = article.step(now, kStep);
  for (const Command& command : answer.commands) to_execute.push_back(command);
  now = now + kStep;
  execute_until(now);
  world.advance_to(now);
  return answer;
}

Answer Flight::fly_until(GpsTime until) {
  Answer answer;
  while (now < until) answer = step();
  return answer;
}

Answer Flight::arrive_at(GpsTime time) {
  const Answer answer = fly_until(time);
  execute_until(time + Duration{1});
  return answer;
}

void Flight::execute_until(GpsTime until) {
  for (; !to_execute.empty() && to_execute.front().time < until; to_execute.pop_front()) execute(to_execute.front());
}

void Flight::execute(const Command& command) {
  const double(&dv)[3] = command.message.dv_rtn;
  const Vector3 dv_rtn = thrust * Vector3(dv[0], dv[1], dv[2]);
  world.advance_to(command.time);
  world.apply(dv_rtn);
  executed_dv += dv_rtn.norm();
  ++executed;
  executed_maneuver report{};
  report.maneuver_id = command.message.maneuver_id;
  report.accepted = 1;
  copy(dv_rtn, report.dv_rtn);
  if (reports_maneuvers) reports_.push_back(packet_of(command.time, report, sequence_++));
}

Flight under_way() {
  Flight flight(kWaypoint0);
  flight.send(configuration());
  flight.send(paper_waypoints());
  flight.send(mode(1));
  flight.fly_until(at(3000));
  EXPECT_GT(flight.executed, 0);
  return flight;
}

std::vector<Bytes> without_health(std::vector<Bytes> packets) {
  std::erase_if(packets, [](const Bytes& packet) {
    const auto view = packets::parse_packet(packet);
    return !view.ok() || view.value().header.apid == packets::Apid::kTelemetryHealth ||
           view.value().header.apid == packets::Apid::kTelemetryEvent;
  });
  return packets;
}

}  // namespace vbar::fsw::gnc::test
