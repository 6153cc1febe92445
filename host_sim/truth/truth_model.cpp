#include "host_sim/truth/truth_model.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/attitude/attitude_sequence.h"
#include "host_sim/truth/attitude/spacecraft_attitude.h"
#include "host_sim/truth/orbital_motion.h"

namespace vbar::truth {

namespace {

/// Starting threads costs as much as about this many seconds of simulated flight; below it one thread is faster.
constexpr double kWorthThreads_s = 120.0;

/// Adds the wall-clock time of its lifetime to a sum.
class WallClock {
 public:
  explicit WallClock(double& sum_s) : sum_s_(sum_s), start_(std::chrono::steady_clock::now()) {}
  ~WallClock() { sum_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  WallClock(const WallClock&) = delete;
  WallClock& operator=(const WallClock&) = delete;

 private:
  double& sum_s_;
  std::chrono::steady_clock::time_point start_;
};

void check(const TruthSettings& settings) {
  if (!(settings.tolerance >= TruthSettings::kSmallestTolerance &&
        settings.tolerance <= TruthSettings::kLargestTolerance)) {
    throw std::invalid_argument(fmt::format("truth tolerance {}; accepted is {} (what doubles can hold) to {}",
                                            settings.tolerance, TruthSettings::kSmallestTolerance,
                                            TruthSettings::kLargestTolerance));
  }
  if (settings.threads < 1) {
    throw std::invalid_argument(fmt::format("truth threads {}; accepted is 1 or more", settings.threads));
  }
}

TruthStatistics statistics_of(const SpacecraftPropagator& spacecraft) {
  const IntegrationStatistics& integration = spacecraft.statistics();
  TruthStatistics statistics;
  statistics.steps = integration.accepted_steps;
  statistics.rejected_steps = integration.rejected_steps;
  statistics.force_evaluations = integration.evaluations;
  statistics.edges_crossed = spacecraft.edges_crossed();
  return statistics;
}

}  // namespace

TruthModel::TruthModel(const TruthSettings& settings) : settings_(settings), time_(settings.epoch) {
  check(settings);
  data_ = load_force_data(settings);
}

std::size_t TruthModel::add_spacecraft(const SpacecraftSettings& spacecraft) {
  const std::string& name = spacecraft.name;
  if (name.empty() || index_of_name_.contains(name)) {
    throw std::invalid_argument(fmt::format("spacecraft name \"{}\" is empty or used twice", name));
  }
  auto dynamics = std::make_unique<SpacecraftDynamics>(name, data_.gravity->gm(), data_.gravity->radius(),
                                                       EarthRotation(data_.earth_orientation, settings_.epoch),
                                                       make_forces(settings_, data_, spacecraft));
  dynamics->measure_time(measures_force_times_);
  spacecraft_.push_back(std::make_unique<SpacecraftPropagator>(std::move(dynamics), settings_.tolerance,
                                                               seconds_after_epoch(time_), spacecraft.osculating));
  index_of_name_.emplace(name, spacecraft_.size() - 1);
  return spacecraft_.size() - 1;
}

std::size_t TruthModel::index_of(std::string_view name) const {
  const auto found = index_of_name_.find(name);
  if (found == index_of_name_.end()) throw std::invalid_argument(fmt::format("there is no spacecraft \"{}\"", name));
  return found->second;
}

void TruthModel::advance_to(fsw::GpsTime time) {
  if (time < time_) throw std::invalid_argument("the truth does not go back in time");
  const WallClock clock(wall_s_);
  const double seconds = seconds_after_epoch(time);
  std::vector<SpacecraftPropagator*> behind;
  for (const auto& spacecraft : spacecraft_) {
    if (spacecraft->needs_steps_to(seconds)) behind.push_back(spacecraft.get());
  }
  const double work_s = static_cast<double>(behind.size()) * fsw::seconds(time - time_);
  if (settings_.threads > 1 && behind.size() > 1 && work_s > kWorthThreads_s) {
    std::vector<std::exception_ptr> errors(behind.size());
    work_in_parallel(behind.size(), [&](std::size_t i) {
      try {
        behind[i]->advance_to(seconds);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    });
    // The error of the same spacecraft whichever thread threw first.
    for (const auto& error : errors) {
      if (error) std::rethrow_exception(error);
    }
  }
  for (const auto& spacecraft : spacecraft_) spacecraft->advance_to(seconds);
  time_ = time;
}

void TruthModel::advance_through(std::span<const fsw::GpsTime> times,
                                 const std::function<void(std::size_t index, std::size_t place)>& at) {
  if (times.empty()) return;
  if (times.front() < time_) throw std::invalid_argument("the truth does not go back in time");
  const WallClock clock(wall_s_);
  struct Failure {
    std::size_t place = 0;
    std::exception_ptr error;
  };
  std::vector<Failure> failures(spacecraft_.size());
  work_in_parallel(spacecraft_.size(), [&](std::size_t index) {
    for (std::size_t place = 0; place < times.size(); ++place) {
      try {
        spacecraft_[index]->advance_to(seconds_after_epoch(times[place]));
        at(index, place);
      } catch (...) {
        failures[index] = {place, std::current_exception()};
        return;
      }
    }
  });
  const Failure* first = nullptr;
  for (const Failure& failure : failures)
    if (failure.error && (first == nullptr || failure.place < first->place)) first = &failure;
  if (first == nullptr) {
    time_ = times.back();
    return;
  }
  if (first->place > 0) time_ = times[first->place - 1];
  std::rethrow_exception(first->error);
}

/// Calls `work`, which does not throw, for 0 to `count` - 1.
void TruthModel::work_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work) const {
  std::atomic<std::size_t> next{0};
  const auto take_work = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  const std::size_t helpers =
      std::min(static_cast<std::size_t>(settings_.threads), std::max(count, std::size_t{1})) - 1;
  std::vector<std::jthread> threads;
  threads.reserve(helpers);
  for (std::size_t i = 0; i < helpers; ++i) threads.emplace_back(take_work);
  take_work();
}

fsw::orbit::CartesianState TruthModel::state(std::size_t index) const {
  return spacecraft_.at(index)->state();
}

fsw::orbit::CartesianState TruthModel::state_at(std::size_t index, fsw::GpsTime time) const {
  return spacecraft_.at(index)->state_at(seconds_after_epoch(time));
}

fsw::Vector3 TruthModel::perturbation_eci(std::size_t index) const {
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (const ForceAcceleration& share : spacecraft_.at(index)->accelerations()) sum += share.acceleration_eci;
  return sum;
}

fsw::Vector3 TruthModel::acceleration_eci(std::size_t index, const fsw::orbit::CartesianState& state) const {
  return central_acceleration(spacecraft_.at(index)->dynamics().gm(), state.position_eci) + perturbation_eci(index);
}

fsw::orbit::CartesianState TruthModel::state_ahead(std::size_t index, fsw::GpsTime time) const {
  const SpacecraftPropagator& spacecraft = *spacecraft_.at(index);
  const double seconds = seconds_after_epoch(time);
  if (!spacecraft.needs_steps_to(seconds)) return spacecraft.state_at(seconds);
  const double gm = spacecraft_.at(index)->dynamics().gm();
  return orbit_ahead(spacecraft.state_at(spacecraft.known_until()), gm, perturbation_eci(index),
                     seconds - spacecraft.known_until());
}

void TruthModel::apply_impulse_rtn(std::size_t index, const fsw::Vector3& dv_rtn) {
  const WallClock clock(wall_s_);
  spacecraft_.at(index)->apply_impulse_rtn(dv_rtn);
}

void TruthModel::begin_burn(std::size_t index, ThrustArc arc) {
  const WallClock clock(wall_s_);
  arc.begin_s = seconds_after_epoch(time_);
  spacecraft_.at(index)->begin_burn(arc);
}

TruthStatistics TruthModel::statistics() const {
  TruthStatistics sum;
  for (const auto& spacecraft : spacecraft_) {
    const TruthStatistics one = statistics_of(*spacecraft);
    sum.steps += one.steps;
    sum.rejected_steps += one.rejected_steps;
    sum.force_evaluations += one.force_evaluations;
    sum.edges_crossed += one.edges_crossed;
  }
  sum.wall_s = wall_s_;
  return sum;
}

TruthStatistics TruthModel::statistics(std::size_t index) const {
  return statistics_of(*spacecraft_.at(index));
}

void TruthModel::measure_force_times(bool on) {
  measures_force_times_ = on;
  for (const auto& spacecraft : spacecraft_) spacecraft->dynamics().measure_time(on);
}

namespace {

/// Adds a time to that of the same force; not all spacecraft have all forces.
void add_to(std::vector<ForceTime>& sum, const ForceTime& time) {
  const auto same = std::ranges::find(sum, time.force, &ForceTime::force);
  if (same == sum.end()) {
    sum.push_back(time);
  } else {
    same->wall_s += time.wall_s;
  }
}

}  // namespace

std::vector<ForceTime> TruthModel::force_times() const {
  std::vector<ForceTime> sum;
  for (const auto& spacecraft : spacecraft_) {
    const std::vector<ForceTime> times = spacecraft->dynamics().times();
    if (sum.empty()) {
      sum = times;
    } else {
      for (const ForceTime& time : times) add_to(sum, time);
    }
  }
  return sum;
}

// The attitudes of the truth model, with inputs from the spacecraft's own orbit and forces.

namespace {

/// Air and light on facets do not depend on the sphere that represents a spacecraft in the forces on its orbit.
constexpr SurfaceProperties kAnySphere{1.0, 1.0, 1.0, 1.0, 1.0};

bool has_torque(const AttitudeSettings& settings, TorqueKind kind) {
  const auto* tumble = std::get_if<TumbleSettings>(&settings);
  return tumble != nullptr && std::ranges::find(tumble->torques, kind) != tumble->torques.end();
}

}  // namespace

std::unique_ptr<AttitudeMotion> TruthModel::attitude_motion(std::size_t index, const AttitudeSettings& settings) {
  SpacecraftPropagator* const own = spacecraft_.at(index).get();
  AttitudeSurroundings surroundings;
  surroundings.gm = own->dynamics().gm();
  surroundings.tolerance = settings_.tolerance;
  surroundings.seconds = seconds_after_epoch(time_);
  surroundings.orbit = [own](double seconds) { return own->surroundings_at(seconds); };
  surroundings.own = [own](double seconds) { return own->motion_at(seconds); };
  surroundings.sun = [own](double seconds) { return own->dynamics().sun_eci_at(seconds); };
  if (const auto* pointed = std::get_if<PointedSettings>(&settings);
      pointed != nullptr && !pointed->spacecraft.empty()) {
    const SpacecraftPropagator* const other = spacecraft_[index_of(pointed->spacecraft)].get();
    if (other == own) {
      throw std::invalid_argument(fmt::format("spacecraft \"{}\" cannot point at itself", own->name()));
    }
    surroundings.other = [other](double seconds) { return other->motion_at(seconds); };
  }
  if (has_torque(settings, TorqueKind::kRadiation)) {
    own->dynamics().provide_sun_and_moon();
    surroundings.sunlight = std::make_unique<SunlightOfRadiationPressure>(
        std::make_unique<RadiationPressureForce>(kAnySphere, settings_.forces.shadow));
  }
  if (has_torque(settings, TorqueKind::kAerodynamic)) {
    load_atmosphere(settings_, data_);
    surroundings.air = std::make_unique<AirOfDrag>(std::make_unique<DragForce>(
        kAnySphere, data_.atmosphere, data_.space_weather, settings_.forces.geomagnetic_index, settings_.epoch));
  }
  return make_attitude(settings, std::move(surroundings));
}

void TruthModel::set_attitude(std::size_t index, const AttitudeSettings& settings,
                              const std::vector<LaterAttitudeSettings>& later) {
  std::unique_ptr<AttitudeMotion> first = attitude_motion(index, settings);
  std::vector<AttitudeSequence::Later> following;
  for (const LaterAttitudeSettings& one : later) {
    const auto* const pointed = std::get_if<PointedSettings>(&one.attitude);
    if (pointed != nullptr && !pointed->spacecraft.empty()) {
      throw std::invalid_argument("an attitude that follows another one cannot point at a spacecraft");
    }
    auto motion = attitude_motion(
        index, std::visit([](const auto& settings_of_one) { return AttitudeSettings(settings_of_one); }, one.attitude));
    if (one.from_s <= seconds_after_epoch(time_)) {
      first = std::move(motion);
    } else {
      following.push_back({one.from_s, one.slew_s, std::move(motion)});
    }
  }
  if (!following.empty()) first = std::make_unique<AttitudeSequence>(std::move(first), std::move(following));
  spacecraft_.at(index)->set_attitude(std::move(first));
}

bool TruthModel::command_pointing(std::size_t index, fsw::GpsTime time, const fsw::Vector3& boresight_rtn,
                                  const fsw::Vector3& boresight_rate_rtn) {
  SpacecraftPropagator& spacecraft = *spacecraft_.at(index);
  auto* const attitude = dynamic_cast<CommandedAttitude*>(spacecraft.attitude());
  if (attitude == nullptr) {
    throw std::logic_error(fmt::format("the attitude of spacecraft \"{}\" is not commanded", spacecraft.name()));
  }
  const fsw::GpsTime from = std::max(time, time_);
  const double led_s = std::min(fsw::seconds(from - time), kLongestLine_s);
  return attitude->take({seconds_after_epoch(from), boresight_rtn + led_s * boresight_rate_rtn, boresight_rate_rtn});
}

AttitudeState TruthModel::attitude_at(std::size_t index, fsw::GpsTime time) const {
  return spacecraft_.at(index)->attitude_at(seconds_after_epoch(time));
}

}  // namespace vbar::truth
