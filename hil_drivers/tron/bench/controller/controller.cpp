#include "hil_drivers/tron/bench/controller/controller.h"

#include <algorithm>
#include <utility>

#include "hil_drivers/tron/bench/controller/controller_core.h"

namespace vbar::tron::bench {

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
