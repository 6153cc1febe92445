#include "emulators/grand/generator/emulator.h"

#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/wire/emulator_files.h"

namespace vbar::grand::bench {
namespace {

constexpr const char* kPpsSocket = "pps.sock";
constexpr const char* kFaultSocket = "faults.sock";

}  // namespace

Bench::Bench(boost::asio::io_context& context, const Scenario& scenario, const std::filesystem::path& data_directory,
             std::filesystem::path directory, const ReceiverFactory& make_receiver)
    : directory_(std::move(directory)),
      edges_(std::make_unique<EdgeBroadcaster>((directory_.path() / kPpsSocket).string())),
      engine_(std::make_unique<GeneratorEngine>(context, scenario, data_directory, directory_.path(), make_receiver)),
      control_(make_control_servers(context, *engine_, scenario.control)),
      faults_(
          std::make_unique<FaultInjector>(*engine_, *control_, *edges_, directory_.path() / vbar::wire::kFaultsFile)),
      fault_line_(std::make_unique<emulators::ControlLine>(
          context, directory_.path() / kFaultSocket,
          [this, vehicles = scenario.vehicle_names()](const std::string& line, const emulators::Answer& answer) {
            faults_->add(fault_from_json(line, vehicles),
                         [answer](const std::string& injected) { answer("{\"injected\":" + injected + "}"); });
            faults_->advance();
          })) {
  engine_->on_edge = [this](const wire::PpsDatagram& edge) { edges_->send(edge); };
  engine_->on_advance = [this] { faults_->advance(); };
  for (const Fault& fault : scenario.faults) faults_->add(fault);
  faults_->advance();
  write_addresses(scenario);
}

Bench::~Bench() {
  try {
    write_counters();
  } catch (...) {
    // A run without these counters says so by their absence.
  }
}

void Bench::write_counters() const {
  nlohmann::ordered_json counters;
  for (std::size_t index = 0; index < engine_->vehicles(); ++index) {
    const Vehicle& vehicle = engine_->vehicle(index);
    const MotionCounters& motion = vehicle.motion().counters();
    const auto set = [&](const char* name, auto value) { counters[vehicle.name() + "_samples" + name] = value; };
    set("", motion.samples);
    set("_missing", motion.missing);
    set("_doubled", motion.doubled);
    set("_out_of_order", motion.out_of_order);
    set("_late", motion.late);
    set("_rejected", motion.rejected);
    const std::uint64_t used = motion.samples - motion.doubled - motion.rejected;
    if (engine_->is_lock_step() || used == 0) continue;
    set("_lead_min_ms", 1e3 * motion.lead_min_s);
    set("_lead_mean_ms", 1e3 * motion.lead_sum_s / static_cast<double>(used));
  }
  std::ofstream(directory_.path() / vbar::wire::kCountersFile) << counters.dump(2) << "\n";
}

void Bench::write_addresses(const Scenario& scenario) const {
  nlohmann::ordered_json addresses;
  addresses["control_ports"] = control_->control_ports();
  addresses["hil_ports"] = control_->hil_ports();
  addresses["pps"] = (directory_.path() / kPpsSocket).string();
  addresses["faults"] = (directory_.path() / kFaultSocket).string();
  for (std::size_t index = 0; index < engine_->vehicles(); ++index) {
    auto& lines = addresses["receivers"][scenario.vehicles[index].name];
    std::size_t number = 0;
    for (const Vehicle::Port& port : engine_->vehicle(index).ports())
      lines["com" + std::to_string(++number)] = port.line->path().string();
  }
  directory_.write_addresses(addresses.dump(2));
}

}  // namespace vbar::grand::bench
