#include "hil_drivers/tron/protocols/rsi_client.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>
#include <poll.h>

#include "hil_drivers/tron/protocols/kuka_xml.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"

namespace vbar::tron::rsi {

namespace {

/// Rounding relative to a limit of speed or acceleration; a path planned to the limit is accepted.
constexpr double kRounding = 1e-6;
/// Absolute: positions of some radians, differenced twice over 4 ms, carry this much rounding of their own.
constexpr double kSpeedRounding = 1e-11;
constexpr double kAccelerationRounding = 1e-9;

struct AxisHistory {
  double zero, before_last, last, command;
};

struct AxisUnits {
  double wire_per_si;  ///< deg per rad, mm per m
  std::string_view wire, speed, acceleration;
};
constexpr AxisUnits kTurning{kDegreesPerRadian, "deg", "deg/s", "deg/s2"};
constexpr AxisUnits kSliding{kMillimetresPerMetre, "mm", "mm/s", "mm/s2"};

/// Comparisons are written so that a NaN is rejected.
std::string problem_of(const AxisHistory& axis, const CommandLimits& limits, const AxisUnits& units) {
  const double scale = units.wire_per_si;
  const double speed = (axis.command - axis.last) / kCycle_s;
  const double acceleration = (axis.command - 2.0 * axis.last + axis.before_last) / (kCycle_s * kCycle_s);
  const double correction = (axis.command - axis.zero) * scale;
  // An axis that stands beyond its range, by no fault of the command, may move back.
  const bool is_inside = (axis.command >= limits.lower || axis.command >= axis.last) &&
                         (axis.command <= limits.upper || axis.command <= axis.last);
  if (!std::isfinite(axis.command) || !is_inside)
    return fmt::format("position {:.4f} {}; accepted: {:.4f} to {:.4f}", axis.command * scale, units.wire,
                       limits.lower * scale, limits.upper * scale);
  if (!(correction >= limits.correction.lower && correction <= limits.correction.upper))
    return fmt::format("correction {:.4f} {}; accepted: {:.4f} to {:.4f}", correction, units.wire,
                       limits.correction.lower, limits.correction.upper);
  if (!(std::abs(speed) <= limits.speed * (1.0 + kRounding) + kSpeedRounding))
    return fmt::format("speed {:.4f} {}; accepted: up to {:.4f}", speed * scale, units.speed, limits.speed * scale);
  if (!(std::abs(acceleration) <= limits.acceleration * (1.0 + kRounding) + kAccelerationRounding))
    return fmt::format("acceleration {:.4f} {}; accepted: up to {:.4f}", acceleration * scale, units.acceleration,
                       limits.acceleration * scale);
  return {};
}

}  // namespace

void CommandCheck::begin(const AxisPositions& zero) {
  zero_ = last_ = before_last_ = zero;
}

std::string CommandCheck::advance(const AxisPositions& command) {
  for (std::size_t k = 0; k < kWireAxes; ++k) {
    const auto axis = static_cast<int>(k);
    const AxisHistory history{zero_.axes_rad[axis], before_last_.axes_rad[axis], last_.axes_rad[axis],
                              command.axes_rad[axis]};
    if (const std::string problem = problem_of(history, axes_[k], kTurning); !problem.empty())
      return fmt::format("{}: {}", xml::kAxisNames[k], problem);
  }
  if (track_) {
    const AxisHistory history{zero_.track_m, before_last_.track_m, last_.track_m, command.track_m};
    if (const std::string problem = problem_of(history, *track_, kSliding); !problem.empty()) return "E1: " + problem;
  }
  before_last_ = last_;
  last_ = command;
  return {};
}

namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;
using WallClock = std::chrono::steady_clock;

CommandLimits limits_of(const AxisLimits& axis, const CorrectionRange& correction, double zero) {
  return {axis.lower - zero, axis.upper - zero, axis.speed, axis.acceleration, correction};
}

}  // namespace

ClientSettings client_settings(const std::string& name, const Robot& robot, const Track* track,
                               const RobotFiles& files) {
  ClientSettings settings{name, robot.line.address, robot.line.rsi_port, files.ethernet, {}, std::nullopt};
  for (std::size_t k = 0; k < kWireAxes; ++k)
    settings.axes[k] = limits_of(robot.design.axes[k], files.context.axes[k], 0.0);
  if (track != nullptr) {
    if (!files.context.track) throw RsiError(name + ": the RSI context has no correction of E1, the track");
    settings.track = limits_of(track->axis, *files.context.track, track->home_m);
  }
  return settings;
}

struct Client::Line {
  explicit Line(const ClientSettings& given)
      : settings(given),
        socket(context),
        decoder(given.ethernet),
        check(given.axes, given.track),
        buffer(kMaxDatagramBytes + 1) {
    error_code error;
    const auto robot = asio::ip::make_address_v4(settings.robot_address, error);
    if (error) fail(fmt::format("'{}' is not an IPv4 address", settings.robot_address));
    robot_address = robot;
    const auto local = robot.is_loopback() ? asio::ip::address_v4::loopback() : asio::ip::address_v4::any();
    socket.open(udp::v4(), error);
    if (!error) socket.bind(udp::endpoint(local, settings.port), error);
    if (!error) socket.non_blocking(true, error);
    if (error) fail(fmt::format("UDP port {} is not available: {}", settings.port, error.message()));
    description = fmt::format("{} at RSI port {}", settings.name, socket.local_endpoint().port());
    sen.type = settings.ethernet.sen_type;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw RsiError(fmt::format("{}: {}", description.empty() ? settings.name : description, problem));
  }

  /// False: nothing has arrived.
  bool take_datagram() {
    error_code error;
    const std::size_t count = socket.receive_from(asio::buffer(buffer), sender, 0, error);
    if (error == asio::error::would_block) return false;
    // A controller whose socket is closed reports itself here.
    if (error && error != asio::error::connection_refused) fail(error.message());
    if (!error) read({reinterpret_cast<const char*>(buffer.data()), count});
    return true;
  }

  void read(std::string_view datagram) {
    if (sender.address() != robot_address) {
      ++foreign;
      return;
    }
    if (!decoder.decode(datagram, received)) {
      ++unreadable;
      last_problem = decoder.problem();
      return;
    }
    if (has_rob) ++skipped;
    std::swap(rob, received);
    has_rob = true;
    peer = sender;
  }

  void wait(WallClock::time_point deadline) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - WallClock::now()).count();
    pollfd descriptor{socket.native_handle(), POLLIN, 0};
    (void)::poll(&descriptor, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 3'600'000)));
  }

  State state_of_rob() {
    State state;
    state.measured.axes_rad = to_radians(rob.axes_deg);
    if (settings.track) state.measured.track_m = rob.external_mm[0] / kMillimetresPerMetre;
    state.delay = rob.delay;
    state.cycle = cycles;
    state.skipped = skipped;
    if (cycles == 0) {
      check.begin(state.measured);
    } else {
      state.ipoc_not_newer = !(rob.ipoc.value > last_ipoc);
      delayed_in_row = rob.delay > last_delay ? delayed_in_row + 1 : 0;
    }
    state.delayed_in_row = delayed_in_row;
    last_ipoc = rob.ipoc.value;
    last_delay = rob.delay;
    ++cycles;
    return state;
  }

  void send(const AxisPositions& command, bool stop) {
    const SixValues correction = to_degrees(command.axes_rad - check.zero().axes_rad);
    for (std::size_t k = 0; k < kWireAxes; ++k) sen.axes_deg[k] = correction[k];
    if (settings.track) sen.track_mm = (command.track_m - check.zero().track_m) * kMillimetresPerMetre;
    if (!settings.ethernet.stop_element.empty()) sen.stop = stop;
    sen.ipoc = rob.ipoc.text;
    if (!encode(sen, settings.ethernet, answer)) fail("the answer cannot be encoded");
    error_code ignored;  // an answer that the system does not take is lost, and the controller counts it
    socket.send_to(asio::buffer(answer), peer, 0, ignored);
    has_rob = false;
  }

  void require_state() const {
    if (!has_rob) fail("an answer without a state that waits for one");
  }

  ClientSettings settings;
  asio::io_context context;
  udp::socket socket;
  asio::ip::address_v4 robot_address;
  udp::endpoint sender, peer;
  Decoder decoder;
  CommandCheck check;
  std::vector<std::uint8_t> buffer;
  std::string description, last_problem, answer;
  Rob rob, received;
  Sen sen;
  bool has_rob = false;  ///< `rob` waits for an answer
  std::uint64_t cycles = 0, skipped = 0, foreign = 0, unreadable = 0, last_ipoc = 0, last_delay = 0;
  int delayed_in_row = 0;
};

Client::Client(const ClientSettings& settings) : line_(std::make_unique<Line>(settings)) {}

Client::~Client() = default;

std::optional<State> Client::receive(std::chrono::milliseconds patience) {
  const auto deadline = WallClock::now() + patience;
  line_->has_rob = false;
  for (bool overdue = false; !overdue;) {
    overdue = WallClock::now() >= deadline;
    // As many as a flood may hold the caller for.
    for (int count = 0; count < 256 && line_->take_datagram(); ++count) {
    }
    if (line_->has_rob) return line_->state_of_rob();
    if (!overdue) line_->wait(deadline);
  }
  return std::nullopt;
}

void Client::answer(const AxisPositions& command) {
  line_->require_state();
  if (const std::string problem = line_->check.advance(command); !problem.empty())
    throw CommandRefused(fmt::format("{}: command refused: {}", line_->description, problem));
  line_->send(command, false);
}

void Client::answer_stop() {
  line_->require_state();
  line_->send(line_->check.last(), true);
}

void Client::restart() {
  for (int count = 0; count < 4096 && line_->take_datagram(); ++count) {
  }
  line_->has_rob = false;
  line_->cycles = line_->skipped = 0;
  line_->delayed_in_row = 0;
}

const AxisPositions& Client::zero() const {
  return line_->check.zero();
}

const AxisPositions& Client::last_command() const {
  return line_->check.last();
}

std::uint16_t Client::port() const {
  return line_->socket.local_endpoint().port();
}

const std::string& Client::description() const {
  return line_->description;
}

std::uint64_t Client::foreign_datagrams() const {
  return line_->foreign;
}

std::uint64_t Client::unreadable_datagrams() const {
  return line_->unreadable;
}

const std::string& Client::last_problem() const {
  return line_->last_problem;
}

const ClientSettings& Client::settings() const {
  return line_->settings;
}

}  // namespace vbar::tron::rsi
