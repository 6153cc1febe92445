#include <algorithm>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "hil_drivers/grand/generators/control_connection.h"
#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/wire/template_format.h"
#include "hil_drivers/wire/bytes.h"
#include "host_sim/io/udp_socket.h"

namespace vbar::grand {
namespace {

namespace chrono = std::chrono;
using SteadyTime = chrono::steady_clock::time_point;

struct TemplateSettings final : GeneratorSettings {
  wire::TemplateFormat format;
  chrono::milliseconds answer_limit{5000};
};

std::shared_ptr<const GeneratorSettings> read(const mission::TableReader& section) {
  auto settings = std::make_shared<TemplateSettings>();
  settings->answer_limit = chrono::milliseconds(section.integer("answer_limit_ms", 100, 600'000, 5000));
  settings->format = wire::read_template_format(section);
  section.finish();
  return settings;
}

class TemplateGenerator final : public Generator {
 public:
  TemplateGenerator(const GeneratorPlan& plan, const TemplateSettings& settings)
      : plan_(plan), answer_limit_(settings.answer_limit), codec_(settings.format) {
    const bool is_by_port = settings.format.vehicle_by == wire::VehicleBy::kPort;
    if (plan.vehicles.empty() || plan.control_ports.empty()) throw std::runtime_error("template: no control port");
    if (is_by_port && plan.hil_port == 0 && plan.control_ports.size() != plan.vehicles.size())
      throw std::runtime_error(fmt::format("template: {} ports for {} vehicles with vehicle = \"port\"",
                                           plan.control_ports.size(), plan.vehicles.size()));
    if (plan.pace == Pace::kLockStep && !codec_.progress_line())
      throw std::runtime_error(
          "template: lock-step needs a progress_line, by which the generator is asked how far it is");
  }
  ~TemplateGenerator() override { stop(); }
  TemplateGenerator(const TemplateGenerator&) = delete;
  TemplateGenerator& operator=(const TemplateGenerator&) = delete;

  void prepare(std::span<const TrajectorySample> first) override;
  std::optional<SteadyTime> start() override;
  void send(std::size_t vehicle, const TrajectorySample& sample) override;
  std::optional<fsw::Duration> wait_for(std::size_t vehicle, fsw::Duration time, SteadyTime deadline) override;
  GeneratorState state(std::size_t vehicle) override;
  void stop() noexcept override;

 private:
  std::string ask(const std::string& line);
  void command(const wire::TextPattern& pattern);
  void send_datagram(std::size_t vehicle);
  std::optional<fsw::Duration> progress(std::size_t vehicle);
  [[nodiscard]] std::uint16_t udp_port(std::size_t vehicle) const;

  GeneratorPlan plan_;
  chrono::milliseconds answer_limit_;
  wire::TemplateCodec codec_;
  std::unique_ptr<ControlConnection> control_;
  std::vector<std::unique_ptr<io::UdpSocket>> udp_ = {};
  wire::LineBuffer lines_;
  std::vector<wire::Bytes> last_ = {};
  bool is_started_ = false;
};

std::string TemplateGenerator::ask(const std::string& line) {
  const std::string command = wire::printable(line);
  const std::string text = line + "\n";
  control_->send(command, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const auto deadline = control_->answer_deadline();
  try {
    for (;;) {
      if (auto answer = lines_.next()) return *answer;
      lines_.append(control_->receive(command, deadline));
    }
  } catch (const wire::WireError& error) {
    control_->fail(command, error.what());
  }
}

void TemplateGenerator::command(const wire::TextPattern& pattern) {
  const std::string line = pattern.format(wire::control_values_of(plan_.start, plan_.vehicles.size()));
  const std::string answer = ask(line);
  if (!answer.starts_with(codec_.format().accepted_answer))
    control_->fail(wire::printable(line), fmt::format("answered \"{}\"", wire::printable(answer)));
}

std::uint16_t TemplateGenerator::udp_port(std::size_t vehicle) const {
  const std::size_t index = codec_.format().vehicle_by == wire::VehicleBy::kPort ? vehicle : 0;
  return plan_.hil_port == 0 ? plan_.control_ports[index] : static_cast<std::uint16_t>(plan_.hil_port + index);
}

void TemplateGenerator::prepare(std::span<const TrajectorySample> first) {
  constexpr std::size_t kMaxDatagram = 1472;
  if (first.size() != plan_.vehicles.size()) throw std::runtime_error("template: a first sample is missing");
  control_ = std::make_unique<ControlConnection>("template", plan_.host, plan_.control_ports[0], answer_limit_);
  last_.resize(first.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    try {
      udp_.push_back(std::make_unique<io::UdpSocket>(plan_.host, udp_port(k), std::uint16_t{0}, kMaxDatagram));
    } catch (const io::ChannelError& error) {
      control_->fail("opening the UDP port", error.what());
    }
  }
  for (const wire::TextPattern& line : codec_.prepare_lines()) command(line);
  for (std::size_t k = 0; k < first.size(); ++k) send(k, first[k]);
}

std::optional<SteadyTime> TemplateGenerator::start() {
  is_started_ = true;
  for (const wire::TextPattern& line : codec_.start_lines()) command(line);
  return std::nullopt;
}

void TemplateGenerator::send_datagram(std::size_t vehicle) {
  try {
    udp_.at(vehicle)->send(last_[vehicle]);
  } catch (const io::ChannelError& error) {
    control_->fail("sending a sample", error.what());
  }
}

void TemplateGenerator::send(std::size_t vehicle, const TrajectorySample& sample) {
  last_.at(vehicle) = codec_.encode(vehicle, sample);
  send_datagram(vehicle);
}

std::optional<fsw::Duration> TemplateGenerator::progress(std::size_t vehicle) {
  if (!codec_.progress_line()) return std::nullopt;
  const std::string line = codec_.progress_line()->format(
      {{"vehicle", static_cast<double>(vehicle + 1)}, {"vehicles", static_cast<double>(plan_.vehicles.size())}});
  const std::string answer = ask(line);
  try {
    constexpr double kMaxTime_s = 1e7;
    const double time_s = codec_.progress_answer().parse(answer).at("time_s");
    if (!(time_s >= 0.0 && time_s <= kMaxTime_s))
      throw wire::WireError(fmt::format("{} s is no time of a run", time_s));
    return fsw::nearest_duration(time_s);
  } catch (const wire::WireError& error) {
    control_->fail(wire::printable(line), error.what());
  }
}

std::optional<fsw::Duration> TemplateGenerator::wait_for(std::size_t vehicle, fsw::Duration time, SteadyTime deadline) {
  constexpr chrono::milliseconds kRepeatAfter{200};
  constexpr chrono::milliseconds kPollPeriod{1};
  auto repeat_at = chrono::steady_clock::now() + kRepeatAfter;
  for (;;) {
    const std::optional<fsw::Duration> reached = progress(vehicle);
    const auto now = chrono::steady_clock::now();
    if (!reached || *reached >= time || now >= deadline) return reached;
    if (now >= repeat_at) {
      if (plan_.pace == Pace::kLockStep) send_datagram(vehicle);
      repeat_at = now + kRepeatAfter;
    }
    std::this_thread::sleep_for(kPollPeriod);
  }
}

GeneratorState TemplateGenerator::state(std::size_t vehicle) {
  const std::optional<fsw::Duration> reached = progress(vehicle);
  if (!reached) {
    // It cannot be asked: only a closed connection is noticed.
    lines_.append(control_->poll("state"));
    return {is_started_ ? "started" : "not started", is_started_};
  }
  return {fmt::format("at {:.3f} s", fsw::seconds(*reached)), is_started_};
}

void TemplateGenerator::stop() noexcept {
  if (!is_started_) return;
  is_started_ = false;
  try {
    for (const wire::TextPattern& line : codec_.stop_lines()) command(line);
  } catch (...) {
    // It has gone already, or does not answer: there is nothing left to stop.
  }
}

}  // namespace

const GeneratorKind kTemplateKind = {
    "template", read, [](const GeneratorPlan& plan, const GeneratorSettings& settings) {
      return std::unique_ptr<Generator>(
          std::make_unique<TemplateGenerator>(plan, dynamic_cast<const TemplateSettings&>(settings)));
    }};

}  // namespace vbar::grand
