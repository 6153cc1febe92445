#include "hil_drivers/grand/bench/generator/bench.h"

#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace vbar::grand::bench {
namespace {

constexpr const char* kAddresses = "addresses.json";
constexpr const char* kPpsSocket = "pps.sock";
constexpr const char* kFaultSocket = "faults.sock";
constexpr const char* kFaultFile = "faults.jsonl";

std::filesystem::path existing(std::filesystem::path directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory))
    throw std::runtime_error(fmt::format("{}: this directory cannot be made: {}", directory.string(), error.message()));
  return std::filesystem::absolute(directory);
}

}  // namespace

Bench::Bench(boost::asio::io_context& context, const Scenario& scenario, const std::filesystem::path& data_directory,
             std::filesystem::path directory, const ReceiverFactory& make_receiver)
    : directory_(existing(std::move(directory))),
      edges_(std::make_unique<EdgeBroadcaster>((directory_ / kPpsSocket).string())),
      engine_(std::make_unique<BenchEngine>(context, scenario, data_directory, directory_, make_receiver)),
      control_(make_control_servers(context, *engine_, scenario.control)),
      faults_(std::make_unique<FaultInjector>(*engine_, *control_, *edges_, directory_ / kFaultFile)),
      fault_line_(std::make_unique<FaultLine>(context, *faults_, scenario.vehicle_names(), directory_ / kFaultSocket)) {
  engine_->on_edge = [this](const wire::PpsDatagram& edge) { edges_->send(edge); };
  engine_->on_advance = [this] { faults_->advance(); };
  for (const Fault& fault : scenario.faults) faults_->add(fault);
  faults_->advance();
  write_addresses(scenario);
}

Bench::~Bench() {
  std::error_code ignored;
  std::filesystem::remove(directory_ / kAddresses, ignored);
}

// Under its final name only when it is complete: whoever waits for it may read it at once.
void Bench::write_addresses(const Scenario& scenario) const {
  nlohmann::ordered_json addresses;
  addresses["control_ports"] = control_->control_ports();
  addresses["hil_ports"] = control_->hil_ports();
  addresses["pps"] = (directory_ / kPpsSocket).string();
  addresses["faults"] = (directory_ / kFaultSocket).string();
  for (std::size_t index = 0; index < engine_->vehicles(); ++index) {
    auto& lines = addresses["receivers"][scenario.vehicles[index].name];
    std::size_t number = 0;
    for (const Vehicle::Port& port : engine_->vehicle(index).ports())
      lines["com" + std::to_string(++number)] = port.line->path().string();
  }
  const std::filesystem::path file = directory_ / kAddresses;
  const std::filesystem::path partial = file.string() + ".partial";
  std::ofstream out(partial);
  out << addresses.dump(2) << "\n";
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", partial.string()));
  std::filesystem::rename(partial, file);
}

}  // namespace vbar::grand::bench
