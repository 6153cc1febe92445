// Steps that end where a force jumps: at the shadow's edges and at dates.

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <boost/math/tools/roots.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/truth/forces/radiation_pressure_force.h"
#include "host_sim/truth/forces/third_body_force.h"
#include "host_sim/truth/spacecraft_propagator.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/forces_fixture.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;
using test::dynamics_with;
using test::InertialJ2;
using test::same_bits;
using test::servicer_state;

constexpr double kDay = 86400.0;

/// 0.02 m^2/kg: the servicer's.
SurfaceProperties surface() {
  SurfaceProperties properties;
  properties.mass_kg = 154.0;
  properties.radiation_area_m2 = 2.5;
  properties.radiation_coefficient = 1.32;
  return properties;
}

template <class... Forces>
std::vector<std::unique_ptr<Force>> list(std::unique_ptr<Forces>... forces) {
  std::vector<std::unique_ptr<Force>> all;
  (all.push_back(std::move(forces)), ...);
  return all;
}

std::unique_ptr<RadiationPressureForce> sunlight(Shadow shadow) {
  return std::make_unique<RadiationPressureForce>(surface(), shadow);
}

/// A force whose edges the propagator is not told of: it switches by itself, in the middle of steps.
class Unannounced final : public Force {
 public:
  explicit Unannounced(std::unique_ptr<Force> force) : force_(std::move(force)) {}
  std::string_view name() const override { return force_->name(); }
  bool needs_sun_and_moon() const override { return force_->needs_sun_and_moon(); }
  Vector3 acceleration_eci(const ForceInput& input) override {
    for (int edge = 0; edge < force_->edge_count(); ++edge) force_->set_side(edge, force_->edge(edge, input) > 0.0);
    return force_->acceleration_eci(input);
  }

 private:
  std::unique_ptr<Force> force_;
};

/// A small constant push whose sign changes at the zeros of a function of time; keeps when it was told so.
class Switch final : public Force {
 public:
  struct Log {
    std::vector<double> crossings;  ///< time of the first call after each change of side
    std::vector<double> intervals;
  };

  Switch(std::function<double(double)> function, Log* log) : function_(std::move(function)), log_(log) {}
  std::string_view name() const override { return "switch"; }
  Vector3 acceleration_eci(const ForceInput& input) override {
    if (changed_) log_->crossings.push_back(input.seconds);
    changed_ = false;
    return input.velocity_eci.normalized() * (positive_ ? 1e-6 : -1e-6);
  }
  int edge_count() const override { return 1; }
  double edge(int, const ForceInput& input) const override { return function_(input.seconds); }
  void set_side(int, bool positive) override {
    changed_ = positive != positive_;
    positive_ = positive;
  }

 private:
  std::function<double(double)> function_;
  Log* log_;
  bool positive_ = true;
  bool changed_ = false;
};

CartesianState fly(std::vector<std::unique_ptr<Force>> forces, double tolerance, double seconds,
                   IntegrationStatistics* statistics = nullptr) {
  SpacecraftPropagator propagator(dynamics_with(std::move(forces)), tolerance, 0.0, servicer_state());
  propagator.advance_to(seconds);
  if (statistics != nullptr) *statistics = propagator.statistics();
  return propagator.state();
}

double distance(const CartesianState& a, const CartesianState& b) {
  return (a.position_eci - b.position_eci).norm();
}

TEST(Edges, TheErrorFallsWithTheToleranceAsWithoutAShadow) {
  const auto error_without_shadow = [](double tolerance) {
    return distance(fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kNone)), tolerance, kDay),
                    fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kNone)), 1e-14, kDay));
  };
  for (Shadow shadow : {Shadow::kCylindrical, Shadow::kConical}) {
    const CartesianState reference = fly(list(std::make_unique<InertialJ2>(), sunlight(shadow)), 1e-14, kDay);
    for (double tolerance : {1e-9, 1e-10, 1e-11, 1e-12, 1e-13}) {
      IntegrationStatistics s, u, n;
      const double located =
          distance(fly(list(std::make_unique<InertialJ2>(), sunlight(shadow)), tolerance, kDay, &s), reference);
      const double unannounced = distance(
          fly(list(std::make_unique<InertialJ2>(), std::make_unique<Unannounced>(sunlight(shadow))), tolerance, kDay, &u),
          reference);
      fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kNone)), tolerance, kDay, &n);
      printf("%d %g: none %g (%ld+%ld, %ld) located %g (%ld+%ld, %ld) unannounced %g (%ld+%ld, %ld)\n", int(shadow), tolerance,
             error_without_shadow(tolerance), n.accepted_steps, n.rejected_steps, n.evaluations, located, s.accepted_steps, s.rejected_steps, s.evaluations, unannounced,
             u.accepted_steps, u.rejected_steps, u.evaluations);
    }
  }
}

}  // namespace
}  // namespace vbar::truth
