#include "hil_drivers/external/external_run.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/external/external_source.h"
#include "hil_drivers/external/external_truth.h"
#include "host_sim/io/byte_channel.h"
#include "host_sim/io/child_process.h"
#include "host_sim/mission/mission.h"
#include "pil_bridge/remote_computer.h"
#include "pil_bridge/transport.h"

namespace vbar::external {

namespace {

using mission::from_to;
using mission::TableReader;

Program read_program(const TableReader& section, bool is_required) {
  Program program;
  program.command = section.text("program", "");
  const mission::UdpAddress address = mission::read_udp_address(section, "udp");
  program.host = address.host;
  program.port = address.port;
  const bool has_command = program.command.find_first_not_of(' ') != std::string::npos;
  if (has_command && program.port != 0) section.refuse_value("udp", "nothing beside program");
  if (is_required && !has_command && program.port == 0)
    section.refuse("program", "neither program nor udp",
                   "the command line of a program, or the address at which one waits");
  if (!has_command) program.command.clear();
  return program;
}

}  // namespace

const Program* ExternalSettings::program_of(std::string_view source) const {
  const auto own = std::ranges::find(sources, source, &ProgramOfSource::source);
  if (own != sources.end()) return &own->program;
  return program.command.empty() && program.port == 0 ? nullptr : &program;
}

std::shared_ptr<const mission::TestbedSettings> read_external(const TableReader& section) {
  auto settings = std::make_shared<ExternalSettings>();
  const std::vector<TableReader> sources = section.tables("source");
  settings->program = read_program(section, sources.empty());
  for (const TableReader& source : sources) {
    ProgramOfSource own{source.text("name"), read_program(source, true)};
    if (std::ranges::find(settings->sources, own.source, &ProgramOfSource::source) != settings->sources.end())
      source.refuse_value("name", "each source once");
    settings->sources.push_back(std::move(own));
    source.finish();
  }
  const auto limit = [&](std::string_view key, double default_s) {
    return std::chrono::milliseconds(section.span(key, 1.0, from_to(0.1, 3600.0), default_s).ns / 1000000);
  };
  settings->start_limit = limit("start_limit_s", 30.0);
  settings->answer_limit = limit("answer_limit_s", 10.0);
  settings->memory_gib = section.number("memory_gib", from_to(0.1, 1024.0), settings->memory_gib);
  section.finish();
  return settings;
}

namespace {

/// Rejects the program of a source that the mission does not have: its name is misspelt, or its sensor has another
/// source, and the program would not be started.
void check_external(const TableReader& section, const mission::TestbedSettings& settings,
                    const mission::Mission& mission) {
  std::vector<std::string> names;
  if (mission.truth_source == kExternal.name) names.emplace_back(kTruth);
  for (const mission::Spacecraft& spacecraft : mission.spacecraft)
    for (const mission::Sensor& sensor : spacecraft.sensors)
      if (sensor.settings->source == kExternal.name) names.push_back(spacecraft.name + "/" + sensor.name);
  const std::vector<TableReader> sources = section.tables("source");
  const auto& read = dynamic_cast<const ExternalSettings&>(settings).sources;
  for (std::size_t k = 0; k < sources.size(); ++k) {
    if (std::ranges::find(names, read[k].source) != names.end()) continue;
    sources[k].refuse_value("name", names.empty()
                                        ? "nothing, as neither the truth nor a sensor has source = \"external\""
                                        : fmt::format("what has source = \"external\": {}", fmt::join(names, ", ")));
  }
}

/// The program finds its end of the line at this descriptor, as vbar_flight does.
constexpr int kLineFd = 3;

/// Starts the program, or names its address.
void connect_program(const Program& program, const std::vector<std::string>& arguments, std::uint64_t memory_bytes,
                     pil::RemoteParts& parts) {
  if (arguments.empty()) {
    parts.transport = pil::make_udp_transport(program.host, program.port);
    return;
  }
  auto [ours, theirs] = io::make_socket_pair();
  std::vector<io::FileDescriptor> inherited;
  inherited.push_back(std::move(theirs));
  parts.process = std::make_unique<io::ChildProcess>(arguments, std::move(inherited), memory_bytes);
  parts.transport =
      std::make_unique<pil::StreamTransport>(io::adopt_socket(std::move(ours), fmt::format("descriptor {}", kLineFd)));
}

/// Connects to the program of one source. `spacecraft`: that of its packets. Throws std::runtime_error if the mission
/// names no program for it.
ExternalSource::Connect connection_to(const ExternalSettings& settings, const mission::Mission& mission,
                                      const std::filesystem::path& data, const std::string& source,
                                      std::uint8_t spacecraft) {
  const Program* const program = settings.program_of(source);
  if (program == nullptr)
    throw std::runtime_error(fmt::format("testbed.external names no program for the source {}", source));
  const std::array<testbeds::Replacement, 4> replacements{{{"{source}", source},
                                                           {"{seed}", std::to_string(mission.seed)},
                                                           {"{mission}", mission.file.string()},
                                                           {"{data}", data.string()}}};
  auto arguments = testbeds::arguments_of(program->command, replacements);
  return [program = *program, arguments = std::move(arguments), spacecraft, start = settings.start_limit,
          answer = settings.answer_limit,
          memory_bytes = static_cast<std::uint64_t>(
              settings.memory_gib * static_cast<double>(io::kBytesPerGib))]() -> std::unique_ptr<pil::FlightComputer> {
    pil::RemoteParts parts;
    parts.role = "program";
    parts.name = arguments.empty() ? fmt::format("at {}:{}", program.host, program.port) : arguments.front();
    parts.spacecraft = spacecraft;
    parts.timing.boot_limit = start;
    parts.timing.give_up_after = answer;
    try {
      connect_program(program, arguments, memory_bytes, parts);
    } catch (const std::system_error& error) {
      throw std::runtime_error(error.what());
    }
    return std::make_unique<pil::RemoteComputer>(std::move(parts));
  };
}

class ExternalRun final : public testbeds::TestbedRun {
 public:
  ExternalRun(const ExternalSettings& settings, const testbeds::RunContext& context)
      : settings_(settings), mission_(context.mission), data_(context.data_directory) {}

  std::unique_ptr<twins::PacketSource> make_packets(const testbeds::PacketPlan& plan) override {
    return std::make_unique<ExternalSource>(plan, static_cast<std::int64_t>(mission_.seed), numbers_of(mission_),
                                            connection_to(settings_, mission_, data_, plan.name, plan.spacecraft));
  }

  void begin(report::RunRecord& /*record*/, const std::filesystem::path& /*folder*/) override {}
  void finish() noexcept override {}

 private:
  ExternalSettings settings_;
  const mission::Mission& mission_;
  std::filesystem::path data_;
};

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<ExternalRun>(dynamic_cast<const ExternalSettings&>(settings), context);
}

std::unique_ptr<testbeds::TestbedTruth> make_truth(const mission::TestbedSettings& settings,
                                                   const testbeds::TruthPlan& plan) {
  return std::make_unique<ExternalTruth>(
      plan, connection_to(dynamic_cast<const ExternalSettings&>(settings), plan.mission, plan.data_directory,
                          std::string(kTruth), plan.servicer.number));
}

}  // namespace

const testbeds::TestbedKind kExternal{
    {.name = "external", .read = read_external, .supplies_truth = true, .check = check_external},
    open,
    {},
    nullptr,
    make_truth};

}  // namespace vbar::external
