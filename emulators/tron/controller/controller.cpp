#include "emulators/tron/controller/controller.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "emulators/tron/controller/controller_core.h"

namespace vbar::tron::bench {

namespace {

std::array<AxisLimits, kServoAxes> limits_of(const ControllerSettings& settings) {
  std::array<AxisLimits, kServoAxes> limits{};
  std::copy(settings.robot.design.axes.begin(), settings.robot.design.axes.end(), limits.begin());
  if (!settings.track) return limits;
  limits[kTrackAxis] = settings.track->axis;
  limits[kTrackAxis].lower -= settings.track->home_m;
  limits[kTrackAxis].upper -= settings.track->home_m;
  return limits;
}

AxisArray home_of(const ControllerSettings& settings) {
  AxisArray home{};
  std::copy(settings.robot.home_rad.begin(), settings.robot.home_rad.end(), home.begin());
  return home;
}

/// Assumed, of the size of the manufacturer's figures: an arm at full speed stands after 0.3 s.
constexpr double kStoppingTime_s = 0.3;

AxisArray decelerations_of(const ControllerSettings& settings) {
  AxisArray decelerations{};
  const auto limits = limits_of(settings);
  for (std::size_t k = 0; k < kServoAxes; ++k) decelerations[k] = limits[k].speed / kStoppingTime_s;
  return decelerations;
}

}  // namespace

Controller::Core::Core(boost::asio::io_context& context, ControllerSettings given)
    : settings(std::move(given)),
      servo(home_of(settings), decelerations_of(settings), rsi::kCycle_s),
      monitor(limits_of(settings), rsi::kCycle_s),
      correction(settings.ethernet, settings.context),
      link(context, settings.ethernet, settings.robot.line.address, settings.context.precision,
           [this] {
             if (on_datagram) on_datagram();
           }),
      server(context, settings.robot.line.address, settings.eki_port,
             [this](const eki::Command& command) {
               eki::Reply reply = handle(command);
               announced = state();  // the reply says it
               return reply;
             }),
      ipoc(settings.first_ipoc) {
  if (!settings.flange_pose) throw std::logic_error(settings.name + ": no forward kinematics");
  if (settings.track && !settings.context.track)
    throw std::runtime_error(settings.name + ": the RSI context has no correction of E1, the track");
  measured = to_positions(servo.position());
  announced = state();
}

void Controller::Core::move() {
  ++cycles;
  ipoc += rsi::kCycle_ms;
  sent_in_cycle = false;
  if (rsi_on && !is_first_cycle)
    take_answer();
  else
    servo.brake();
  measured = to_positions(servo.position());
  notice_standstill();
  announce();
}

void Controller::Core::take_answer() {
  ++statistics.cycles;
  const rsi::Sen* answer = link.end_cycle();
  if (lost_answers > 0) {
    --lost_answers;
    answer = nullptr;
  }
  correction.take(answer);
  count_answer(answer != nullptr);
  if (missing_in_row >= settings.context.timeout_cycles) {
    stop_with(fmt::format("RSITimeout: {} cycles in a row without a valid answer", missing_in_row));
  } else if (correction.stop_rises()) {
    end_rsi();
    message = "RSI ended by the stop signal";
  } else if (!correction.beyond_monitor().empty()) {
    stop_with("KSS29000: overall correction of " + correction.beyond_monitor());
  } else {
    return follow(answer != nullptr);
  }
  servo.brake();
}

void Controller::Core::count_answer(bool is_valid) {
  const AnswerCounts& counts = link.counts();
  statistics.bad_answers = counts.bad;
  statistics.repeated_answers = counts.repeated;
  statistics.answers_within_1ms = counts.within_1ms;
  statistics.max_answer_time_s = counts.max_time_s;
  statistics.last_bad_answer = counts.last_bad;
  if (correction.was_clamped()) ++statistics.clamps;
  if (is_valid) {
    ++statistics.answers;
    missing_in_row = 0;
    return;
  }
  ++statistics.cycles_without_answer;
  ++missing_in_row;
  ++delay;
}

void Controller::Core::follow(bool has_answer) {
  if (has_answer) {
    const std::string problem = monitor.judge(correction.command(), cycles_since_answer);
    statistics.max_speed = monitor.max_speed();
    statistics.max_acceleration = monitor.max_acceleration();
    if (!problem.empty()) {
      trip(problem);
      return servo.brake();
    }
  }
  cycles_since_answer = has_answer ? 1 : cycles_since_answer + 1;
  servo.follow(correction.command());
}

void Controller::Core::notice_standstill() {
  const bool stands = servo.stands();
  if (stands && !stood && on_standstill) standstill_error = on_standstill();
  stood = stands;
}

rsi::Rob Controller::Core::rob() const {
  const AxisPositions& positions = reported();
  rsi::Rob rob;
  rob.cartesian = settings.flange_pose(positions);
  rob.axes_deg = rsi::to_degrees(positions.axes_rad);
  rob.external_mm[0] = positions.track_m * rsi::kMillimetresPerMetre;
  rob.cartesian_setpoint = cartesian_setpoint;
  rob.axes_setpoint_deg = axes_setpoint_deg;
  rob.delay = delay;
  rob.ipoc = {std::to_string(ipoc), ipoc};
  return rob;
}

void Controller::Core::send_state() {
  if (!rsi_on || sent_in_cycle) return;
  is_first_cycle = false;
  if (silent_cycles > 0) {
    --silent_cycles;
    return;
  }
  link.send(rob());
  sent_in_cycle = true;
}

eki::State Controller::Core::state() const {
  return {0, cycles * rsi::kCycle_ms, drives_on, emergency_stop, rsi_on, stopped, message};
}

eki::RobotState Controller::Core::pose() const {
  const AxisPositions& positions = reported();
  return {0, cycles * rsi::kCycle_ms, settings.flange_pose(positions), rsi::to_degrees(positions.axes_rad),
          positions.track_m * rsi::kMillimetresPerMetre};
}

void Controller::Core::announce() {
  eki::State now = state();
  now.time_ms = announced.time_ms;
  if (now == announced) return;
  announced = state();
  server.send(announced);
}

eki::Reply Controller::Core::handle(const eki::Command& command) {
  if (command.action == eki::Action::kPose) {
    eki::RobotState reply = pose();
    reply.seq = command.seq;
    return reply;
  }
  std::string problem;
  if (command.action == eki::Action::kStart) problem = start_problem();
  if (command.action == eki::Action::kReset) problem = reset();
  if (command.action == eki::Action::kStop) end_rsi();
  if (command.action == eki::Action::kStart && problem.empty()) start_rsi();
  eki::State reply = state();
  reply.seq = command.seq;
  if (!problem.empty()) reply.message = problem;
  return reply;
}

std::string Controller::Core::start_problem() const {
  if (emergency_stop) return "start refused: emergency stop";
  if (stopped) return "start refused: not acknowledged: " + message;
  if (!drives_on) return "start refused: drives off";
  if (rsi_on) return "start refused: RSI is on";
  if (!servo.stands()) return "start refused: the axes move";
  return {};
}

void Controller::Core::start_rsi() {
  rsi_on = is_first_cycle = true;
  message.clear();
  correction.begin(servo.command());
  monitor.begin(servo.command());
  cartesian_setpoint = settings.flange_pose(reported());
  axes_setpoint_deg = rsi::to_degrees(reported().axes_rad);
  delay = silent_cycles = lost_answers = 0;
  missing_in_row = 0;
  cycles_since_answer = 1;
  ++statistics.rsi_starts;
  if (on_rsi_start) on_rsi_start();
}

void Controller::Core::end_rsi() {
  if (!rsi_on) return;
  rsi_on = false;
  (void)link.end_cycle();
  if (on_datagram) on_datagram();  // the clock waits for this robot no more
}

void Controller::Core::stop_with(const std::string& text) {
  end_rsi();
  // The first message is the cause of those that follow.
  if (!stopped) message = text;
  stopped = true;
}

void Controller::Core::trip(const std::string& text) {
  ++statistics.limit_trips;
  drives_on = false;
  stop_with(text);
}

std::string Controller::Core::reset() {
  if (emergency_stop) return "reset refused: emergency stop";
  stopped = false;
  message.clear();
  drives_on = true;
  return {};
}

Controller::Controller(boost::asio::io_context& context, ControllerSettings settings)
    : core_(std::make_unique<Core>(context, std::move(settings))) {}

Controller::~Controller() = default;

AxisPositions Controller::position() const {
  return core_->measured;
}

AxisPositions Controller::true_position() const {
  AxisPositions positions = core_->measured;
  positions.axes_rad += core_->standstill_error.axes_rad;
  positions.track_m += core_->standstill_error.track_m;
  return positions;
}

void Controller::on_standstill(std::function<AxisPositions()> errors) {
  core_->on_standstill = std::move(errors);
}

bool Controller::stands() const {
  return core_->servo.stands();
}

void Controller::set_emergency_stop(bool is_pressed) {
  core_->emergency_stop = is_pressed;
  if (is_pressed) {
    core_->drives_on = false;
    core_->stop_with("emergency stop");
  }
  core_->announce();
}

void Controller::switch_drives_off(const std::string& message) {
  core_->drives_on = false;
  core_->stop_with(message);
  core_->announce();
}

void Controller::set_frozen(bool is_frozen) {
  core_->frozen = core_->measured;
  core_->is_frozen = is_frozen;
}

void Controller::be_silent(std::uint64_t cycles) {
  core_->silent_cycles = cycles;
}

void Controller::lose_answers(std::uint64_t cycles) {
  core_->lost_answers = cycles;
}

void Controller::set_ipoc_back(std::uint64_t milliseconds) {
  core_->ipoc -= std::min(core_->ipoc, milliseconds);
}

void Controller::drop_rsi() {
  if (!core_->rsi_on) return;
  core_->stop_with("RSIBad: the connection is interrupted");
  core_->announce();
}

eki::Reply Controller::execute(const eki::Command& command) {
  eki::Reply reply = core_->handle(command);
  core_->announce();
  return reply;
}

bool Controller::rsi_is_on() const {
  return core_->rsi_on;
}

eki::State Controller::state() const {
  return core_->state();
}

std::uint16_t Controller::eki_port() const {
  return core_->server.port();
}

const ControllerStatistics& Controller::statistics() const {
  return core_->statistics;
}

const ControllerSettings& Controller::settings() const {
  return core_->settings;
}

}  // namespace vbar::tron::bench
