#include "hil_drivers/grand/grand_bench.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "fsw/gnss/gps_week.h"
#include "hil_drivers/grand/grand_report.h"
#include "hil_drivers/grand/grand_source.h"

namespace vbar::grand {
namespace {

using fsw::Duration;
using fsw::GpsTime;
using twins::gnss::BodyTruth;

// In lock-step: for the generator to fly one sample, and between questions for its state while it does not.
constexpr std::chrono::seconds kProgressLimit{10}, kBetweenStates{1};

}  // namespace

GrandBench::GrandBench(const GrandSettings& settings, const testbeds::RunContext& context)
    : settings_(settings), context_(context), sample_times_(settings.sample_period) {}

GrandBench::~GrandBench() {
  stop();
}

void GrandBench::fail(const std::string& reason) {
  // Its connections are closed before its end is known.
  constexpr std::chrono::milliseconds kEnd{300};
  const auto end = process_ ? process_->end_report(kEnd) : std::nullopt;
  throw std::runtime_error("testbed grand: " + (end ? *end : reason));
}

std::unique_ptr<twins::gnss::ReceiverBytes> GrandBench::make_receiver(const testbeds::ReceiverPlan& plan) {
  vehicles_.emplace_back(plan);
  return std::make_unique<GrandSource>(shared_from_this(), vehicles_.size() - 1);
}

void GrandBench::start(GpsTime first_epoch) {
  if (is_started_) return;
  is_started_ = true;
  start_ = first_epoch;
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
  } catch (const std::runtime_error& error) {
    fail(error.what());
  }
}

BodyTruth GrandBench::truth_at(const std::string& spacecraft, GpsTime time) const {
  const twins::TruthSnapshot truth = context_.outlook.at(time);
  const twins::SpacecraftTruth* const one = truth.find(spacecraft);
  if (one == nullptr || !one->attitude)
    throw std::runtime_error("spacecraft \"" + spacecraft + "\" has no attitude, and its antenna no direction");
  return twins::gnss::body_truth(truth, *one);
}

/// Offset of the receiver's epochs after each multiple of their period in GPS time; the mission counts from its flight
/// steps.
Duration GrandBench::log_offset(const testbeds::ReceiverPlan& plan) const {
  const Duration period = fsw::nearest_duration(plan.settings.output.period_s);
  const Duration after_step = fsw::nearest_duration(plan.line.log_offset_s);
  return {(fsw::gnss::time_of_week(start_).ns + after_step.ns) % period.ns};
}

std::string GrandBench::device_of(const testbeds::ReceiverPlan& plan) const {
  if (!plan.line.port.empty()) return plan.line.port;
  if (process_) {
    const auto& receivers = addresses_.receivers;
    const auto found = receivers.find(plan.spacecraft);
    if (found != receivers.end()) return found->second;
  }
  throw std::runtime_error(fmt::format(
      "the receiver of {} has no port: neither sensors.gnss.port nor the bench names one", plan.spacecraft));
}

LinkPlan GrandBench::link_plan(const testbeds::ReceiverPlan& plan, const BodyTruth& truth) const {
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

void GrandBench::start_vehicles(GpsTime first_epoch) {
  for (Vehicle& vehicle : vehicles_) {
    const testbeds::ReceiverPlan& plan = vehicle.plan;
    const ReceiverEpochs epochs{fsw::nearest_duration(plan.settings.output.period_s), log_offset(plan)};
    vehicle.trajectory.emplace(plan.settings.body_frame, epochs, first_epoch, context_.mission.seed, plan.spacecraft);
    vehicle.link = std::make_unique<ReceiverLink>(link_plan(plan, truth_at(plan.spacecraft, first_epoch)));
  }
}

std::vector<std::uint16_t> GrandBench::control_ports() const {
  if (settings_.control_port == 0) return addresses_.control_ports;
  std::vector<std::uint16_t> ports;
  const std::size_t count = settings_.generator->has_instance_per_vehicle ? vehicles_.size() : 1;
  for (std::size_t k = 0; k < count; ++k) ports.push_back(static_cast<std::uint16_t>(settings_.control_port + k));
  return ports;
}

void GrandBench::start_generator() {
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

void GrandBench::begin(report::RunRecord& record, const std::filesystem::path& folder) {
  record_ = &record;
  if (!folder.empty())
    for (Vehicle& vehicle : vehicles_) vehicle.link->keep_in(folder);
  try {
    if (settings_.pace == Pace::kRealTime) time_base_.emplace(start_, edge_source(), settings_.chrony);
    const auto host_start = generator_->start();
    if (time_base_) time_base_->begin(host_start);
  } catch (const std::runtime_error& error) {
    fail(error.what());
  }
}

std::string GrandBench::edge_source() const {
  return settings_.pps == kEdgesOfBench ? "socket:" + addresses_.pps : settings_.pps;
}

engine::WallClock* GrandBench::clock() {
  return time_base_ ? &*time_base_ : nullptr;
}

/// The host's line has the same logs, so that their bytes are those that the board's line has carried.
std::optional<io::WiredReceiver> GrandBench::wired_receiver(std::size_t index) const {
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

twins::gnss::ReceiverOutput GrandBench::exchange(std::size_t index, const BodyTruth& truth) {
  try {
    send_sample(index, truth);
    if (settings_.pace == Pace::kLockStep) wait_for_generator(index, truth.time - start_);
    const GpsTime arrival = time_base_ ? std::max(truth.time, time_base_->time()) : truth.time;
    auto output = vehicles_[index].link->take(truth, arrival);
    const bool is_last = index + 1 == vehicles_.size();
    if (is_last && (truth.time - start_).ns % fsw::kNanosecondsPerSecond == 0) end_second(truth.time);
    return output;
  } catch (const std::runtime_error& error) {
    fail(error.what());
  }
}

/// The sample of time zero is the generator's since it was prepared.
void GrandBench::send_sample(std::size_t index, const BodyTruth& truth) {
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

void GrandBench::wait_for_generator(std::size_t index, Duration time) {
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

void GrandBench::poll_states() {
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    GeneratorState& state = vehicles_[k].state;
    state = generator_->state(k);
    if (!state.error.empty())
      throw std::runtime_error(
          fmt::format("the generator of {} reports an error: {}", vehicles_[k].plan.spacecraft, state.error));
  }
}

void GrandBench::end_second(GpsTime now) {
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

void GrandBench::stop() noexcept {
  if (std::exchange(is_stopped_, true)) return;
  if (generator_) generator_->stop();
  for (Vehicle& vehicle : vehicles_)
    if (vehicle.link) vehicle.link->close();
  if (process_) process_->stop();
}

void GrandBench::finish() noexcept {
  if (record_ == nullptr) return;
  RunFigures figures;
  figures.pace = settings_.pace;
  figures.generator = settings_.generator->name;
  figures.is_emulated = process_.has_value();
  if (process_) {
    figures.bench_files = process_->files();
    figures.faults = process_->faults();
  }
  if (time_base_ && time_base_->edges() != nullptr) figures.edges = time_base_->edges()->statistics();
  for (const Vehicle& vehicle : vehicles_)
    if (vehicle.link) figures.receivers.emplace_back(vehicle.plan.spacecraft, vehicle.link->statistics());
  add_figures(figures, *record_);
  record_ = nullptr;
}

}  // namespace vbar::grand
