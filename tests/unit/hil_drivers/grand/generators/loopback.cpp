#include "tests/unit/hil_drivers/grand/generators/loopback.h"

#include <algorithm>
#include <stdexcept>

#include "host_sim/mission/toml_file.h"

namespace vbar::grand::test {

TrajectorySample sample_at(fsw::Duration time, double first) {
  TrajectorySample sample;
  sample.time = time;
  double value = first;
  for (fsw::Vector3* vector :
       {&sample.position_ecef_m, &sample.velocity_ecef_mps, &sample.acceleration_ecef_mps2, &sample.jerk_ecef_mps3,
        &sample.yaw_pitch_roll, &sample.angular_rate, &sample.angular_acceleration})
    for (double& component : *vector) component = (value += 0.1);
  sample.position_ecef_m.x() += 7.0e6;
  return sample;
}

bool is_same(const TrajectorySample& a, const TrajectorySample& b) {
  return a.time == b.time && a.position_ecef_m == b.position_ecef_m && a.velocity_ecef_mps == b.velocity_ecef_mps &&
         a.acceleration_ecef_mps2 == b.acceleration_ecef_mps2 && a.jerk_ecef_mps3 == b.jerk_ecef_mps3 &&
         a.yaw_pitch_roll == b.yaw_pitch_roll && a.angular_rate == b.angular_rate &&
         a.angular_acceleration == b.angular_acceleration;
}

void FakeEngine::sample(std::size_t vehicle, const TrajectorySample& sample) {
  if (ignored_samples > 0) {
    --ignored_samples;
    return;
  }
  samples[vehicle].push_back(sample);
  bench::VehicleReport& report = reports[vehicle];
  ++report.samples;
  if (stage != bench::EngineState::kStreaming || sample.time <= report.time) return;
  report.time = sample.time;
  for (const auto& call : on_progress) call(vehicle);
}

Loopback::Loopback(const bench::ControlSettings& settings, std::size_t vehicles)
    : engine_(vehicles), servers_(bench::make_control_servers(context_, engine_, settings)), edges_(context_) {
  control_ports_ = servers_->control_ports();
  hil_ports_ = servers_->hil_ports();
  fire_edges();
  thread_ = std::thread([this] { context_.run(); });
}

Loopback::~Loopback() {
  boost::asio::post(context_, [this] {
    edges_.cancel();
    servers_.reset();
    context_.stop();
  });
  thread_.join();
}

void Loopback::fire_edges() {
  edges_.expires_after(std::chrono::milliseconds(2));
  edges_.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    const auto waiting = std::exchange(engine_.on_next_edge, {});
    for (const auto& call : waiting) call();
    fire_edges();
  });
}

void Loopback::in_server(const std::function<void(FakeEngine&, bench::ControlServers&)>& use) {
  std::promise<void> done;
  boost::asio::post(context_, [&] {
    use(engine_, *servers_);
    done.set_value();
  });
  done.get_future().wait();
}

void Loopback::set_faults(const bench::ControlFaults& faults) {
  in_server([&](FakeEngine&, bench::ControlServers& servers) { servers.set_faults(faults); });
}

bench::ControlStatistics Loopback::statistics() {
  bench::ControlStatistics statistics;
  in_server([&](FakeEngine&, const bench::ControlServers& servers) { statistics = servers.statistics(); });
  return statistics;
}

GeneratorPlan Loopback::plan(Pace pace) const {
  GeneratorPlan plan;
  plan.start = kStart;
  for (std::size_t k = 0; k < engine_.vehicles(); ++k) plan.vehicles.push_back("vehicle" + std::to_string(k));
  plan.sample_period = kTenth;
  plan.join = fsw::Duration{165'000'000};
  plan.pace = pace;
  plan.host = "127.0.0.1";
  plan.control_ports = control_ports_;
  return plan;
}

std::unique_ptr<Generator> Loopback::generator(const std::string& kind, const std::string& table, Pace pace) const {
  const auto kinds = generator_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const auto* one) { return one->name == kind; });
  if (found == kinds.end()) throw std::logic_error("unknown kind " + kind);
  const toml::table document = mission::parse_toml(table, "t.toml");
  const mission::TableReader section(document, "t.toml");
  return (*found)->make(plan(pace), *(*found)->read(section));
}

void prepare(Generator& generator, std::size_t vehicles) {
  std::vector<TrajectorySample> first;
  for (std::size_t k = 0; k < vehicles; ++k) first.push_back(sample_at({}, static_cast<double>(k)));
  generator.prepare(first);
}

std::string error_of(const std::function<void()>& use) {
  try {
    use();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace vbar::grand::test
