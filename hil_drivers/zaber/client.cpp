#include "hil_drivers/zaber/client.h"

#include <array>
#include <charconv>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "host_sim/io/byte_channel.h"

namespace vbar::zaber {
namespace {

struct Warning {
  std::string_view code, meaning;
  bool is_fault;
};
// Zaber, ASCII Protocol Manual, "Warning Flags".
constexpr std::array<Warning, 12> kWarnings{{{"FF", "critical system error", true},
                                             {"FS", "stalled and stopped", true},
                                             {"FD", "driver disabled", true},
                                             {"FQ", "encoder error", true},
                                             {"FE", "limit error", true},
                                             {"WR", "no reference position", false},
                                             {"WH", "not homed", false},
                                             {"WM", "displaced when stationary", false},
                                             {"WL", "unexpected limit trigger", false},
                                             {"WT", "temperature high", false},
                                             {"NI", "movement interrupted", false},
                                             {"NC", "moved by manual control", false}}};

const Warning* find(const std::string& code) {
  for (const Warning& warning : kWarnings)
    if (warning.code == code) return &warning;
  return nullptr;
}

std::unique_ptr<io::ByteChannel> open(const ClientSettings& settings) {
  const std::size_t colon = settings.line.rfind(':');
  if (settings.line.find('/') != std::string::npos || colon == std::string::npos)
    return io::open_serial(settings.line, settings.baud);
  return io::connect_tcp(settings.line.substr(0, colon), settings.line.substr(colon + 1),
                         io::Clock::now() + settings.answer_limit);
}

bool has_no_reference(const Message& reply) {
  return reply.warning == "WR" || reply.warning == "WH";
}

}  // namespace

std::string meaning_of(const std::string& warning) {
  const Warning* known = find(warning);
  return known == nullptr ? "warning " + warning : fmt::format("{} ({})", known->meaning, warning);
}

Client::Client(const ClientSettings& settings) : settings_(settings) {
  try {
    channel_ = open(settings);
  } catch (const io::ChannelError& error) {
    throw RailError(fmt::format("rails: {}", error.what()));
  }
  (void)command(0, "");
}

Client::~Client() = default;

void Client::fail(int axis, const std::string& problem) const {
  throw RailError(axis == 0 ? fmt::format("rails on {}: {}", settings_.line, problem)
                            : fmt::format("rails on {}, axis {}: {}", settings_.line, axis, problem));
}

std::string Client::next_line(io::Clock::time_point deadline) {
  while (true) {
    if (auto line = lines_.next()) return *line;
    const auto bytes = channel_->read(deadline);
    if (bytes.empty() && io::Clock::now() >= deadline) return {};
    lines_.append(bytes);
  }
}

Message Client::command(int axis, const std::string& text) {
  const Command command{settings_.device, axis, std::nullopt, text, true};
  const std::string line = encode(command) + "\n";
  const auto deadline = io::Clock::now() + settings_.answer_limit;
  const std::string shown = text.empty() ? "the question for its state" : "\"" + text + "\"";
  try {
    channel_->write({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, deadline);
    for (std::string received = next_line(deadline); !received.empty(); received = next_line(deadline)) {
      const Message reply = decode_message(received);
      // Alerts and information were not asked for; another device or axis answers somebody else.
      if (reply.kind != MessageKind::kReply || reply.device != settings_.device || reply.axis != axis) continue;
      if (reply.is_rejected) fail(axis, fmt::format("{} was rejected: {}", shown, reply.data));
      if (const Warning* warning = find(reply.warning); warning != nullptr && warning->is_fault)
        fail(axis, meaning_of(reply.warning));
      return reply;
    }
  } catch (const io::ChannelError& error) {
    fail(axis, error.what());
  } catch (const WireError& error) {
    fail(axis, error.what());
  }
  fail(axis, fmt::format("no answer to {} within {} ms", shown, settings_.answer_limit.count()));
}

Message Client::wait_until_idle(int axis) {
  using namespace std::chrono_literals;
  const auto deadline = io::Clock::now() + settings_.move_limit;
  for (std::chrono::milliseconds pause = 1ms;; pause = std::min(2 * pause, std::chrono::milliseconds(50))) {
    const Message reply = command(axis, "");
    if (!reply.is_busy) return reply;
    if (io::Clock::now() >= deadline) fail(axis, fmt::format("still moves after {} ms", settings_.move_limit.count()));
    std::this_thread::sleep_for(pause);
  }
}

void Client::home_if_needed(int axis) {
  if (!has_no_reference(wait_until_idle(axis))) return;
  (void)command(axis, "home");
  const Message reply = wait_until_idle(axis);
  if (has_no_reference(reply)) fail(axis, "homing did not end at the home sensor: " + meaning_of(reply.warning));
}

void Client::move_to_um(int axis, double um) {
  const auto target = std::llround(um / settings_.microstep_um);
  const auto below = std::max<long long>(0, target - std::llround(settings_.overshoot_um / settings_.microstep_um));
  for (const long long place : {below, target}) {
    (void)command(axis, fmt::format("move abs {}", place));
    (void)wait_until_idle(axis);
  }
  const double reached_um = position_um(axis);
  if (!(std::abs(reached_um - um) <= settings_.tolerance_um))
    fail(axis, fmt::format("stands at {:.1f} um in place of {:.1f} um", reached_um, um));
}

double Client::position_um(int axis) {
  const Message reply = command(axis, "get pos");
  std::int64_t microsteps = 0;
  const char* end = reply.data.data() + reply.data.size();
  const auto [stop, error] = std::from_chars(reply.data.data(), end, microsteps);
  if (error != std::errc() || stop != end)
    fail(axis, fmt::format("answers \"{}\" when asked for its place", wire::printable(reply.data)));
  return static_cast<double>(microsteps) * settings_.microstep_um;
}

void Client::check_held_at_um(int axis, double um) {
  const Message state = command(axis, "");
  if (state.is_busy) fail(axis, "moves during the run");
  if (state.warning != "--") fail(axis, meaning_of(state.warning));
  const double found_um = position_um(axis);
  if (!(std::abs(found_um - um) <= settings_.tolerance_um))
    fail(axis, fmt::format("stands at {:.1f} um in place of {:.1f} um", found_um, um));
}

void Client::stop() {
  (void)command(0, "stop");
}

}  // namespace vbar::zaber
