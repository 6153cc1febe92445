#include "hil_drivers/external/external_kind.h"

#include <array>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "hil_drivers/bench_process/command_line.h"
#include "hil_drivers/external/external_source.h"
#include "hil_drivers/external/settings.h"
#include "host_sim/io/byte_channels.h"
#include "pil_bridge/remote_computer.h"
#include "pil_bridge/stream_transport.h"
#include "pil_bridge/udp_transport.h"

namespace vbar::external {
namespace {

/// The program finds its end of the line at this descriptor, as vbar_flight does.
constexpr int kLineFd = 3;

/// Starts the program, or names its address.
void connect_program(const Program& program, const std::vector<std::string>& arguments, pil::RemoteParts& parts) {
  if (arguments.empty()) {
    parts.transport = pil::make_udp_transport(program.host, program.port);
    return;
  }
  auto [ours, theirs] = io::make_socket_pair();
  std::vector<io::FileDescriptor> inherited;
  inherited.push_back(std::move(theirs));
  parts.process = std::make_unique<io::ChildProcess>(arguments, std::move(inherited));
  parts.transport =
      std::make_unique<pil::StreamTransport>(io::adopt_socket(std::move(ours), fmt::format("descriptor {}", kLineFd)));
}

class ExternalRun final : public testbeds::TestbedRun {
 public:
  ExternalRun(const ExternalSettings& settings, const testbeds::RunContext& context)
      : settings_(settings),
        seed_(static_cast<std::int64_t>(context.mission.seed)),
        mission_(context.mission.file.string()),
        data_(context.data_directory.string()) {
    for (const mission::Spacecraft& spacecraft : context.mission.spacecraft)
      numbers_.add(spacecraft.name, spacecraft.number);
  }

  std::unique_ptr<twins::PacketSource> make_packets(const testbeds::PacketPlan& plan) override {
    const Program* const program = settings_.program_of(plan.name);
    if (program == nullptr)
      throw std::runtime_error(fmt::format("testbed.external names no program for the source {}", plan.name));
    const std::array<bench_process::Replacement, 4> replacements{
        {{"{source}", plan.name}, {"{seed}", std::to_string(seed_)}, {"{mission}", mission_}, {"{data}", data_}}};
    auto arguments = bench_process::arguments_of(program->command, replacements);
    return std::make_unique<ExternalSource>(
        plan, seed_, numbers_,
        [plan, program = *program, arguments = std::move(arguments), start = settings_.start_limit,
         answer = settings_.answer_limit]() -> std::unique_ptr<pil::FlightComputer> {
          pil::RemoteParts parts;
          parts.role = "program";
          parts.name = arguments.empty() ? fmt::format("at {}:{}", program.host, program.port) : arguments.front();
          parts.spacecraft = plan.spacecraft;
          parts.timing.boot_limit = start;
          parts.timing.give_up_after = answer;
          try {
            connect_program(program, arguments, parts);
          } catch (const std::system_error& error) {
            throw std::runtime_error(error.what());
          }
          return std::make_unique<pil::RemoteComputer>(std::move(parts));
        });
  }

  void begin(report::RunRecord& /*record*/, const std::filesystem::path& /*folder*/) override {}
  void finish() noexcept override {}

 private:
  ExternalSettings settings_;
  std::int64_t seed_;
  std::string mission_, data_;
  SpacecraftNumbers numbers_;
};

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<ExternalRun>(dynamic_cast<const ExternalSettings&>(settings), context);
}

}  // namespace

const testbeds::TestbedKind kExternal{{"external", read_external}, open};

}  // namespace vbar::external
