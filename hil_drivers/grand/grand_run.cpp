#include "hil_drivers/grand/grand_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fsw/gnss/gps_week.h"
#include "hil_drivers/grand/grand_report.h"
#include "hil_drivers/grand/pps/edge_source.h"
#include "host_sim/mission/mission.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/twins/gnss/gnss_receiver.h"

namespace vbar::grand {

namespace {

using mission::from_to;
using mission::TableReader;

constexpr mission::Names<Pace, 2> kPaces{{{"lock_step", Pace::kLockStep}, {"real_time", Pace::kRealTime}}};

void read_generator(const TableReader& section, GrandSettings& settings) {
  const auto kinds = generator_kinds();
  std::vector<std::string_view> names;
  for (const GeneratorKind* const kind : kinds) names.push_back(kind->name);
  const std::string name = section.choice("generator", names, names.front());
  settings.generator = *std::ranges::find(kinds, name, &GeneratorKind::name);
  // Tables of the other generators may stand in the file: a mission is switched between them by one key.
  for (const GeneratorKind* const kind : kinds) {
    if (kind != settings.generator && !section.has(kind->name)) continue;
    auto read = kind->read(section.table(kind->name));
    if (kind == settings.generator) settings.generator_settings = std::move(read);
  }
}

void read_edges(const TableReader& section, GrandSettings& settings) {
  settings.pps = section.text("pps", "none");
  const bool is_of_bench = settings.pps == kEdgesOfBench && !settings.bench.empty();
  if (settings.pps != "none" && !is_of_bench && find_edge_source(settings.pps) == nullptr)
    section.refuse_value("pps", "none, " + edge_source_forms() + " or, with a bench, " + kEdgesOfBench);
  if (settings.pace == Pace::kLockStep && settings.pps != "none")
    section.refuse_value("pps", "none, as pace is lock_step: simulated time waits for the generator");
  settings.chrony = section.text("chrony", "");
  if (!settings.chrony.empty() && settings.pps == "none")
    section.refuse_value("chrony", "nothing, as pps is none: there are no edges to forward");
}

}  // namespace

std::shared_ptr<const mission::TestbedSettings> read_grand(const TableReader& section) {
  auto settings = std::make_shared<GrandSettings>();
  read_generator(section, *settings);
  settings->bench = section.text("bench", "");
  settings->host = section.text("host", settings->host);
  const bool is_required = settings->bench.empty();
  settings->control_port = static_cast<std::uint16_t>(
      section.integer("control_port", is_required ? 1 : 0, 65534, is_required ? std::nullopt : std::optional(0)));
  settings->hil_port = static_cast<std::uint16_t>(section.integer("hil_port", 0, 65535, 0));
  // Samples lie on whole milliseconds, and one lies on every second.
  constexpr std::array<std::int64_t, 8> kRates{1, 2, 4, 5, 10, 20, 25, 50};
  const std::int64_t rate_hz = section.integer("rate_hz", 1, 50, 10);
  if (std::ranges::find(kRates, rate_hz) == kRates.end())
    section.refuse_value("rate_hz", "1, 2, 4, 5, 10, 20, 25 or 50");
  settings->sample_period = fsw::Duration{fsw::kNanosecondsPerSecond / rate_hz};
  settings->pace = section.choice<Pace>("pace", kPaces, Pace::kLockStep);
  settings->lead = section.span("lead_ms", 1e-3, from_to(0.0, 1000.0), 0.0);
  if (settings->pace == Pace::kLockStep && settings->lead.ns != 0)
    section.refuse_value("lead_ms", "0, as pace is lock_step: the generator waits for its samples");
  settings->join = section.span("join_ms", 1e-3, from_to(0.0, 10000.0), 165.0);
  read_edges(section, *settings);
  settings->give_up = section.span("give_up_s", 1.0, from_to(1.0, 1e6), 300.0);
  settings->week_shift = section.flag("week_shift", false);
  settings->on_failure = testbeds::read_on_failure(section);
  if (settings->on_failure == testbeds::OnFailure::kTwin && settings->pace == Pace::kRealTime)
    section.refuse_value("on_failure", "stop, as pace is real_time: the generator's time is the run's");
  section.finish();
  return settings;
}

TestbedAddresses read_addresses(const std::filesystem::path& file) {
  TestbedAddresses addresses;
  try {
    std::ifstream stream(file);
    const nlohmann::json json = nlohmann::json::parse(stream);
    for (const auto& port : json.at("control_ports")) {
      const int number = port.get<int>();
      if (number < 1 || number > 65535) throw std::runtime_error("control port " + std::to_string(number));
      addresses.control_ports.push_back(static_cast<std::uint16_t>(number));
    }
    addresses.pps = json.value("pps", "");
    for (const auto& [spacecraft, ports] : json.at("receivers").items()) {
      addresses.receivers.emplace(spacecraft, ports.at("com1").get<std::string>());
      if (ports.contains("com2")) addresses.board_lines.emplace(spacecraft, ports.at("com2").get<std::string>());
    }
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": not the addresses of a bench: " + error.what());
  }
  return addresses;
}

namespace {

using fsw::Duration;
using fsw::GpsTime;
using twins::gnss::BodyTruth;

// In lock-step: for the generator to fly one sample, and between questions for its state while it does not.
constexpr std::chrono::seconds kProgressLimit{10}, kBetweenStates{1};

}  // namespace

GrandRun::GrandRun(const GrandSettings& settings, const testbeds::RunContext& context)
    : settings_(settings), context_(context), sample_times_(settings.sample_period) {}

GrandRun::~GrandRun() {
  stop();
}

std::runtime_error GrandRun::error_of(const std::string& reason) {
  // Its connections are closed before its end is known.
  constexpr std::chrono::milliseconds kEnd{300};
  const auto end = process_ ? process_->end_report(kEnd) : std::nullopt;
  return std::runtime_error("testbed grand: " + (end ? *end : reason));
}

std::unique_ptr<twins::gnss::ReceiverBytes> GrandRun::make_receiver(const testbeds::ReceiverPlan& plan) {
  if (settings_.on_failure == testbeds::OnFailure::kTwin && plan.line.wired == testbeds::Wiring::kBoard)
    throw std::runtime_error("testbed grand: on_failure = \"twin\" and the receiver of " + plan.spacecraft +
                             " is wired to the board, which no twin is");
  vehicles_.emplace_back(plan);
  return std::make_unique<GrandSource>(shared_from_this(), vehicles_.size() - 1);
}

void GrandRun::start(GpsTime first_epoch) {
  if (is_started_) return;
  is_started_ = true;
  start_ = first_epoch;
  const auto begin = std::chrono::steady_clock::now();
  try {
    if (start_.ns % fsw::kNanosecondsPerSecond != 0)
      throw std::runtime_error("the run does not start on a whole second of GPS time, as a generator does");
    if (!settings_.bench.empty()) {
      process_.emplace(settings_.bench, context_.mission.seed, context_.data_directory);
      addresses_ = read_addresses(process_->addresses_file());
    }
    start_vehicles(first_epoch);
    start_generator();
    for (Vehicle& vehicle : vehicles_) vehicle.link->open();
    use_.start_wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  } catch (const std::runtime_error& error) {
    throw error_of(error.what());
  }
}

BodyTruth GrandRun::truth_at(const std::string& spacecraft, GpsTime time) const {
  const twins::TruthSnapshot truth = context_.outlook.at(time);
  const twins::SpacecraftTruth* const one = truth.find(spacecraft);
  if (one == nullptr || !one->attitude)
    throw std::runtime_error("spacecraft \"" + spacecraft + "\" has no attitude, and its antenna no direction");
  return twins::gnss::body_truth(truth, *one);
}

/// Offset of the receiver's epochs after each multiple of their period in GPS time; the mission counts from its flight
/// steps.
Duration GrandRun::log_offset(const testbeds::ReceiverPlan& plan) const {
  const Duration period = fsw::nearest_duration(plan.settings.output.period_s);
  const Duration after_step = fsw::nearest_duration(plan.line.log_offset_s);
  return {(fsw::gnss::time_of_week(start_).ns + after_step.ns) % period.ns};
}

std::string GrandRun::device_of(const testbeds::ReceiverPlan& plan) const {
  if (!plan.line.port.empty()) return plan.line.port;
  if (process_) {
    const auto& receivers = addresses_.receivers;
    const auto found = receivers.find(plan.spacecraft);
    if (found != receivers.end()) return found->second;
  }
  throw std::runtime_error(fmt::format(
      "the receiver of {} has no port: neither sensors.gnss.port nor the bench names one", plan.spacecraft));
}

LinkPlan GrandRun::link_plan(const testbeds::ReceiverPlan& plan, const BodyTruth& truth) const {
  LinkPlan link;
  link.spacecraft = plan.spacecraft;
  link.device = device_of(plan);
  ReceiverConfiguration& configuration = link.configuration;
  configuration.baud = static_cast<unsigned>(plan.line.baud);
  configuration.start = plan.settings.start.mode;
  configuration.approximate_time = start_;
  configuration.approximate_position_ecef_m = truth.R_ecef_eci * truth.position_eci;
  configuration.clock_adjust = plan.line.clock_adjust;
  configuration.period_s = plan.settings.output.period_s;
  configuration.log_offset_s = fsw::seconds(log_offset(plan));
  link.period = fsw::nearest_duration(plan.settings.output.period_s);
  link.give_up = settings_.give_up;
  link.max_latency = fsw::nearest_duration(plan.line.max_latency_s);
  link.week_shift = settings_.week_shift;
  link.pace = settings_.pace;
  if (plan.line.wired == testbeds::Wiring::kBoard) {
    link.bytes_bypass_host = true;
    configuration.board_port = "COM2";
  }
  return link;
}

void GrandRun::start_vehicles(GpsTime first_epoch) {
  for (Vehicle& vehicle : vehicles_) {
    const testbeds::ReceiverPlan& plan = vehicle.plan;
    const ReceiverEpochs epochs{fsw::nearest_duration(plan.settings.output.period_s), log_offset(plan)};
    vehicle.trajectory.emplace(plan.settings.body_frame, epochs, first_epoch, context_.mission.seed, plan.spacecraft);
    const GpsTime next = first_epoch + settings_.sample_period;
    vehicle.trajectory->observe_earth(next, truth_at(plan.spacecraft, next).R_ecef_eci);
    vehicle.link = std::make_unique<ReceiverLink>(link_plan(plan, truth_at(plan.spacecraft, first_epoch)));
  }
}

std::vector<std::uint16_t> GrandRun::control_ports() const {
  if (settings_.control_port == 0) return addresses_.control_ports;
  std::vector<std::uint16_t> ports;
  const std::size_t count = settings_.generator->has_instance_per_vehicle ? vehicles_.size() : 1;
  for (std::size_t k = 0; k < count; ++k) ports.push_back(static_cast<std::uint16_t>(settings_.control_port + k));
  return ports;
}

void GrandRun::start_generator() {
  GeneratorPlan plan;
  plan.start = start_;
  plan.sample_period = settings_.sample_period;
  plan.join = settings_.join;
  plan.pace = settings_.pace;
  plan.host = settings_.host;
  plan.control_ports = control_ports();
  plan.hil_port = settings_.hil_port;
  std::vector<TrajectorySample> first;
  for (Vehicle& vehicle : vehicles_) {
    plan.vehicles.push_back(vehicle.plan.spacecraft);
    first.push_back(vehicle.trajectory->at(truth_at(vehicle.plan.spacecraft, start_)));
    vehicle.last_sample = Duration{0};
  }
  generator_ = settings_.generator->make(plan, *settings_.generator_settings);
  generator_->prepare(first);
}

void GrandRun::begin(report::RunRecord& record, const std::filesystem::path& folder) {
  record_ = &record;
  if (!folder.empty())
    for (Vehicle& vehicle : vehicles_) vehicle.link->keep_in(folder);
  try {
    if (settings_.pace == Pace::kRealTime) time_base_.emplace(start_, edge_source(), settings_.chrony);
    const auto host_start = generator_->start();
    if (time_base_) time_base_->begin(host_start);
  } catch (const std::runtime_error& error) {
    throw error_of(error.what());
  }
}

std::string GrandRun::edge_source() const {
  return settings_.pps == kEdgesOfBench ? "socket:" + addresses_.pps : settings_.pps;
}

engine::WallClock* GrandRun::clock() {
  return time_base_ ? &*time_base_ : nullptr;
}

/// The host's line has the same logs, so that their bytes are those that the board's line has carried.
std::optional<io::WiredReceiver> GrandRun::wired_receiver(std::size_t index) const {
  const Vehicle& vehicle = vehicles_[index];
  if (vehicle.plan.line.wired != testbeds::Wiring::kBoard || !vehicle.link) return std::nullopt;
  io::WiredReceiver receiver;
  receiver.baud = static_cast<unsigned>(vehicle.plan.line.baud);
  if (process_) {
    const auto& lines = addresses_.board_lines;
    if (const auto found = lines.find(vehicle.plan.spacecraft); found != lines.end()) receiver.device = found->second;
  }
  receiver.in_lock_step = settings_.pace == Pace::kLockStep;
  if (receiver.in_lock_step) receiver.bytes_sent = [link = vehicle.link.get()] { return link->message_bytes(); };
  return receiver;
}

twins::gnss::ReceiverOutput GrandRun::exchange(std::size_t index, const BodyTruth& truth) {
  Vehicle& vehicle = vehicles_[index];
  if (vehicle.twin) return output_of_twin(vehicle, truth);
  try {
    return exchange_by_testbed(index, truth);
  } catch (const std::runtime_error& error) {
    if (settings_.on_failure == testbeds::OnFailure::kStop) throw;
    hand_over(truth.time, error.what());
    auto output = output_of_twin(vehicle, truth);
    output.notes.push_back({"testbed_handed_over", std::numeric_limits<double>::quiet_NaN(), error.what()});
    return output;
  }
}

/// Both receivers, which share a sky.
void GrandRun::hand_over(GpsTime time, const std::string& reason) {
  std::cerr << reason << "; the digital twins of the receivers take over\n";
  use_.handed_over_h = fsw::seconds(time - context_.mission.epoch) / 3600.0;
  use_.failure = reason;
  stop();
  const mission::Mission& mission = context_.mission;
  const auto sky = std::make_shared<const twins::gnss::Constellation>(
      context_.data_directory, mission::shared_settings<sensors::GnssShared>(mission).constellation,
      mission.start_time(), mission.seed);
  for (Vehicle& vehicle : vehicles_)
    vehicle.twin = std::make_unique<twins::gnss::GnssReceiver>(vehicle.plan.settings, sky, context_.data_directory,
                                                               mission.seed, vehicle.plan.spacecraft);
}

twins::gnss::ReceiverOutput GrandRun::output_of_twin(Vehicle& vehicle, const BodyTruth& truth) const {
  const Duration period = fsw::nearest_duration(vehicle.plan.settings.output.period_s);
  if ((truth.time - start_).ns % period.ns == 0) return vehicle.twin->output_at(truth);
  twins::gnss::ReceiverOutput between;
  between.is_epoch = false;
  return between;
}

twins::gnss::ReceiverOutput GrandRun::exchange_by_testbed(std::size_t index, const BodyTruth& truth) {
  try {
    send_sample(index, truth);
    if (settings_.pace == Pace::kLockStep) wait_for_generator(index, truth.time - start_);
    const GpsTime arrival = time_base_ ? std::max(truth.time, time_base_->time()) : truth.time;
    auto output = vehicles_[index].link->take(truth, arrival);
    const bool is_last = index + 1 == vehicles_.size();
    if (is_last && (truth.time - start_).ns % fsw::kNanosecondsPerSecond == 0) end_second(truth.time);
    return output;
  } catch (const std::runtime_error& error) {
    throw error_of(error.what());
  }
}

/// The sample of time zero is the generator's since it was prepared.
void GrandRun::send_sample(std::size_t index, const BodyTruth& truth) {
  Vehicle& vehicle = vehicles_[index];
  const GpsTime time = truth.time + settings_.lead;
  if (time - start_ <= vehicle.last_sample) return;
  const BodyTruth ahead = settings_.lead.ns == 0 ? truth : truth_at(vehicle.plan.spacecraft, time);
  const TrajectorySample sample = vehicle.trajectory->at(ahead);
  generator_->send(index, sample);
  const auto lead = time_base_ ? std::optional(time - time_base_->time()) : std::nullopt;
  sample_times_.add(sample.time, vehicle.last_sample, lead);
  vehicle.last_sample = sample.time;
}

void GrandRun::wait_for_generator(std::size_t index, Duration time) {
  if (time.ns == 0) return;
  const auto limit = std::chrono::steady_clock::now() + kProgressLimit;
  std::optional<Duration> reached;
  while (std::chrono::steady_clock::now() < limit) {
    reached = generator_->wait_for(index, time, std::chrono::steady_clock::now() + kBetweenStates);
    if (reached && *reached >= time) return;
    poll_states();  // which may have the reason
  }
  throw std::runtime_error(
      fmt::format("the generator has not flown {} to {:.1f} s within {} s ({})", vehicles_[index].plan.spacecraft,
                  fsw::seconds(time), kProgressLimit.count(),
                  reached ? fmt::format("it reports {:.3f} s", fsw::seconds(*reached)) : "it reports no progress"));
}

void GrandRun::poll_states() {
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    GeneratorState& state = vehicles_[k].state;
    state = generator_->state(k);
    if (!state.error.empty())
      throw std::runtime_error(
          fmt::format("the generator of {} reports an error: {}", vehicles_[k].plan.spacecraft, state.error));
  }
}

void GrandRun::end_second(GpsTime now) {
  poll_states();
  GrandRow row;
  row.time_s = fsw::seconds(now - context_.mission.epoch);
  const SampleTimes::Second samples = sample_times_.take();
  row.samples = samples.samples;
  row.samples_late = samples.late;
  row.samples_missing = samples.missing;
  row.sample_lead_min_ms = samples.lead_min_ms;
  if (samples.lead_min_ms) row.sample_lead_mean_ms = samples.lead_sum_ms / static_cast<double>(samples.samples);
  if (time_base_ && time_base_->edges() != nullptr) {
    row.edge_s = time_base_->last_edge_s();
    row.host_minus_edge_ms = 1e3 * time_base_->edges()->host_minus_edge_s();
  }
  for (const Vehicle& vehicle : vehicles_) {
    row.generator_state = vehicle.state.text;
    if (const auto extrapolation = vehicle.state.extrapolation)
      row.extrapolation = std::max(row.extrapolation.value_or(0.0), static_cast<double>(*extrapolation));
  }
  row.servicer = vehicles_.front().link->second();
  if (vehicles_.size() > 1) row.target = vehicles_[1].link->second();
  if (record_ != nullptr) record_->tables.rows<GrandRow>().push_back(row);
}

void GrandRun::stop() noexcept {
  if (std::exchange(is_stopped_, true)) return;
  if (generator_) generator_->stop();
  for (Vehicle& vehicle : vehicles_)
    if (vehicle.link) vehicle.link->close();
  if (process_) process_->stop();
}

void GrandRun::finish() noexcept {
  if (record_ == nullptr) return;
  RunFigures figures;
  figures.pace = settings_.pace;
  figures.generator = settings_.generator->name;
  // By what the devices state: an emulated bench may have been started by hand.
  figures.is_emulated =
      process_.has_value() || (generator_ && generator_->is_emulated()) ||
      std::ranges::any_of(vehicles_, [](const Vehicle& one) { return one.link && one.link->is_emulated(); });
  if (process_) {
    figures.bench_files = process_->files();
    figures.faults = process_->faults();
    figures.generator_counters = process_->counters();
  }
  if (time_base_ && time_base_->edges() != nullptr) figures.edges = time_base_->edges()->statistics();
  for (const Vehicle& vehicle : vehicles_)
    if (vehicle.link) figures.receivers.emplace_back(vehicle.plan.spacecraft, vehicle.link->statistics());
  add_figures(figures, *record_);
  use_.add_to(record_->summary.testbeds["grand"]);
  record_ = nullptr;
}

GrandSource::GrandSource(std::shared_ptr<GrandRun> bench, std::size_t vehicle)
    : bench_(std::move(bench)), vehicle_(vehicle) {}

void GrandSource::start(fsw::GpsTime first_epoch) {
  bench_->start(first_epoch);
}

void GrandSource::stop(twins::StopReason /*reason*/) {
  bench_->stop();
}

std::optional<fsw::Duration> GrandSource::call_period() const {
  return bench_->sample_period();
}

std::optional<io::WiredReceiver> GrandSource::wired_receiver() const {
  return bench_->wired_receiver(vehicle_);
}

twins::gnss::ReceiverOutput GrandSource::output_at(const twins::gnss::BodyTruth& truth) {
  return bench_->exchange(vehicle_, truth);
}

namespace {

std::optional<engine::ClockMode> clock_mode(const mission::TestbedSettings& settings) {
  return dynamic_cast<const GrandSettings&>(settings).pace == Pace::kRealTime ? engine::ClockMode::kRealTime
                                                                              : engine::ClockMode::kLockStep;
}

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<GrandRun>(dynamic_cast<const GrandSettings&>(settings), context);
}

}  // namespace

const testbeds::TestbedKind kGrand{{"grand", read_grand, clock_mode}, open, {tables, summarise, sections}};

}  // namespace vbar::grand
