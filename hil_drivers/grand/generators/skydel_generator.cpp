#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "hil_drivers/grand/generators/control_connection.h"
#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/wire/skydel.h"
#include "host_sim/io/udp_socket.h"

namespace vbar::grand {
namespace {

namespace chrono = std::chrono;
using wire::Json;
using SteadyTime = chrono::steady_clock::time_point;

struct SkydelSettings final : GeneratorSettings {
  std::string radio = "NoneRT";
  std::string radio_path = {};
  std::string radio_address = {};
  bool external_clock = true;
  std::string upper_signals = "L1CA,E1,B1";
  std::string lower_signals = "L2C";
  double min_rate_hz = 12.5e6;
  double max_rate_hz = 100e6;
  std::uint16_t sync_port = 4840;
  chrono::milliseconds start_after_pps{2000};
  chrono::milliseconds answer_limit{5000};
};

std::shared_ptr<const GeneratorSettings> read(const mission::TableReader& section) {
  auto settings = std::make_shared<SkydelSettings>();
  settings->radio = section.text("radio", settings->radio);
  settings->radio_path = section.text("radio_path", settings->radio_path);
  settings->radio_address = section.text("radio_address", settings->radio_address);
  settings->external_clock = section.flag("external_clock", settings->external_clock);
  settings->upper_signals = section.text("upper_signals", settings->upper_signals);
  settings->lower_signals = section.text("lower_signals", settings->lower_signals);
  settings->min_rate_hz = section.number("min_rate_hz", mission::from_to(1e6, 1e9), settings->min_rate_hz);
  settings->max_rate_hz = section.number("max_rate_hz", mission::from_to(1e6, 1e9), settings->max_rate_hz);
  settings->sync_port = static_cast<std::uint16_t>(section.integer("sync_port", 1, 65535, settings->sync_port));
  settings->start_after_pps = chrono::milliseconds(section.integer("start_after_pps_ms", 0, 600'000, 2000));
  settings->answer_limit = chrono::milliseconds(section.integer("answer_limit_ms", 100, 600'000, 5000));
  section.finish();
  return settings;
}

class SkydelGenerator final : public Generator {
 public:
  SkydelGenerator(const GeneratorPlan& plan, const SkydelSettings& settings) : plan_(plan), settings_(settings) {
    if (plan.vehicles.empty() || plan.control_ports.size() != plan.vehicles.size())
      throw std::runtime_error(fmt::format("Skydel: {} control ports for {} vehicles; each vehicle is an instance",
                                           plan.control_ports.size(), plan.vehicles.size()));
  }
  ~SkydelGenerator() override { stop(); }
  SkydelGenerator(const SkydelGenerator&) = delete;
  SkydelGenerator& operator=(const SkydelGenerator&) = delete;

  void prepare(std::span<const TrajectorySample> first) override;
  std::optional<SteadyTime> start() override;
  void send(std::size_t vehicle, const TrajectorySample& sample) override;
  std::optional<fsw::Duration> wait_for(std::size_t vehicle, fsw::Duration time, SteadyTime deadline) override;
  GeneratorState state(std::size_t vehicle) override;
  [[nodiscard]] bool is_emulated() const override { return is_emulated_; }
  void stop() noexcept override;

 private:
  struct Instance {
    std::unique_ptr<SkydelControl> control;
    std::unique_ptr<io::UdpSocket> hil;
    wire::Bytes last_sample = {};
    std::optional<fsw::Duration> reached = std::nullopt;
  };

  void connect(std::size_t index);
  void configure(std::size_t index);
  void send_datagram(Instance& instance, const wire::Bytes& datagram);
  void take(Instance& instance, std::span<const std::uint8_t> datagram);

  GeneratorPlan plan_;
  SkydelSettings settings_;
  std::vector<Instance> instances_;
  bool is_armed_ = false, is_emulated_ = false;
};

void SkydelGenerator::connect(std::size_t index) {
  Instance& instance = instances_.emplace_back();
  instance.control = std::make_unique<SkydelControl>(plan_.host, plan_.control_ports[index], settings_.answer_limit);
  SkydelControl& control = *instance.control;
  const Json version = control.call("GetVersion", Json::object(), "VersionResult");
  const Json answer = control.call("GetHilPort", Json::object(), "HilPortResult");
  try {
    is_emulated_ = is_emulated_ || wire::text_field(version, "Version").find("emulated") != std::string::npos;
    const auto reported = static_cast<std::uint16_t>(wire::integer_field(answer, "Port", 1, 65535));
    const auto port = plan_.hil_port == 0 ? reported : static_cast<std::uint16_t>(plan_.hil_port + index);
    instance.hil = std::make_unique<io::UdpSocket>(plan_.host, port, std::uint16_t{0}, wire::kSkydelMaxHilBytes);
  } catch (const std::runtime_error& error) {
    control.fail("connecting", error.what());
  }
  send_datagram(instance, wire::encode_hello());
}

void SkydelGenerator::configure(std::size_t index) {
  SkydelControl& control = *instances_[index].control;
  const double join_ms = 1e3 * fsw::seconds(plan_.join);
  const std::string id = fmt::format("vbar{}", index);
  const Json latency = control.call("GetEngineLatency", Json::object(), "GetEngineLatencyResult");
  const Json buffer = control.call("GetStreamingBuffer", Json::object(), "GetStreamingBufferResult");
  try {
    const auto latency_ms = static_cast<double>(wire::integer_field(latency, "Latency", 0, 100'000));
    static_cast<void>(wire::integer_field(buffer, "Size", 0, 100'000));
    const double needed_ms = latency_ms + 1e3 * fsw::seconds(plan_.sample_period);
    if (join_ms < needed_ms)
      control.fail("GetEngineLatency", fmt::format("answered {} ms: join_ms = {} is below latency and sample period "
                                                   "together, {} ms",
                                                   latency_ms, join_ms, needed_ms));
  } catch (const wire::WireError& error) {
    control.fail("GetEngineLatency", error.what());
  }
  control.call("New", {{"DiscardCurrentConfig", true}, {"LoadDefaultConfig", false}});
  control.call("SetModulationTarget", {{"Type", settings_.radio},
                                       {"Path", settings_.radio_path},
                                       {"Address", settings_.radio_address},
                                       {"ClockIsExternal", settings_.external_clock},
                                       {"Id", id}});
  int output = 0;
  for (const auto& [band, signals] :
       {std::pair("UpperL", settings_.upper_signals), std::pair("LowerL", settings_.lower_signals)}) {
    if (signals.empty()) continue;
    control.call("ChangeModulationTargetSignals", {{"Output", output++},
                                                   {"MinRate", static_cast<std::int64_t>(settings_.min_rate_hz)},
                                                   {"MaxRate", static_cast<std::int64_t>(settings_.max_rate_hz)},
                                                   {"Band", band},
                                                   {"Signal", signals},
                                                   {"Gain", -1},
                                                   {"GaussianNoise", false},
                                                   {"Id", id},
                                                   {"CentralFrequency", nullptr}});
  }
  control.call("SetGpsStartTime", {{"Start", wire::skydel_date(plan_.start)}});
  control.call("SetVehicleTrajectory", {{"Type", "HIL"}});
  control.call("SetHilTjoin", {{"HilTjoin", plan_.join.ns / 1'000'000}});
  const bool is_pair = plan_.vehicles.size() > 1;
  if (index == 0) {
    if (is_pair) control.call("SetSyncServer", {{"Port", settings_.sync_port}});
    control.call("EnableMainInstanceSync", {{"Enabled", true}});
  } else {
    control.call("SetSyncClient", {{"Host", plan_.host}, {"Port", settings_.sync_port}});
    control.call("EnableWorkerInstanceSync", {{"Enabled", true}});
  }
}

void SkydelGenerator::prepare(std::span<const TrajectorySample> first) {
  if (first.size() != plan_.vehicles.size()) throw std::runtime_error("Skydel: a first sample is missing");
  for (std::size_t k = 0; k < plan_.vehicles.size(); ++k) connect(k);
  for (std::size_t k = 0; k < instances_.size(); ++k) configure(k);
  instances_[0].control->call("ArmPPS");
  is_armed_ = true;
  for (std::size_t k = 0; k < instances_.size(); ++k) send(k, first[k]);
}

std::optional<SteadyTime> SkydelGenerator::start() {
  constexpr chrono::milliseconds kEdgePeriods{3000};
  SkydelControl& main = *instances_.at(0).control;
  main.call("WaitAndResetPPS", Json::object(), "SuccessResult", kEdgePeriods);
  main.call("StartPPS", {{"Msec", settings_.start_after_pps.count()}});
  const Json pps0 =
      main.call("GetComputerSystemTimeSinceEpochAtPps0", Json::object(), "GetComputerSystemTimeSinceEpochAtPps0Result");
  for (Instance& instance : instances_) instance.control->call("BeginVehicleInfo");
  if (plan_.pace == Pace::kLockStep) return std::nullopt;
  double pps0_ms = 0.0;
  try {
    pps0_ms = wire::number_field(pps0, "Milliseconds");
  } catch (const wire::WireError& error) {
    main.fail("GetComputerSystemTimeSinceEpochAtPps0", error.what());
  }
  if (pps0_ms <= 0.0) return std::nullopt;
  const auto since_epoch = chrono::duration<double, std::milli>(pps0_ms) + settings_.start_after_pps;
  const auto ahead = since_epoch - chrono::system_clock::now().time_since_epoch();
  return chrono::steady_clock::now() + chrono::duration_cast<chrono::steady_clock::duration>(ahead);
}

void SkydelGenerator::send_datagram(Instance& instance, const wire::Bytes& datagram) {
  try {
    instance.hil->send(datagram);
  } catch (const io::ChannelError& error) {
    instance.control->fail("sending a sample", error.what());
  }
}

void SkydelGenerator::send(std::size_t vehicle, const TrajectorySample& sample) {
  Instance& instance = instances_.at(vehicle);
  instance.last_sample = wire::encode_sample(sample);
  send_datagram(instance, instance.last_sample);
}

void SkydelGenerator::take(Instance& instance, std::span<const std::uint8_t> datagram) {
  try {
    const wire::SkydelHilMessage message = wire::decode_hil(datagram);
    const auto* info = std::get_if<wire::SkydelVehicleInfo>(&message);
    if (info == nullptr) return;
    const fsw::Duration time{static_cast<std::int64_t>(info->time_ms) * 1'000'000};
    instance.reached = std::max(instance.reached.value_or(time), time);
  } catch (const wire::WireError& error) {
    instance.control->fail("vehicle information", error.what());
  }
}

std::optional<fsw::Duration> SkydelGenerator::wait_for(std::size_t vehicle, fsw::Duration time, SteadyTime deadline) {
  constexpr chrono::milliseconds kRepeatAfter{200};
  Instance& instance = instances_.at(vehicle);
  auto repeat_at = chrono::steady_clock::now() + kRepeatAfter;
  while (!instance.reached || *instance.reached < time) {
    std::optional<std::span<const std::uint8_t>> datagram;
    try {
      datagram = instance.hil->receive(std::min(deadline, repeat_at));
    } catch (const io::ChannelError& error) {
      instance.control->fail("vehicle information", error.what());
    }
    if (datagram) {
      take(instance, *datagram);
      continue;
    }
    const auto now = chrono::steady_clock::now();
    if (now >= deadline) break;
    // Nothing has come back: the sample or the information was lost, or the generator does not fly any more.
    const GeneratorState now_state = state(vehicle);
    if (!now_state.error.empty())
      instance.control->fail("GetSimulatorState", fmt::format("the generator reports \"{}\"", now_state.error));
    if (!now_state.is_streaming)
      instance.control->fail("GetSimulatorState",
                             fmt::format("the generator is \"{}\", not streaming", now_state.text));
    if (plan_.pace == Pace::kLockStep && !instance.last_sample.empty()) send_datagram(instance, instance.last_sample);
    repeat_at = now + kRepeatAfter;
  }
  return instance.reached;
}

GeneratorState SkydelGenerator::state(std::size_t vehicle) {
  SkydelControl& control = *instances_.at(vehicle).control;
  const Json answer = control.call("GetSimulatorState", Json::object(), "SimulatorStateResult");
  GeneratorState state;
  try {
    state.text = wire::printable(wire::text_field(answer, "State"));
    state.error = wire::printable(wire::text_field(answer, "Error"));
    state.is_streaming = wire::integer_field(answer, "SubStateId", 0, 1000) == wire::kSkydelSubStateStreaming;
  } catch (const wire::WireError& error) {
    control.fail("GetSimulatorState", error.what());
  }
  if (!state.is_streaming) return state;
  const Json extrapolation = control.call("GetHilExtrapolationState", Json::object(), "GetHilExtrapolationStateResult");
  try {
    state.extrapolation = static_cast<Extrapolation>(wire::integer_field(extrapolation, "State", 0, 2));
  } catch (const wire::WireError& error) {
    control.fail("GetHilExtrapolationState", error.what());
  }
  return state;
}

void SkydelGenerator::stop() noexcept {
  constexpr chrono::milliseconds kStopLimit{1000};
  if (!is_armed_) return;
  is_armed_ = false;
  for (Instance& instance : instances_) {
    try {
      // A generator that does not answer must not delay the end of the run.
      instance.control->call("Stop", Json::object(), "SuccessResult",
                             std::min(kStopLimit - settings_.answer_limit, chrono::milliseconds(0)));
      instance.hil->send(wire::encode_bye());
    } catch (...) {
      // It has gone already, or does not answer: there is nothing left to stop.
    }
  }
}

}  // namespace

const GeneratorKind kSkydelKind = {"skydel", read,
                                   [](const GeneratorPlan& plan, const GeneratorSettings& settings) {
                                     return std::unique_ptr<Generator>(std::make_unique<SkydelGenerator>(
                                         plan, dynamic_cast<const SkydelSettings&>(settings)));
                                   },
                                   true};

}  // namespace vbar::grand
