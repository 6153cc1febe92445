#include "host_sim/orbit_fit/dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "fsw/orbit/rtn.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/spacecraft_propagator.h"

namespace vbar::orbit_fit {

namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;
using truth::Force;
using truth::ForceInput;

constexpr const char* kOceanTideFile = "gravity/fes2004_8.txt";
constexpr double kNever = std::numeric_limits<double>::infinity();

/// A force of the truth times a scale that may jump from interval to interval.
class ScaledForce final : public Force {
 public:
  ScaledForce(std::unique_ptr<Force> force, Intervals<double> scale)
      : force_(std::move(force)), scale_(std::move(scale)) {}

  std::string_view name() const override { return force_->name(); }
  Vector3 acceleration_eci(const ForceInput& input) override { return now_ * force_->acceleration_eci(input); }
  bool needs_sun_and_moon() const override { return force_->needs_sun_and_moon(); }
  int edge_count() const override { return force_->edge_count(); }
  double edge(int index, const ForceInput& input) const override { return force_->edge(index, input); }
  void set_side(int index, bool positive) override { force_->set_side(index, positive); }
  double longest_step(const ForceInput& input) const override { return force_->longest_step(input); }
  double next_jump_after(double seconds) const override {
    return std::min(force_->next_jump_after(seconds), scale_.next_after(seconds));
  }
  void enter_interval(double seconds) override {
    now_ = scale_.values[scale_.place(seconds)];
    force_->enter_interval(seconds);
  }

 private:
  std::unique_ptr<Force> force_;
  Intervals<double> scale_;
  double now_ = 1.0;
};

class EmpiricalForce final : public Force {
 public:
  explicit EmpiricalForce(Intervals<Empirical> terms) : terms_(std::move(terms)) {}

  std::string_view name() const override { return "empirical"; }
  Vector3 acceleration_eci(const ForceInput& input) override {
    return empirical_directions({input.position_eci, input.velocity_eci}) * now_.amplitude;
  }
  double next_jump_after(double seconds) const override { return terms_.next_after(seconds); }
  void enter_interval(double seconds) override { now_ = terms_.values[terms_.place(seconds)]; }

 private:
  Intervals<Empirical> terms_;
  Empirical now_;
};

/// The thrust of the burns that last.
class ThrustForce final : public Force {
 public:
  explicit ThrustForce(std::vector<Burn> burns) : burns_(std::move(burns)) {}

  std::string_view name() const override { return "thrust"; }
  Vector3 acceleration_eci(const ForceInput& input) override {
    if (now_.isZero(0.0)) return Vector3::Zero();
    return fsw::orbit::R_rtn_eci({input.position_eci, input.velocity_eci}).transpose() * now_;
  }
  double next_jump_after(double seconds) const override {
    double next = kNever;
    for (const Burn& burn : burns_)
      for (const double edge : {burn.start_s(), burn.end_s()})
        if (edge > seconds) next = std::min(next, edge);
    return next;
  }
  void enter_interval(double seconds) override {
    now_.setZero();
    for (const Burn& burn : burns_)
      if (burn.start_s() <= seconds && seconds < burn.end_s()) now_ += burn.dv_rtn / burn.duration_s;
  }

 private:
  std::vector<Burn> burns_;
  Vector3 now_ = Vector3::Zero();
};

}  // namespace

template <class Value>
double Intervals<Value>::next_after(double seconds) const {
  if (length_s <= 0.0) return kNever;
  double next = (std::floor(std::max(seconds, 0.0) / length_s) + 1.0) * length_s;
  if (next <= seconds) next += length_s;  // rounding
  return next > (static_cast<double>(values.size()) - 0.5) * length_s ? kNever : next;
}
template struct Intervals<double>;
template struct Intervals<Empirical>;

Eigen::Matrix<double, 3, Empirical::kCount> empirical_directions(const CartesianState& state) {
  const fsw::Matrix3 R = fsw::orbit::R_rtn_eci(state);
  const Vector3 radial = R.row(0), transverse = R.row(1), normal = R.row(2);
  const Vector3 node = Vector3::UnitZ().cross(normal).normalized();
  const double cos_u = radial.dot(node), sin_u = radial.dot(normal.cross(node));
  Eigen::Matrix<double, 3, Empirical::kCount> directions;
  directions << transverse, cos_u * transverse, sin_u * transverse, cos_u * normal, sin_u * normal;
  return directions;
}

FittedDynamics::FittedDynamics(truth::TruthSettings settings, const std::string& name,
                               const truth::SurfaceProperties& surface, bool ocean_tides)
    : settings_(std::move(settings)), name_(name), surface_(surface), data_(truth::load_force_data(settings_)) {
  if (ocean_tides)
    ocean_tides_ = std::make_shared<const std::vector<truth::OceanTideWave>>(
        truth::load_ocean_tides(settings_.data_directory / kOceanTideFile));
  static_cast<void>(dynamics({}));
}

FittedDynamics FittedDynamics::simplified() const {
  constexpr int kDegree = 10;
  truth::TruthSettings settings = settings_;
  settings.gravity_degree = std::min(settings.gravity_degree, kDegree);
  settings.gravity_order = std::min(settings.gravity_order, kDegree);
  settings.forces = {};
  return FittedDynamics(settings, name_, surface_, false);
}

std::unique_ptr<truth::SpacecraftDynamics> FittedDynamics::dynamics(const OrbitParameters& parameters) const {
  std::vector<std::unique_ptr<Force>> forces =
      truth::make_forces(settings_, data_, truth::SpacecraftSettings{name_, parameters.start, surface_});
  for (std::unique_ptr<Force>& force : forces) {
    if (force->name() == "drag") force = std::make_unique<ScaledForce>(std::move(force), parameters.drag_scale);
    if (force->name() == "radiation_pressure")
      force = std::make_unique<ScaledForce>(std::move(force), Intervals<double>{0.0, {parameters.radiation_scale}});
  }
  if (ocean_tides_)
    forces.push_back(std::make_unique<truth::OceanTidesForce>(data_.gravity->gm(), data_.gravity->radius(),
                                                              settings_.epoch, ocean_tides_, data_.earth_orientation));
  if (!parameters.empirical.values.empty()) forces.push_back(std::make_unique<EmpiricalForce>(parameters.empirical));
  std::vector<Burn> lasting;
  for (const Burn& burn : parameters.burns)
    if (burn.duration_s > 0.0) lasting.push_back(burn);
  if (!lasting.empty()) forces.push_back(std::make_unique<ThrustForce>(lasting));
  return std::make_unique<truth::SpacecraftDynamics>(name_, data_.gravity->gm(), data_.gravity->radius(),
                                                     truth::EarthRotation(data_.earth_orientation, settings_.epoch),
                                                     std::move(forces));
}

std::vector<CartesianState> FittedDynamics::propagate(const OrbitParameters& parameters,
                                                      std::span<const double> seconds) const {
  truth::SpacecraftPropagator propagator(dynamics(parameters), settings_.tolerance, 0.0, parameters.start);
  std::vector<CartesianState> states;
  states.reserve(seconds.size());
  std::vector<Burn> impulses;
  for (const Burn& burn : parameters.burns)
    if (burn.duration_s <= 0.0) impulses.push_back(burn);
  std::ranges::sort(impulses, {}, &Burn::seconds);
  auto next = impulses.begin();
  for (const double time : seconds) {
    for (; next != impulses.end() && next->seconds <= time; ++next) {
      propagator.advance_to(next->seconds);
      propagator.apply_impulse_rtn(next->dv_rtn);
    }
    propagator.advance_to(time);
    states.push_back(propagator.state());
  }
  return states;
}

}  // namespace vbar::orbit_fit
