// vbar_grand_bench: an RF generator and GNSS receivers, emulated behind their wire protocols.

#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>

#include "emulators/common/emulator_program.h"
#include "emulators/grand/generator/emulator.h"
#include "emulators/grand/generator/scenario.h"
#include "emulators/grand/generator/vehicle.h"
#include "emulators/grand/receiver/receiver.h"
#include "emulators/grand/samples/gnss_sdr_measurements.h"
#include "host_sim/mission/data_file.h"

namespace vbar::grand::bench {
namespace {

// Emulated OEM628 (../receiver) as the receiver of a vehicle.

// gnss-sdr behind the serial lines of the emulator: ports, commands and logs are those of the emulated receiver, the
// measurements are gnss-sdr's.

class Oem628End final : public ReceiverEnd {
 public:
  explicit Oem628End(Receiver receiver) : receiver_(std::move(receiver)) {}

  void advance(const RfBlock& block) override { receiver_.advance(block); }
  void idle(fsw::Duration span) override { receiver_.idle(span); }
  [[nodiscard]] bool busy() const override { return receiver_.busy(); }
  void listen(std::size_t port, std::span<const std::uint8_t> bytes, unsigned host_baud) override {
    receiver_.listen(static_cast<int>(port), bytes, host_baud);
  }
  [[nodiscard]] std::vector<std::uint8_t> speak(std::size_t port, unsigned host_baud) override {
    return receiver_.speak(static_cast<int>(port), host_baud);
  }
  [[nodiscard]] unsigned baud(std::size_t port) const override { return receiver_.baud(static_cast<int>(port)); }
  void power(bool on) override { receiver_.power(on); }
  void set_cn0_offset_db(double offset_db) override { receiver_.set_cn0_offset_db(offset_db); }

 private:
  Receiver receiver_;
};

/// Returns a receiver with the ports and commands of an OEM628, as the receiver of a vehicle.
std::unique_ptr<ReceiverEnd> receiver_end(Receiver receiver) {
  return std::make_unique<Oem628End>(std::move(receiver));
}

/// Returns a factory of receivers with the settings of the scenario's vehicles.
ReceiverFactory oem628_receivers(const Scenario& scenario) {
  return [vehicles = scenario.vehicles, seed = scenario.seed](
             std::size_t index, std::shared_ptr<const twins::gnss::Constellation> constellation) {
    const VehicleScenario& vehicle = vehicles[index];
    return receiver_end(Receiver(vehicle.receiver, std::move(constellation), seed, vehicle.name));
  };
}

/// Returns a factory of receivers for the scenario's vehicles; each keeps its files in DIRECTORY/<vehicle>.gnss_sdr
/// while it exists. Throws std::invalid_argument, one sentence, if the scenario's pace is not real time.
ReceiverFactory gnss_sdr_receivers(const Scenario& scenario, const std::filesystem::path& directory) {
  if (scenario.pace != Pace::kRealTime)
    throw std::invalid_argument("gnss-sdr receives in real time only: pace is lock_step; accepted is real_time");
  return [vehicles = scenario.vehicles, seed = scenario.seed, directory](
             std::size_t index, std::shared_ptr<const twins::gnss::Constellation> constellation) {
    const VehicleScenario& vehicle = vehicles[index];
    GnssSdrSettings settings;
    settings.directory = directory / (vehicle.name + ".gnss_sdr");
    auto measurements = std::make_unique<GnssSdrMeasurements>(settings, constellation, seed, vehicle.name);
    return receiver_end(Receiver(vehicle.receiver, constellation, seed, vehicle.name, std::move(measurements)));
  };
}

}  // namespace
}  // namespace vbar::grand::bench

namespace {

namespace bench = vbar::grand::bench;

enum class ReceiverKind { kOem628, kGnssSdr };

bench::ReceiverFactory receivers(ReceiverKind kind, const bench::Scenario& scenario,
                                 const std::filesystem::path& directory) {
  return kind == ReceiverKind::kGnssSdr ? bench::gnss_sdr_receivers(scenario, std::filesystem::absolute(directory))
                                        : bench::oem628_receivers(scenario);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"Emulated GNSS testbed: RF generator and receivers behind their wire protocols"};
  std::filesystem::path scenario_file;
  std::filesystem::path directory;
  std::vector<std::string> assignments;
  std::string pace;
  std::uint64_t seed = 0;
  ReceiverKind receiver = ReceiverKind::kOem628;
  program.add_option("scenario", scenario_file, "scenario file (TOML)")->required();
  program.add_option("--directory", directory, "where the serial lines, sockets and addresses.json are made")
      ->required();
  const CLI::Option* seed_option = program.add_option("--seed", seed, "seed of every random stream");
  program.add_option("--set", assignments, "a key of the scenario file and its value; may be given again")
      ->allow_extra_args(false);
  const CLI::Option* pace_option = program.add_option("--pace", pace, "lock_step or real_time");
  const std::map<std::string, ReceiverKind> kReceivers{{"oem628", ReceiverKind::kOem628},
                                                       {"gnss_sdr", ReceiverKind::kGnssSdr}};
  program.add_option("--receiver", receiver, "oem628 (emulated) or gnss_sdr (the program gnss-sdr; real time only)")
      ->transform(CLI::CheckedTransformer(kReceivers));
  CLI11_PARSE(program, argc, argv);
  if (*seed_option) assignments.push_back("seed=" + std::to_string(seed));
  if (*pace_option) assignments.push_back("pace=" + pace);
  return vbar::emulators::run_emulator("vbar_grand_bench", [&](boost::asio::io_context& context) {
    const bench::Scenario scenario = bench::read_scenario(scenario_file, assignments);
    auto emulator = std::make_shared<bench::Bench>(context, scenario, vbar::mission::data_directory(), directory,
                                                   receivers(receiver, scenario, directory));
    emulator->faults().on_exit = vbar::emulators::exit_by_fault;
    return emulator;
  });
}
