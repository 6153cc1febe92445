#include "pil_bridge/remote_computer.h"

#include <algorithm>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include "boards/common/flight_executive.h"
#include "fsw/packets/messages.h"
#include "pil_bridge/qemu.h"

namespace vbar::pil {

namespace {

/// Time after which an unanswered question is repeated: question or answer was lost on the link.
constexpr std::chrono::milliseconds kAnswerLimit{100};
/// Between two questions: an emulated board needs the time to receive.
constexpr std::chrono::microseconds kBetweenQuestions{500};

/// A flight computer that is slow, because the computer it runs on is busy, is waited for: bytes are missing if it has
/// answered that often since the last ones arrived.
constexpr int kMinAnswers = 20;
/// One that does not answer is not waited for longer than this number of limits.
constexpr int kSilenceLimits = 5;

}  // namespace

WiredBytes::WiredBytes(io::WiredReceiver receiver, std::chrono::milliseconds limit)
    : receiver_(std::move(receiver)),
      under_way_(receiver_.in_lock_step ? receiver_.device : std::string()),
      limit_(limit),
      sent_before_(receiver_.bytes_sent ? receiver_.bytes_sent() : std::uint64_t{0}) {}

void WiredBytes::wait(const AskCount& ask) {
  if (!receiver_.in_lock_step) return;
  Clock::time_point last_answer = Clock::now();
  Clock::time_point last_progress = last_answer;
  for (int answers = 0;;) {
    // Before the question: what had left the terminal by then is included in the answer.
    const bool is_empty = under_way_.is_empty();
    if (const auto count = ask(Clock::now() + kAnswerLimit)) {
      last_answer = Clock::now();
      ++answers;
      if (*count != arrived_) {
        arrived_ = *count;
        last_progress = last_answer;
        answers = 0;
      }
      if (is_empty && difference() <= missing_) break;
    }
    const Clock::time_point now = Clock::now();
    const bool is_stuck = now - last_progress >= limit_ && answers >= kMinAnswers;
    if (is_stuck || now - last_answer >= kSilenceLimits * limit_) {
      ++statistics_.timeouts;
      statistics_.missing += static_cast<std::uint64_t>(std::max<std::int64_t>(difference() - missing_, 0));
      break;
    }
    std::this_thread::sleep_for(kBetweenQuestions);
  }
  missing_ = difference();
}

std::int64_t WiredBytes::difference() const {
  if (!receiver_.bytes_sent) return 0;
  return static_cast<std::int64_t>(receiver_.bytes_sent() - sent_before_) - static_cast<std::int64_t>(arrived_);
}

std::optional<Packet> WiredBytes::take(const Packet& packet) {
  const auto view = fsw::packets::parse_packet(packet);
  if (!view.ok() || view.value().header.apid != fsw::packets::Apid::kWiredBytes) return std::nullopt;
  const auto wired = fsw::packets::decode<vbar::wired_bytes>(view.value());
  if (!wired.ok()) throw LinkError("the flight computer sent a wired_bytes that is not one of this version");
  const vbar::wired_bytes& mirror = wired.value();
  if (mirror.count < 1 || mirror.count > static_cast<std::int32_t>(sizeof mirror.data) || mirror.dropped < 0) {
    throw LinkError("the flight computer sent a wired_bytes with " + std::to_string(mirror.count) + " bytes, " +
                    std::to_string(mirror.dropped) + " dropped");
  }
  statistics_.bytes += static_cast<std::uint64_t>(mirror.count);
  statistics_.dropped = static_cast<std::uint64_t>(mirror.dropped);
  vbar::gnss_bytes input{};
  static_assert(sizeof input.data == sizeof mirror.data);
  input.count = mirror.count;
  std::copy_n(mirror.data, sizeof mirror.data, input.data);
  Packet bytes(fsw::packets::kMaxPacketBytes);
  bytes.resize(fsw::packets::encode(view.value().header, input, bytes).value());  // integers only: cannot fail
  return bytes;
}

namespace {

using boards::CounterUnit;

constexpr double kBitsPerByte = 10.0;  // 8N1

/// A process whose line broke is about to end: time to obtain its exit status before it is terminated.
constexpr std::chrono::milliseconds kExplainPatience{300};
/// Wait for the process to end after a goodbye; then after a SIGTERM.
constexpr std::chrono::milliseconds kGoodbyePatience{2000};
constexpr std::chrono::milliseconds kTerminatePatience{500};

std::uint32_t draw_session() {
  std::random_device device;
  return device();
}

std::string budget_text(std::uint64_t budget, const char* unit) {
  return budget == 0 ? "" : "; the budget of a step is " + std::to_string(budget) + " " + unit;
}

std::uint64_t counter(std::int64_t value) {
  return value > 0 ? static_cast<std::uint64_t>(value) : 0;
}

/// Patience for a line that needs longer than that for the frames between two acknowledgements.
BarrierTiming with_line(BarrierTiming timing, double line_bits_per_s) {
  if (line_bits_per_s <= 0.0) return timing;
  constexpr double kWindowBits = fsw::link::kWindow * fsw::link::kMaxCobsFrameBytes * kBitsPerByte;
  timing.give_up_after += std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * kWindowBits / line_bits_per_s));
  return timing;
}

/// Several lines joined to one, for an error message.
std::string on_one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 3) text.replace(at, 1, " | ");
  return text;
}

}  // namespace

double computing_time(double exchange_s, double waited_s, std::uint64_t bytes, double line_bits_per_s) {
  const double wire_s = static_cast<double>(bytes) * kBitsPerByte / line_bits_per_s;
  const double computing_s = line_bits_per_s > 0.0 ? exchange_s - wire_s : waited_s;
  return std::clamp(computing_s, 0.0, exchange_s);
}

RemoteComputer::RemoteComputer(RemoteParts parts)
    : parts_(std::move(parts)),
      barrier_(*parts_.transport, draw_session(), with_line(parts_.timing, parts_.line_bits_per_s),
               [this] { check_process(); }) {
  try {
    board_name_ = barrier_.connect(parts_.spacecraft, parts_.receiver ? parts_.receiver->baud : 0U, board_budget());
  } catch (const LinkError& error) {
    fail("while starting", error.what());
  }
  if (parts_.receiver) wired_.emplace(*parts_.receiver, parts_.timing.wired_limit);
}

StepResult RemoteComputer::step(std::uint32_t step, std::span<const Packet> packets) {
  if (!failure_.empty()) throw FlightComputerError(failure_);
  if (closed_) throw FlightComputerError(parts_.role + " " + parts_.name + " is closed");
  StepResult result;
  std::uint64_t bytes_before = line_bytes();
  try {
    if (wired_) wired_->wait([this](Clock::time_point deadline) { return barrier_.receiver_count(deadline); });
    bytes_before = line_bytes();
    const auto start = Clock::now();
    result.packets = barrier_.exchange(step, packets);
    const double exchange_s = std::chrono::duration<double>(Clock::now() - start).count();
    result.compute_wall_s = computing_time(exchange_s, std::chrono::duration<double>(barrier_.waited()).count(),
                                           line_bytes() - bytes_before, parts_.line_bits_per_s);
    sort_answer(result);
    check_budget(result.report);
  } catch (const SessionLost& lost) {
    fail("at step " + std::to_string(step), lost.what() + budget_text(parts_.step_budget, count_unit()));
  } catch (const LinkError& error) {
    fail("at step " + std::to_string(step), error.what() + line_text(line_bytes() - bytes_before));
  }
  return result;
}

std::vector<std::uint8_t> RemoteComputer::snapshot() {
  try {
    return barrier_.read_snapshot();
  } catch (const LinkError& error) {
    fail("while its snapshot was read", error.what());
  }
}

void RemoteComputer::restore(std::span<const std::uint8_t> snapshot) {
  try {
    if (const std::int32_t status = barrier_.write_snapshot(snapshot); status != 0)
      throw FlightComputerError(parts_.role + " " + description() + " refused the snapshot: status " +
                                std::to_string(status));
  } catch (const LinkError& error) {
    fail("while it was given a snapshot", error.what());
  }
}

void RemoteComputer::check_budget(const StepReport& report) const {
  if (parts_.step_budget == 0 || report.unit != count_unit() || report.count <= parts_.step_budget) return;
  throw LinkError("the step took " + std::to_string(report.count) + " " + report.unit + ", and its budget is " +
                  std::to_string(parts_.step_budget));
}

std::uint64_t RemoteComputer::line_bytes() const {
  const TransportCounters line = parts_.transport->counters();
  return line.bytes_sent + line.bytes_received;
}

std::string RemoteComputer::line_text(std::uint64_t bytes) const {
  if (parts_.line_bits_per_s <= 0.0) return "";
  const auto seconds = static_cast<std::int64_t>(static_cast<double>(bytes) * kBitsPerByte / parts_.line_bits_per_s);
  return "; the line carries " + std::to_string(static_cast<std::int64_t>(parts_.line_bits_per_s)) +
         " baud, at which the " + std::to_string(bytes) + " bytes of this exchange take " + std::to_string(seconds) +
         " s";
}

void RemoteComputer::sort_answer(StepResult& result) {
  const std::uint32_t dropped_before = packets_dropped_;
  std::erase_if(result.packets, [&](const Packet& packet) {
    if (take_step_report(packet, result.report)) return true;
    auto input = wired_ ? wired_->take(packet) : std::nullopt;
    if (input) result.wired.push_back(std::move(*input));
    return input.has_value();
  });
  result.trouble.packets_dropped = packets_dropped_ - std::min(dropped_before, packets_dropped_);
}

LinkStatistics RemoteComputer::statistics() const {
  const BarrierCounters host = barrier_.counters();
  const TransportCounters line = parts_.transport->counters();
  return {.bytes_sent = line.bytes_sent,
          .bytes_received = line.bytes_received,
          .frames_resent = host.frames_resent + board_counters_.frames_resent,
          .frames_rejected = host.frames_rejected + line.frames_rejected + board_counters_.frames_rejected,
          .frames_duplicated = host.frames_duplicated + board_counters_.frames_duplicated,
          .strangers_ignored = line.foreign_datagrams,
          .polls = host.polls,
          .wired = wired_ ? wired_->statistics() : WiredStatistics{}};
}

void RemoteComputer::close() {
  if (std::exchange(closed_, true) || !failure_.empty()) return;
  try {
    barrier_.goodbye();
  } catch (const LinkError&) {
    // Has ended already.
  }
  if (!parts_.process) return;
  if (!parts_.process->wait_for_end(kGoodbyePatience)) parts_.process->terminate(kTerminatePatience);
}

void RemoteComputer::fail(const std::string& when, const std::string& cause) {
  failure_ = parts_.role + " " + parts_.name + " failed " + when + ": " + cause;
  if (parts_.process) {
    io::ChildProcess& process = *parts_.process;
    if (process.wait_for_end(kExplainPatience)) {
      failure_ += "; " + process.program() + ": " + process.status_text();
    } else {
      failure_ += "; " + process.program() + " was still running and has been ended";
      process.terminate(kTerminatePatience);
    }
    const std::string output = on_one_line(process.output_tail());
    if (!output.empty()) failure_ += "; its last output: " + output;
  }
  throw FlightComputerError(failure_);
}

std::uint64_t RemoteComputer::board_budget() const {
  if (!parts_.icount_shift) return parts_.step_budget;
  return ticks_of_instructions(parts_.step_budget, *parts_.icount_shift);
}

void RemoteComputer::check_process() const {
  if (parts_.process && parts_.process->has_ended()) throw LinkError("its process has ended");
}

bool RemoteComputer::take_step_report(const Packet& packet, StepReport& report) {
  const auto view = fsw::packets::parse_packet(packet);
  if (!view.ok() || view.value().header.apid != fsw::packets::Apid::kStepReport) return false;
  const auto message = fsw::packets::decode<vbar::step_report>(view.value());
  if (!message.ok()) return false;
  const vbar::step_report& told = message.value();
  report.present = true;
  report.stack_bytes = static_cast<std::uint32_t>(counter(told.stack_bytes));
  if (told.unit == static_cast<std::int8_t>(CounterUnit::kCycles)) {
    report.unit = "cycles";
    report.count = counter(told.count);
  } else if (told.unit == static_cast<std::int8_t>(CounterUnit::kEmulatedTimerTicks) && parts_.icount_shift) {
    report.unit = "instructions";
    report.count = instructions_of_ticks(counter(told.count), *parts_.icount_shift);
  }
  packets_dropped_ = static_cast<std::uint32_t>(counter(told.packets_dropped));
  board_counters_.frames_resent = counter(told.frames_resent);
  board_counters_.frames_rejected = counter(told.frames_rejected);
  board_counters_.frames_duplicated = counter(told.frames_duplicated);
  return true;
}

}  // namespace vbar::pil
