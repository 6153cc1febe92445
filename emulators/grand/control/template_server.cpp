// Emulated generator of a template: lines and datagrams as the mission describes them.

#include <fmt/format.h>

#include "emulators/grand/control/line_server.h"
#include "hil_drivers/grand/wire/template_format.h"

namespace vbar::grand::bench {
namespace {

using wire::TextPattern;

class TemplateServer final : public LineServer {
 public:
  TemplateServer(boost::asio::io_context& context, Engine& engine, const ControlSettings& settings)
      : LineServer(context, engine, settings,
                   settings.template_format.vehicle_by == wire::VehicleBy::kPort ? engine.vehicles() : 1),
        codec_(settings.template_format) {
    serve();
  }

 private:
  std::optional<std::string> execute(const std::string& line, const Answer& later) override {
    if (codec_.progress_line() && codec_.progress_line()->matches(line))
      return progress(codec_.progress_line()->parse(line));
    if (const TextPattern* pattern = pattern_of(codec_.prepare_lines(), line)) {
      configure(pattern->parse(line));
      return accepted();
    }
    if (const TextPattern* pattern = pattern_of(codec_.start_lines(), line)) {
      configure(pattern->parse(line));
      if (pattern != &codec_.start_lines().back()) return accepted();
      arm();
      start_at_edge(
          [this, later](const std::string& refusal) { later(refusal.empty() ? accepted() : refusal_of(refusal)); });
      return std::nullopt;
    }
    if (pattern_of(codec_.stop_lines(), line) != nullptr) {
      stop_run();
      return accepted();
    }
    throw Refusal(fmt::format("the line \"{}\" is not one of the template", wire::printable(line)));
  }
  [[nodiscard]] std::string command_of(const std::string& line) const override { return line; }
  [[nodiscard]] std::string refusal_of(const std::string& reason) const override { return "ERROR " + reason + "\n"; }

  void take_datagram(std::size_t port, std::span<const std::uint8_t> datagram) override {
    const auto received = codec_.decode(datagram);
    const bool is_by_port = codec_.format().vehicle_by == wire::VehicleBy::kPort;
    take_sample(is_by_port ? port : received.vehicle.value_or(0), received.sample);
  }

  static const TextPattern* pattern_of(const std::vector<TextPattern>& patterns, const std::string& line) {
    for (const TextPattern& pattern : patterns)
      if (pattern.matches(line)) return &pattern;
    return nullptr;
  }

  void configure(const wire::NamedValues& values) {
    if (const auto start = wire::start_time_of(values)) begin_configuration(*start);
  }

  std::string progress(const wire::NamedValues& asked) {
    if (engine().state() == EngineState::kError) throw Refusal(engine().error());
    const auto vehicle = asked.find("vehicle");
    fsw::Duration time;
    if (vehicle == asked.end()) {
      time = time_into_run();
    } else {
      if (!(vehicle->second >= 1.0 && vehicle->second <= static_cast<double>(engine().vehicles())))
        throw Refusal(fmt::format("vehicle {} of {}", vehicle->second, engine().vehicles()));
      time = engine().report(static_cast<std::size_t>(vehicle->second) - 1).time;
    }
    wire::NamedValues values = asked;
    values["time_s"] = fsw::seconds(time);
    return codec_.progress_answer().format(values) + "\n";
  }

  [[nodiscard]] std::string accepted() const { return codec_.format().accepted_answer + "\n"; }

  wire::TemplateCodec codec_;
};

}  // namespace

std::unique_ptr<ControlServers> make_template_server(boost::asio::io_context& context, Engine& engine,
                                                     const ControlSettings& settings) {
  return std::make_unique<TemplateServer>(context, engine, settings);
}

}  // namespace vbar::grand::bench
