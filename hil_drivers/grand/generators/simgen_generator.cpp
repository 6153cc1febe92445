#include <algorithm>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "hil_drivers/grand/generators/control_connection.h"
#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/wire/simgen.h"
#include "host_sim/io/udp_socket.h"

namespace vbar::grand {
namespace {

namespace chrono = std::chrono;
using wire::SimgenReply;
using wire::SimgenStatus;
using SteadyTime = chrono::steady_clock::time_point;

struct SimgenSettings final : GeneratorSettings {
  fsw::Duration duration = fsw::duration_of_seconds(24 * 3600);
  int trigger_mode = 0;
  chrono::milliseconds answer_limit{5000};
};

std::shared_ptr<const GeneratorSettings> read(const mission::TableReader& section) {
  auto settings = std::make_shared<SimgenSettings>();
  settings->duration = section.span("duration_h", 3600.0, mission::above_to(0.0, 240.0), 24.0);
  settings->trigger_mode = static_cast<int>(section.integer("trigger_mode", 0, 2, 0));
  settings->answer_limit = chrono::milliseconds(section.integer("answer_limit_ms", 100, 600'000, 5000));
  section.finish();
  return settings;
}

/// "MOT" of a line "0 00:00:00.000,MOT,...": the command in errors.
std::string_view name_in(std::string_view line) {
  const std::size_t mot = line.find("MOT");
  return mot == std::string_view::npos ? line : line.substr(mot, 3);
}

class SimgenGenerator final : public Generator {
 public:
  SimgenGenerator(const GeneratorPlan& plan, const SimgenSettings& settings) : plan_(plan), settings_(settings) {
    if (plan.vehicles.empty() || plan.control_ports.size() != 1)
      throw std::runtime_error(
          fmt::format("SimGEN: {} control ports; there is one for all vehicles", plan.control_ports.size()));
  }
  ~SimgenGenerator() override { stop(); }
  SimgenGenerator(const SimgenGenerator&) = delete;
  SimgenGenerator& operator=(const SimgenGenerator&) = delete;

  void prepare(std::span<const TrajectorySample> first) override;
  std::optional<SteadyTime> start() override;
  void send(std::size_t vehicle, const TrajectorySample& sample) override;
  std::optional<fsw::Duration> wait_for(std::size_t vehicle, fsw::Duration time, SteadyTime deadline) override;
  GeneratorState state(std::size_t vehicle) override;
  void stop() noexcept override;

 private:
  /// Sends a line and returns its reply, which must not be an error.
  SimgenReply command(std::string_view line);
  SimgenReply read_reply(std::string_view command);
  void expect(std::string_view command, const SimgenReply& reply, std::initializer_list<SimgenStatus> accepted);
  static wire::SimgenMotion motion(std::size_t vehicle, const TrajectorySample& sample) {
    return {static_cast<unsigned>(vehicle) + 1, true, sample};
  }

  GeneratorPlan plan_;
  SimgenSettings settings_;
  std::unique_ptr<ControlConnection> control_;
  std::unique_ptr<io::UdpSocket> udp_;
  std::string received_ = {};
  std::vector<std::string> last_lines_ = {};
  bool is_armed_ = false;
};

SimgenReply SimgenGenerator::read_reply(std::string_view command) {
  const auto deadline = control_->answer_deadline();
  try {
    for (;;) {
      if (const std::size_t length = wire::reply_length(received_); length > 0) {
        const SimgenReply reply = wire::parse_reply(std::string_view(received_).substr(0, length));
        received_.erase(0, length);
        return reply;
      }
      const auto bytes = control_->receive(command, deadline);
      received_.append(bytes.begin(), bytes.end());
    }
  } catch (const wire::WireError& error) {
    control_->fail(command, error.what());
  }
}

SimgenReply SimgenGenerator::command(std::string_view line) {
  const std::string_view name = name_in(line);
  const std::string text = std::string(line) + "\n";
  control_->send(name, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  SimgenReply reply = read_reply(name);
  if (!reply.error.empty()) control_->fail(name, fmt::format("answered the error \"{}\"", reply.error));
  return reply;
}

void SimgenGenerator::expect(std::string_view command, const SimgenReply& reply,
                             std::initializer_list<SimgenStatus> accepted) {
  const auto status = static_cast<SimgenStatus>(reply.status);
  if (std::find(accepted.begin(), accepted.end(), status) == accepted.end())
    control_->fail(command, fmt::format("answered status {} ({}); {} is expected", reply.status, wire::text_of(status),
                                        wire::text_of(*accepted.begin())));
}

void SimgenGenerator::prepare(std::span<const TrajectorySample> first) {
  if (first.size() != plan_.vehicles.size()) throw std::runtime_error("SimGEN: a first sample is missing");
  const std::uint16_t port = plan_.control_ports[0];
  control_ = std::make_unique<ControlConnection>("SimGEN", plan_.host, port, settings_.answer_limit);
  try {
    udp_ = std::make_unique<io::UdpSocket>(plan_.host, plan_.hil_port == 0 ? port : plan_.hil_port, std::uint16_t{0},
                                           wire::kSimgenMotBytes);
  } catch (const io::ChannelError& error) {
    control_->fail("opening the UDP port", error.what());
  }
  expect("START_TIME", command(wire::start_time_line(plan_.start, settings_.duration)), {SimgenStatus::kReady});
  command("SCENARIO_ITERATION_RATE");
  last_lines_.resize(first.size());
  for (std::size_t k = 0; k < first.size(); ++k) command(wire::mot_line(motion(k, first[k])));
  command(fmt::format("TR,{}", settings_.trigger_mode));
  expect("AR", command("AR"), {SimgenStatus::kArmed, SimgenStatus::kArming});
  is_armed_ = true;
}

std::optional<SteadyTime> SimgenGenerator::start() {
  expect("RU", command("RU"), {SimgenStatus::kRunning});
  return std::nullopt;
}

void SimgenGenerator::send(std::size_t vehicle, const TrajectorySample& sample) {
  if (plan_.pace == Pace::kRealTime) {
    try {
      udp_->send(wire::encode_mot(motion(vehicle, sample)));
    } catch (const io::ChannelError& error) {
      control_->fail("sending a sample", error.what());
    }
    return;
  }
  last_lines_.at(vehicle) = wire::mot_line(motion(vehicle, sample));
  command(last_lines_[vehicle]);
}

std::optional<fsw::Duration> SimgenGenerator::wait_for(std::size_t vehicle, fsw::Duration time, SteadyTime deadline) {
  constexpr chrono::milliseconds kRepeatAfter{200};
  constexpr chrono::milliseconds kPollPeriod{1};
  constexpr std::string_view kCommand = "-,TIME";
  auto repeat_at = chrono::steady_clock::now() + kRepeatAfter;
  for (;;) {
    const SimgenReply reply = command(kCommand);
    fsw::Duration reached;
    try {
      reached = wire::time_of_data(reply.data);
    } catch (const wire::WireError& error) {
      control_->fail(kCommand, error.what());
    }
    const auto now = chrono::steady_clock::now();
    if (reached >= time || now >= deadline) return reached;
    if (now >= repeat_at) {
      if (plan_.pace == Pace::kLockStep && !last_lines_.at(vehicle).empty()) command(last_lines_[vehicle]);
      repeat_at = now + kRepeatAfter;
    }
    std::this_thread::sleep_for(kPollPeriod);
  }
}

GeneratorState SimgenGenerator::state(std::size_t vehicle) {
  static_cast<void>(vehicle);
  const std::string line = "NULL\n";
  control_->send("NULL", {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  const SimgenReply reply = read_reply("NULL");
  const auto status = static_cast<SimgenStatus>(reply.status);
  return {std::string(wire::text_of(status)), status == SimgenStatus::kRunning, reply.error, std::nullopt};
}

void SimgenGenerator::stop() noexcept {
  if (!is_armed_) return;
  is_armed_ = false;
  try {
    command("-,EN,1");
  } catch (...) {
    // It has gone already, or does not answer: there is nothing left to stop.
  }
}

}  // namespace

const GeneratorKind kSimgenKind = {"simgen", read, [](const GeneratorPlan& plan, const GeneratorSettings& settings) {
                                     return std::unique_ptr<Generator>(std::make_unique<SimgenGenerator>(
                                         plan, dynamic_cast<const SimgenSettings&>(settings)));
                                   }};

}  // namespace vbar::grand
