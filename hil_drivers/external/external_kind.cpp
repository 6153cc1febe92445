#include "hil_drivers/external/external_kind.h"

#include <array>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "hil_drivers/bench_process/command_line.h"
#include "hil_drivers/external/external_source.h"
#include "hil_drivers/external/external_truth.h"
#include "hil_drivers/external/settings.h"
#include "host_sim/io/byte_channels.h"
#include "host_sim/io/process_limits.h"
#include "pil_bridge/remote_computer.h"
#include "pil_bridge/stream_transport.h"
#include "pil_bridge/udp_transport.h"

namespace vbar::external {
namespace {

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
  const std::array<bench_process::Replacement, 4> replacements{{{"{source}", source},
                                                                {"{seed}", std::to_string(mission.seed)},
                                                                {"{mission}", mission.file.string()},
                                                                {"{data}", data.string()}}};
  auto arguments = bench_process::arguments_of(program->command, replacements);
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
    {.name = "external", .read = read_external, .supplies_truth = true}, open, {}, nullptr, make_truth};

}  // namespace vbar::external
