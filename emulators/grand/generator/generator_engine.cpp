#include "emulators/grand/generator/generator_engine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand::bench {
namespace {

using fsw::Duration;
using fsw::GpsTime;

constexpr std::chrono::milliseconds kTick{5};
constexpr Duration kSilence = fsw::duration_of_seconds(1);  // of samples, that the terminal names
// Before any command: the day of the GPS elements. Nothing is radiated and no message is heard before a start time has
// been set.
constexpr GpsTime kDefaultEpoch = twins::gnss::gps_time_of(twins::gnss::System::kGps, 1658, 4 * 86400);
constexpr GpsTime kEarliest = twins::gnss::gps_time_of(twins::gnss::System::kBeidou, 0, 86400);
constexpr GpsTime kLatest{std::int64_t{6'900'000'000} * fsw::kNanosecondsPerSecond};  // year 2198

std::int64_t monotonic_ns(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

const char* name_of(EngineState state) {
  switch (state) {
    case EngineState::kIdle:
      return "idle";
    case EngineState::kConfigured:
      return "configured";
    case EngineState::kArmed:
      return "armed";
    case EngineState::kStreaming:
      return "streaming";
    case EngineState::kStopped:
      return "stopped";
    case EngineState::kError:
      return "in error";
  }
  return "";
}

}  // namespace

GeneratorEngine::GeneratorEngine(boost::asio::io_context& context, const Scenario& scenario,
                                 const std::filesystem::path& data_directory, const std::filesystem::path& directory,
                                 const ReceiverFactory& make_receiver)
    : scenario_(scenario),
      data_directory_(data_directory),
      constellation_(std::make_shared<twins::gnss::Constellation>(data_directory, scenario.constellation, kDefaultEpoch,
                                                                  scenario.seed)),
      pattern_(twins::gnss::AntennaPattern::load(data_directory)),
      warned_(scenario.vehicles.size(), false),
      sample_faults_(scenario.vehicles.size()),
      join_(scenario.join),
      edge_jitter_(scenario.seed, "grand/pps"),
      timer_(context),
      origin_(Clock::now()),
      last_edge_(origin_),
      last_tick_(origin_) {
  for (std::size_t index = 0; index < scenario.vehicles.size(); ++index) {
    const VehicleScenario& vehicle = scenario.vehicles[index];
    vehicles_.push_back(std::make_unique<Vehicle>(context, directory, vehicle.name, vehicle.com_ports, scenario.seed,
                                                  make_receiver(index, constellation_)));
    vehicles_.back()->reset(join_);
    vehicles_.back()->receiver().power(true);
    vehicles_.back()->answer_at_once(is_lock_step());
  }
  wait_for_tick();
}

void GeneratorEngine::reset() {
  end(EngineState::kIdle);
  error_.clear();
  start_time_.reset();
  join_ = scenario_.join;
  edges_sent_ = 0;
  system_time_at_pps0_ms_ = 0;
  warned_.assign(vehicles_.size(), false);
  for (SampleFaults& faults : sample_faults_) faults.held.reset();
  for (const auto& vehicle : vehicles_) vehicle->reset(join_);
}

std::string GeneratorEngine::set_start_time(GpsTime time) {
  if (state_ == EngineState::kStreaming) return "The start time cannot be set while the generator radiates.";
  if (time.ns % fsw::kNanosecondsPerSecond != 0) return "The start time is not a whole second.";
  const GpsTime radiated = time + scenario_.start_shift;
  if (radiated < kEarliest || radiated > kLatest) return "The start time is not between the years 2006 and 2198.";
  start_time_ = radiated;
  // The receivers hold this object; none of them looks at it before the first block.
  *constellation_ = twins::gnss::Constellation(data_directory_, scenario_.constellation, radiated, scenario_.seed);
  if (state_ == EngineState::kIdle) state_ = EngineState::kConfigured;
  return {};
}

std::string GeneratorEngine::set_join(Duration join) {
  if (join.ns < 1'000'000 || join.ns > 10'000'000'000) return "The join time is not between 1 ms and 10 s.";
  join_ = join;
  for (const auto& vehicle : vehicles_) vehicle->motion().set_join(join);
  return {};
}

std::string GeneratorEngine::arm() {
  if (!start_time_) return "The generator cannot be armed: it has no start time.";
  if (state_ == EngineState::kStreaming) return "The generator cannot be armed: it radiates.";
  if (state_ == EngineState::kError) return error_;
  state_ = EngineState::kArmed;
  if (is_lock_step()) wait_for_tick();
  return {};
}

std::string GeneratorEngine::start(Duration delay) {
  if (state_ != EngineState::kArmed)
    return fmt::format("The generator cannot be started: it is {}, not armed.", name_of(state_));
  zero_ = last_edge_ + on_the_wall(delay);
  if (!is_lock_step())
    for (const auto& vehicle : vehicles_) vehicle->motion().set_advance(scenario_.engine_latency);
  const auto orbits = std::make_shared<SatelliteOrbits>(constellation_, *start_time_);
  for (const auto& vehicle : vehicles_)
    vehicle->start(std::make_unique<Sky>(scenario_.sky, orbits, pattern_, scenario_.seed, vehicle->name()));
  state_ = EngineState::kStreaming;
  if (!is_lock_step()) return {};
  for (const auto& vehicle : vehicles_) {
    vehicle->poll_lines();
    vehicle->answer_at_once(false);
  }
  for (std::size_t index = 0; index < vehicles_.size(); ++index)
    if (vehicles_[index]->motion().is_defined()) fly(index, vehicles_[index]->motion().newest());
  return {};
}

void GeneratorEngine::stop() {
  if (state_ == EngineState::kStreaming || state_ == EngineState::kArmed) end(EngineState::kStopped);
}

void GeneratorEngine::fail(std::string error) {
  error_ = std::move(error);
  end(EngineState::kError);
}

void GeneratorEngine::end(EngineState state) {
  state_ = state;
  for (const auto& vehicle : vehicles_) vehicle->answer_at_once(is_lock_step());
}

void GeneratorEngine::damage_samples(std::size_t vehicle, SampleFault fault, std::uint64_t count) {
  sample_faults_[vehicle].kind = fault;
  sample_faults_[vehicle].remaining = count;
}

void GeneratorEngine::sample(std::size_t vehicle, const TrajectorySample& sample) {
  SampleFaults& faults = sample_faults_[vehicle];
  if (faults.remaining == 0 && !faults.held) return receive(vehicle, sample);
  if (const std::optional<TrajectorySample> held = std::exchange(faults.held, std::nullopt)) {
    receive(vehicle, sample);
    return receive(vehicle, *held);
  }
  --faults.remaining;
  ++faults.damaged;
  switch (faults.kind) {
    case SampleFault::kLost:
      return;
    case SampleFault::kDoubled:
      receive(vehicle, sample);
      return receive(vehicle, sample);
    case SampleFault::kSwapped:
      faults.held = sample;
      return;
  }
}

// In lock-step what the host wrote to the lines before it sent the sample is heard before the sample's time passes. A
// doubled sample flies nothing, but its sender may be waiting for the progress again.
void GeneratorEngine::receive(std::size_t vehicle, const TrajectorySample& sample) {
  Vehicle& v = *vehicles_[vehicle];
  v.motion().receive(sample);
  if (state_ != EngineState::kStreaming || !is_lock_step() || !v.motion().is_defined()) return;
  v.poll_lines();
  fly(vehicle, v.motion().newest());
}

void GeneratorEngine::fly(std::size_t vehicle, Duration time) {
  Vehicle& v = *vehicles_[vehicle];
  while (v.blocks_end() + RfBlock::kLength <= time) {
    v.fly(v.blocks_end() + RfBlock::kLength);
    if (is_lock_step()) send_edges();
    if (on_advance) on_advance();
    if (state_ != EngineState::kStreaming) return;  // a fault
  }
  v.fly(time);
  report_extrapolation(vehicle);
  for (const auto& listener : on_progress) listener(vehicle);
}

void GeneratorEngine::report_extrapolation(std::size_t vehicle) {
  const VehicleMotion& motion = vehicles_[vehicle]->motion();
  const bool is_missing = motion.is_defined() && motion.age() > kSilence;
  if (is_missing && !warned_[vehicle])
    fmt::print(stderr, "vbar_grand_bench: {}: no sample for {:.1f} s, the motion is extrapolated\n",
               vehicles_[vehicle]->name(), fsw::seconds(motion.age()));
  warned_[vehicle] = is_missing;
}

VehicleReport GeneratorEngine::report(std::size_t vehicle) const {
  const Vehicle& v = *vehicles_[vehicle];
  const MotionCounters& counters = v.motion().counters();
  VehicleReport report;
  report.time = v.motion().now();
  report.extrapolation = v.seconds_since_snap() <= 1.0 ? 2 : (v.motion().is_deterministic() ? 0 : 1);
  report.extrapolated_s = fsw::seconds(v.motion().age());
  report.samples = counters.samples;
  report.late = counters.late;
  report.doubled = counters.doubled;
  report.snaps = counters.snaps;
  report.out_of_order = counters.out_of_order;
  report.rejected = counters.rejected;
  return report;
}

TrajectorySample GeneratorEngine::flown(std::size_t vehicle, Duration time) const {
  return vehicles_[vehicle]->motion().flown(time);
}

std::optional<Duration> GeneratorEngine::time_of(std::size_t vehicle) const {
  if (state_ != EngineState::kStreaming) return std::nullopt;
  return vehicles_[vehicle]->blocks_end();
}

std::optional<Duration> GeneratorEngine::time() const {
  std::optional<Duration> least;
  for (std::size_t index = 0; index < vehicles_.size(); ++index) {
    const std::optional<Duration> time = time_of(index);
    if (time && (!least || *time < *least)) least = time;
  }
  return least;
}

// Lock-step: at each second that all vehicles have reached.
void GeneratorEngine::send_edges() {
  const std::optional<Duration> reached = time();
  while (reached && Duration{edges_sent_ * fsw::kNanosecondsPerSecond} <= *reached)
    send_edge(edges_sent_, monotonic_ns(Clock::now()));
}

void GeneratorEngine::send_edge(std::uint32_t count, std::int64_t time_ns) {
  edges_sent_ = count + 1;
  const double jitter_ns = scenario_.pps_jitter_ns * edge_jitter_.normal();
  const Duration since_start{count * fsw::kNanosecondsPerSecond};
  if (on_edge) on_edge({*start_time_ + since_start, time_ns + std::llround(jitter_ns), count});
}

// In lock-step the only use of time is that somebody waits for an edge before the start: it comes at once.
void GeneratorEngine::wait_for_tick() {
  if (is_lock_step() && state_ != EngineState::kArmed) return;
  timer_.expires_after(kTick);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    if (is_lock_step()) {
      free_running_edge(Clock::now());
    } else {
      tick(Clock::now());
    }
    wait_for_tick();
  });
}

std::chrono::nanoseconds GeneratorEngine::on_the_wall(Duration span) const {
  return std::chrono::nanoseconds(std::llround(static_cast<double>(span.ns) / scenario_.speed_factor));
}

Duration GeneratorEngine::of_the_generator(Clock::duration span) const {
  const auto ns = static_cast<double>(std::chrono::nanoseconds(span).count());
  return {std::llround(ns * scenario_.speed_factor)};
}

void GeneratorEngine::free_running_edge(Clock::time_point edge) {
  last_edge_ = edge;
  if (on_next_edge.empty()) return;
  const auto since = Clock::now() - edge;
  const auto system = std::chrono::system_clock::now().time_since_epoch() - since;
  system_time_at_pps0_ms_ = std::chrono::duration_cast<std::chrono::milliseconds>(system).count();
  for (const auto& waiting : std::exchange(on_next_edge, {})) waiting();
}

void GeneratorEngine::tick(Clock::time_point now) {
  const Duration elapsed = of_the_generator(now - last_tick_);
  last_tick_ = now;
  if (state_ != EngineState::kStreaming) {
    const auto second = on_the_wall(fsw::duration_of_seconds(1));
    if (now - last_edge_ >= second) free_running_edge(last_edge_ + (now - last_edge_) / second * second);
    for (const auto& vehicle : vehicles_) vehicle->idle(elapsed);
    if (on_advance) on_advance();
    return;
  }
  for (;;) {
    const Clock::time_point edge = zero_ + on_the_wall(fsw::duration_of_seconds(edges_sent_));
    if (now < edge) break;
    send_edge(edges_sent_, monotonic_ns(edge));
  }
  const Duration time = of_the_generator(now - zero_);
  if (time.ns < 0) {
    for (const auto& vehicle : vehicles_) vehicle->idle(elapsed);
  } else {
    for (std::size_t index = 0; index < vehicles_.size() && state_ == EngineState::kStreaming; ++index)
      fly(index, time);
  }
  if (on_advance) on_advance();
}

}  // namespace vbar::grand::bench
