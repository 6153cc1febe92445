#include "hil_drivers/grand/receiver_port.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand {

namespace {

// Longest text of a refusal; what is longer is not an answer.
constexpr std::size_t kLongestError = 200;

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};  // char may alias anything
}

bool is_printable(char c) {
  return c >= ' ' && c <= '~';
}

}  // namespace

std::optional<CommandAnswer> find_answer(std::span<const std::uint8_t> bytes) {
  const std::string_view text = as_text(bytes);
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at + 1)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<OK")) return CommandAnswer{true, "<OK"};
    if (!rest.starts_with("<ERROR:")) continue;
    const std::size_t end = rest.find_first_of("\r\n");
    if (end == std::string_view::npos || end > kLongestError) continue;
    const std::string_view line = rest.substr(0, end);
    if (std::ranges::all_of(line, is_printable)) return CommandAnswer{false, std::string(line)};
  }
  return std::nullopt;
}

std::optional<std::string> find_prompt(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::string_view, 3> kPortKinds{"[COM", "[USB", "[ICOM"};
  const std::string_view text = as_text(bytes);
  std::optional<std::string> found;
  for (std::size_t at = text.find('['); at != std::string_view::npos; at = text.find('[', at + 1)) {
    const std::string_view rest = text.substr(at);
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos || end > 6) continue;
    const auto is_kind = [&](std::string_view kind) { return rest.starts_with(kind); };
    if (std::ranges::any_of(kPortKinds, is_kind)) found = std::string(rest.substr(1, end - 1));
  }
  return found;
}

std::string printable(std::span<const std::uint8_t> bytes, std::size_t limit) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min(limit, bytes.size()))) {
    if (is_printable(static_cast<char>(byte))) {
      text += static_cast<char>(byte);
    } else {
      text += fmt::format("\\x{:02x}", byte);
    }
  }
  if (bytes.size() > limit) text += "...";
  return text;
}

namespace {

// RANGE first and TIME last: a burst is complete with its TIME log.
void add_logs(const std::string& port, const ReceiverConfiguration& configuration, std::vector<std::string>& commands) {
  const auto periodic = [&](const char* log) {
    commands.push_back(
        fmt::format("LOG {} {} ONTIME {:g} {:g}", port, log, configuration.period_s, configuration.log_offset_s));
  };
  periodic("RANGEB");
  for (const char* const log : {"RAWEPHEMB", "GALEPHEMERISB", "BDSEPHEMERISB", "IONUTCB"})
    commands.push_back(fmt::format("LOG {} {} ONCHANGED", port, log));
  periodic("BESTXYZB");
  periodic("TIMEB");
}

}  // namespace

std::vector<unsigned> rates_to_ask(unsigned configured) {
  constexpr std::array<unsigned, 9> kFactoryFirst{9600, 115200, 230400, 460800, 57600, 38400, 19200, 4800, 2400};
  std::vector<unsigned> rates{configured};
  for (const unsigned rate : kFactoryFirst)
    if (rate != configured) rates.push_back(rate);
  return rates;
}

std::string rate_command(unsigned baud) {
  return fmt::format("SERIALCONFIG THISPORT {} N 8 1 N ON", baud);
}

std::vector<std::string> configuration_commands(const ReceiverConfiguration& configuration) {
  std::vector<std::string> commands{"UNLOGALL THISPORT TRUE"};
  if (configuration.start != twins::gnss::StartMode::kCold) {
    const auto time = twins::gnss::week_time(twins::gnss::System::kGps, configuration.approximate_time);
    commands.push_back(fmt::format("SETAPPROXTIME {} {:.3f}", time.week, time.seconds_of_week()));
    const truth::GeodeticPosition at = truth::geodetic_from_itrf(configuration.approximate_position_ecef_m);
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    commands.push_back(
        fmt::format("SETAPPROXPOS {:.6f} {:.6f} {:.1f}", kDegrees * at.latitude, kDegrees * at.longitude, at.altitude));
  }
  commands.push_back(configuration.clock_adjust ? "CLOCKADJUST ENABLE" : "CLOCKADJUST DISABLE");
  if (!configuration.board_port.empty()) {
    commands.push_back("UNLOGALL " + configuration.board_port + " TRUE");
    add_logs(configuration.board_port, configuration, commands);
  }
  add_logs("THISPORT", configuration, commands);
  return commands;
}

namespace {

using std::chrono::milliseconds;

constexpr const char* kQuestion = "LOG THISPORT VERSIONB ONCE";
// After a silence of this length no answer to an earlier attempt is on its way.
constexpr milliseconds kQuiet{100};
// Between two checks of whether the caller has abandoned the search.
constexpr milliseconds kLongestWait{100};

double seconds(milliseconds span) {
  return std::chrono::duration<double>(span).count();
}

}  // namespace

ReceiverPort::ReceiverPort(std::string spacecraft, std::string device, ReceiverConfiguration configuration, Keep keep,
                           Patience patience)
    : spacecraft_(std::move(spacecraft)),
      device_(std::move(device)),
      configuration_(std::move(configuration)),
      keep_(std::move(keep)),
      patience_(patience) {}

void ReceiverPort::refuse(const std::string& what) const {
  throw ReceiverRefusal(fmt::format("receiver of {} on {}: {}", spacecraft_, device_, what));
}

void ReceiverPort::open(bool with_restart, const PortTime& time) {
  time_ = time;
  inbox_.clear();
  line_ = std::make_unique<io::SerialLine>(device_, configuration_.baud);
  try {
    find_rate();
    if (with_restart && configuration_.start == twins::gnss::StartMode::kCold) restart();
    set_rate();
    for (const std::string& text : configuration_commands(configuration_)) {
      // Bytes before the first log are answers and remains of an earlier run.
      if (text.starts_with("CLOCKADJUST")) inbox_.clear();
      command(text);
    }
  } catch (...) {
    line_.reset();
    throw;
  }
}

void ReceiverPort::find_rate() {
  const std::vector<unsigned> rates = rates_to_ask(configuration_.baud);
  for (int round = 0; round < patience_.attempts; ++round)
    for (const unsigned rate : rates)
      if (answers_at(rate)) return;
  const auto [slowest, fastest] = std::ranges::minmax(rates);
  refuse(fmt::format("no answer to \"{}\" at any rate from {} to {} baud; check cable and power", kQuestion, slowest,
                     fastest));
}

// At a wrong rate the receiver has collected remains of a line, which the first answer may be about. The answer to the
// question is then still to come; it must not be taken for that to the next command.
bool ReceiverPort::answers_at(unsigned baud) {
  line_->set_baud(baud);
  inbox_.clear();
  write("\r");
  const auto answer = ask(kQuestion, patience_.probe);
  if (!answer || answer->is_accepted) return answer.has_value();
  wait_until_quiet();
  return ask(kQuestion, patience_.probe).has_value();
}

// The receiver prompts when it has restarted; the rate is the one that it has saved.
void ReceiverPort::restart() {
  inbox_.clear();
  write("RESET\r");
  const Deadline until = now() + patience_.restart;
  receive(now() + kQuiet);
  const std::vector<unsigned> rates = rates_to_ask(configuration_.baud);
  while (now() < until) {
    for (const unsigned rate : rates) {
      wait_until_quiet();
      if (answers_at(rate)) return;
    }
  }
  refuse(fmt::format("no answer within {:g} s of the command \"RESET\"", seconds(patience_.restart)));
}

// The answer may come at either rate, so the question at the new one decides. A receiver that still answers at the old
// one has not received the command.
void ReceiverPort::set_rate() {
  const unsigned found = line_->baud();
  if (found == configuration_.baud) return;
  const std::string text = rate_command(configuration_.baud);
  for (int attempt = 0; attempt < patience_.attempts; ++attempt) {
    if (attempt == 0 || answers_at(found)) {
      const auto answer = ask(text, milliseconds(300));
      if (answer && !answer->is_accepted) refuse(fmt::format("command \"{}\" was refused: \"{}\"", text, answer->text));
    }
    if (answers_at(configuration_.baud)) return;
  }
  refuse(fmt::format("no answer at {} baud after the command \"{}\"", configuration_.baud, text));
}

void ReceiverPort::command(const std::string& text) {
  for (int attempt = 0; attempt < patience_.attempts; ++attempt) {
    if (attempt > 0) wait_until_quiet();
    const auto answer = ask(text, patience_.answer);
    if (!answer) continue;
    if (!answer->is_accepted)
      refuse(fmt::format("command \"{}\" was refused at {} baud: \"{}\"", text, line_->baud(), answer->text));
    if (attempt > 0) wait_until_quiet();
    return;
  }
  const auto since = std::span(inbox_).subspan(asked_);
  refuse(fmt::format("command \"{}\" was not answered in {} attempts of {:g} s at {} baud ({})", text,
                     patience_.attempts, seconds(patience_.answer), line_->baud(),
                     since.empty() ? "nothing received" : "received \"" + printable(since) + "\""));
}

std::optional<CommandAnswer> ReceiverPort::ask(const std::string& text, milliseconds limit) {
  asked_ = inbox_.size();
  write(text + "\r");
  const Deadline until = now() + limit;
  for (;;) {
    receive(until);
    const auto since = std::span(inbox_).subspan(asked_);
    if (const auto prompt = find_prompt(since)) port_name_ = *prompt;
    if (const auto answer = find_answer(since)) return answer;
    if (now() >= until) return std::nullopt;
  }
}

/// Waits for something to arrive.
void ReceiverPort::receive(Deadline deadline) {
  if (time_.abandoned && time_.abandoned()) refuse("the search for it was abandoned, as the run ends");
  const Deadline until = std::min(deadline, now() + kLongestWait);
  if (time_.wait) {
    time_.wait(until);
  } else {
    line_->wait_for_input(until);
  }
  take_available();
}

void ReceiverPort::take_available() {
  constexpr std::string_view kEmulated = "EMULATED";
  const std::size_t before = inbox_.size();
  const auto keep = [&] {
    const auto named = std::search(inbox_.begin(), inbox_.end(), kEmulated.begin(), kEmulated.end());
    is_emulated_ = is_emulated_ || named != inbox_.end();
    if (keep_ && inbox_.size() > before) keep_(std::span(inbox_).subspan(before));
  };
  try {
    line_->read_available(inbox_);
  } catch (...) {
    keep();
    throw;
  }
  keep();
}

void ReceiverPort::write(const std::string& text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  line_->write(bytes, io::Clock::now() + patience_.answer);
}

void ReceiverPort::wait_until_quiet() {
  // A receiver that logs is never quiet for long: the wait is bounded.
  for (int k = 0; k < 10; ++k) {
    const std::size_t before = inbox_.size();
    receive(now() + kQuiet);
    if (inbox_.size() == before) return;
  }
}

void ReceiverPort::read(Bytes& bytes) {
  if (!line_) return;
  const auto deliver = [&] {
    bytes.insert(bytes.end(), inbox_.begin(), inbox_.end());
    inbox_.clear();
  };
  try {
    take_available();
  } catch (const io::ChannelError&) {
    deliver();
    line_.reset();
    throw;
  }
  deliver();
}

}  // namespace vbar::grand
