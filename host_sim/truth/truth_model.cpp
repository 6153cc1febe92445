#include "host_sim/truth/truth_model.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/truth/forces/gravity_force.h"

namespace vbar::truth {
namespace {

constexpr const char* kGravityFile = "gravity/ggm05s_120.txt";
constexpr const char* kEarthOrientationFile = "earth/eop_2009_2013.csv";

/// Starting threads costs as much as about this many seconds of simulated flight; below it one thread is faster.
constexpr double kWorthThreads_s = 120.0;

/// Adds the wall-clock time of its life to a sum.
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
  if (!(settings.tolerance >= TruthSettings::kSmallestTolerance && settings.tolerance <= 1e-3)) {
    throw std::invalid_argument(fmt::format("truth tolerance {}; accepted is {} (what doubles can hold) to 0.001",
                                            settings.tolerance, TruthSettings::kSmallestTolerance));
  }
  if (settings.threads < 1) {
    throw std::invalid_argument(fmt::format("truth threads {}; accepted is 1 or more", settings.threads));
  }
}

std::shared_ptr<const GravityField> load_gravity(const TruthSettings& settings) {
  const auto coefficients = load_gravity_coefficients(settings.data_directory / kGravityFile, settings.gravity_degree);
  return std::make_shared<const GravityField>(coefficients, settings.gravity_degree, settings.gravity_order);
}

}  // namespace

TruthModel::TruthModel(const TruthSettings& settings) : settings_(settings), time_(settings.epoch) {
  check(settings);
  gravity_ = load_gravity(settings);
  earth_orientation_ = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(settings.data_directory / kEarthOrientationFile));
  static_cast<void>(earth_orientation_->at(settings.epoch));  // refuses an epoch outside the data now, not in flight
}

std::size_t TruthModel::add_spacecraft(const std::string& name, const fsw::orbit::CartesianState& osculating) {
  const auto same_name = [&](const auto& spacecraft) { return spacecraft->name() == name; };
  if (name.empty() || std::any_of(spacecraft_.begin(), spacecraft_.end(), same_name)) {
    throw std::invalid_argument(fmt::format("spacecraft name \"{}\" is empty or used twice", name));
  }
  std::vector<std::unique_ptr<Force>> forces;
  forces.push_back(std::make_unique<GravityForce>(gravity_));
  auto dynamics = std::make_unique<SpacecraftDynamics>(
      name, gravity_->gm(), gravity_->radius(), EarthRotation(earth_orientation_, settings_.epoch), std::move(forces));
  spacecraft_.push_back(std::make_unique<SpacecraftPropagator>(std::move(dynamics), settings_.tolerance,
                                                               seconds_after_epoch(time_), osculating));
  return spacecraft_.size() - 1;
}

std::size_t TruthModel::index_of(std::string_view name) const {
  for (std::size_t i = 0; i < spacecraft_.size(); ++i) {
    if (spacecraft_[i]->name() == name) return i;
  }
  throw std::invalid_argument(fmt::format("there is no spacecraft \"{}\"", name));
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
  if (settings_.threads > 1 && behind.size() > 1 && work_s > kWorthThreads_s) advance_in_parallel(behind, seconds);
  for (const auto& spacecraft : spacecraft_) spacecraft->advance_to(seconds);
  time_ = time;
}

void TruthModel::advance_in_parallel(const std::vector<SpacecraftPropagator*>& spacecraft, double seconds) const {
  std::vector<std::exception_ptr> errors(spacecraft.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < spacecraft.size(); i = next++) {
      try {
        spacecraft[i]->advance_to(seconds);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    }
  };
  {
    const std::size_t helpers = std::min(static_cast<std::size_t>(settings_.threads), spacecraft.size()) - 1;
    std::vector<std::jthread> threads;
    threads.reserve(helpers);
    for (std::size_t i = 0; i < helpers; ++i) threads.emplace_back(work);
    work();
  }
  // The same spacecraft's error whichever thread met one first.
  for (const auto& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

fsw::orbit::CartesianState TruthModel::state(std::size_t index) const {
  return spacecraft_.at(index)->state();
}

fsw::orbit::CartesianState TruthModel::state_at(std::size_t index, fsw::GpsTime time) const {
  return spacecraft_.at(index)->state_at(seconds_after_epoch(time));
}

void TruthModel::apply_impulse_rtn(std::size_t index, const fsw::Vector3& dv_rtn) {
  const WallClock clock(wall_s_);
  spacecraft_.at(index)->apply_impulse_rtn(dv_rtn);
}

TruthStatistics TruthModel::statistics() const {
  TruthStatistics sum;
  for (const auto& spacecraft : spacecraft_) {
    const IntegrationStatistics& one = spacecraft->statistics();
    sum.steps += one.accepted_steps;
    sum.rejected_steps += one.rejected_steps;
    sum.force_evaluations += one.evaluations;
  }
  sum.wall_s = wall_s_;
  return sum;
}

}  // namespace vbar::truth
