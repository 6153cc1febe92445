// Steps that end where a force jumps: at the shadow's edges and at dates.

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
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

/// What a test's force was told.
struct Log {
  std::vector<double> crossings;  ///< time of the first call after each change of side
  std::vector<double> intervals;  ///< each interval entered
};

/// A push along the velocity, forwards where a function of time is positive and backwards elsewhere.
class Switch final : public Force {
 public:
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

/// A push along the velocity that changes its sign at every multiple of a period.
class Alternating final : public Force {
 public:
  Alternating(double period, double push, Log* log = nullptr) : period_(period), push_(push), log_(log) {}
  std::string_view name() const override { return "alternating"; }
  Vector3 acceleration_eci(const ForceInput& input) override { return sign_ * push_ * input.velocity_eci.normalized(); }
  double next_jump_after(double seconds) const override { return period_ * (std::floor(seconds / period_) + 1.0); }
  void enter_interval(double seconds) override {
    sign_ = std::fmod(std::floor(seconds / period_), 2.0) == 0.0 ? 1.0 : -1.0;
    if (log_ != nullptr) log_->intervals.push_back(seconds);
  }

 private:
  double period_, push_;
  Log* log_;
  double sign_ = 1.0;
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

template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Edges, LocatedTheErrorFallsWithTheToleranceUnannouncedItDoesNot) {
  // A day with J2 and the cylinder's 30 edges, against steps of 2 s. A local error of `tolerance` times the orbit's
  // size a in a grows along track by 3/2 n t = 137, and errors of a thousand steps average: 30 a times tolerance is
  // allowed. Left alone, the integrator's error estimates are shaken by the jumps and the result is worse tenfold and
  // more.
  const CartesianState reference =
      fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical), std::make_unique<Alternating>(2.0, 0.0)),
          1e-13, kDay);
  for (double tolerance : {1e-10, 1e-11, 1e-12, 1e-13}) {
    const double allowed = 30.0 * 7.1e6 * tolerance;
    const double located =
        distance(fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)), tolerance, kDay), reference);
    const double unannounced = distance(
        fly(list(std::make_unique<InertialJ2>(), std::make_unique<Unannounced>(sunlight(Shadow::kCylindrical))),
            tolerance, kDay),
        reference);
    EXPECT_LT(located, allowed) << tolerance;
    EXPECT_GT(unannounced, 10.0 * allowed) << tolerance;
    if (tolerance == 1e-13) {
      accuracy::expect_below("one day through a cylindrical shadow's edges, tolerance 1e-13", "steps of 2 s", located,
                             allowed, "m");
    }
  }
}

TEST(Edges, OfThePenumbraAreRough) {
  // Between its rims the light goes with the power 3/2 of the time from the rim, where a method of order 5 is not one,
  // and an orbit over the terminator, as the mission's, grazes the penumbra for minutes. Claimed are 2 mm a day.
  const CartesianState reference =
      fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kConical), std::make_unique<Alternating>(2.0, 0.0)),
          1e-13, kDay);
  double largest = 0.0;
  for (double tolerance : {1e-12, 1e-13, 1e-14}) {
    largest = std::max(
        largest,
        distance(fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kConical)), tolerance, kDay), reference));
  }
  accuracy::expect_below("one day through the penumbra's rims, tolerances 1e-12 to 1e-14", "steps of 2 s", largest,
                         2e-3, "m");
}

TEST(Edges, CostAFewSteps) {
  IntegrationStatistics lit, shadowed;
  fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kNone)), 1e-13, kDay, &lit);
  fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)), 1e-13, kDay, &shadowed);
  const double orbits = kDay / 5938.0;
  RecordProperty("steps_per_orbit_lit", std::to_string(static_cast<double>(lit.accepted_steps) / orbits));
  RecordProperty("steps_per_orbit_shadowed", std::to_string(static_cast<double>(shadowed.accepted_steps) / orbits));
  // Two edges an orbit, each of which divides one step into two; the step size is kept.
  EXPECT_LT(static_cast<double>(shadowed.accepted_steps - lit.accepted_steps), 2.0 * orbits);
  // The step up to an edge is taken twice, six evaluations, and one begins the next.
  EXPECT_LT(static_cast<double>(shadowed.evaluations - lit.evaluations), 2.0 * orbits * (6.0 + 6.0 + 1.0));
}

TEST(Edges, AreWhereARootSearchOnAnotherTrajectoryFindsThem) {
  // Kepler's motion (the light's push is set to nothing), its edges bisected in time.
  Log log;
  class Told final : public Force {
   public:
    explicit Told(Log* log) : log_(log) {}
    std::string_view name() const override { return "told"; }
    bool needs_sun_and_moon() const override { return true; }
    Vector3 acceleration_eci(const ForceInput& input) override {
      if (changed_) log_->crossings.push_back(input.seconds);
      changed_ = false;
      return Vector3::Zero();
    }
    int edge_count() const override { return 1; }
    double edge(int, const ForceInput& input) const override {
      return cylindrical_shadow_edge(input.position_eci, input.sun_eci, {});
    }
    void set_side(int, bool) override { changed_ = true; }

   private:
    Log* log_;
    bool changed_ = false;
  };
  fsw::orbit::QnsElements elements = test::servicer_elements();
  elements.raan += 1.0;  // off the terminator
  SpacecraftPropagator propagator(dynamics_with(list(std::make_unique<Told>(&log))), 1e-13, 0.0,
                                  orbit_geometry(elements, test::kGm).state);
  propagator.advance_to(40000.0);
  // The first change logged is the start's, and the last step may reach beyond the end.
  std::vector<double> found(log.crossings.begin() + 1, log.crossings.end());
  std::erase_if(found, [](double t) { return t > 40000.0; });

  const double mean_motion = std::sqrt(test::kGm / elements.a) / elements.a;
  const auto edge = [&](double seconds) {
    fsw::orbit::QnsElements now = elements;
    now.u += mean_motion * seconds;
    return cylindrical_shadow_edge(orbit_geometry(now, test::kGm).state.position_eci,
                                   sun_moon_series(tt_of(test::mission_epoch(), seconds)).sun_eci, {});
  };
  std::vector<double> roots;
  for (double t = 0.0; t < 40000.0; t += 10.0) {
    double low = t, high = t + 10.0;
    if ((edge(low) > 0.0) == (edge(high) > 0.0)) continue;
    for (int i = 0; i < 60; ++i)
      ((edge(0.5 * (low + high)) > 0.0) == (edge(low) > 0.0) ? low : high) = 0.5 * (low + high);
    roots.push_back(low);
  }
  ASSERT_EQ(found.size(), roots.size());
  ASSERT_GE(roots.size(), 13u);  // 6.7 orbits
  double largest = 0.0;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    largest = std::max(largest, std::abs(found[i] - roots[i]));
  }
  accuracy::expect_below("shadow edges located", "bisection on Kepler's motion, 13 edges", largest, 1e-6, "s");
}

TEST(Edges, ShortVisitsAreFound) {
  // A function of the orbit's period that is negative for `duration`, as when a shadow is grazed, at times that fall
  // anywhere in steps as long as Kepler's motion allows, and as short as the full gravity field's.
  const double turn = 2.0 * M_PI * 1.001;  // not quite the orbit's, so that each visit meets its steps elsewhere
  constexpr double kPeriod = 5938.0;
  for (double longest_step : {1e9, 40.0}) {
    for (double duration : {20.0, 5.0, 1.0, 0.1}) {
      Log log;
      const auto dip = [&](double t) {
        return 7e6 * (std::cos(0.5 * duration * turn / kPeriod) - std::cos(turn * (t - 1000.0) / kPeriod));
      };
      fly(list(std::make_unique<Switch>(dip, &log), std::make_unique<Alternating>(longest_step, 0.0)), 1e-12,
          20.0 * kPeriod);
      std::vector<double> expected;
      for (int k = 0; k < 20; ++k) {
        const double centre = 1000.0 + k * kPeriod / 1.001;
        expected.push_back(centre - 0.5 * duration);
        expected.push_back(centre + 0.5 * duration);
      }
      // 1e-6 s, and for the shortest visit the roundings of a cosine near 1 over its slope: 1e-16 / 5e-8.
      EXPECT_THAT(log.crossings, testing::Pointwise(testing::DoubleNear(1e-6), expected)) << duration;
    }
  }
}

TEST(Edges, OfSeveralForcesInOneStep) {
  Log a, b;
  const auto at = [](double when) { return [when](double t) { return when - t; }; };
  fly(list(std::make_unique<Switch>(at(100.0), &a), std::make_unique<Switch>(at(99.999), &b),
           std::make_unique<Alternating>(50.0, 1e-6)),
      1e-12, 1000.0);
  ASSERT_THAT(a.crossings, testing::SizeIs(1));
  ASSERT_THAT(b.crossings, testing::SizeIs(1));
  EXPECT_NEAR(a.crossings[0], 100.0, 1e-6);  // at a date that ends a step as well
  EXPECT_NEAR(b.crossings[0], 99.999, 1e-6);
}

TEST(Jumps, EndStepsAtTheirDates) {
  Log log;
  fly(list(std::make_unique<Alternating>(700.0, 1e-6, &log)), 1e-12, 2500.0);
  EXPECT_THAT(log.intervals, testing::ElementsAre(0.0, 700.0, 1400.0, 2100.0));
}

TEST(Jumps, DoNotSpoilTheOrder) {
  // A push of 1e-6 m/s^2 (0.5 km along track a day) that turns over every 700 s, against steps of a tenth of that.
  const auto flight = [](double tolerance, double steps) {
    return fly(list(std::make_unique<Alternating>(700.0, 1e-6), std::make_unique<Alternating>(steps, 0.0)), tolerance,
               kDay);
  };
  const CartesianState reference = flight(1e-14, 7.0);
  for (double tolerance : {1e-10, 1e-12}) {
    EXPECT_LT(distance(flight(tolerance, 1e9), reference), 30.0 * 7.1e6 * tolerance);  // as for edges
  }
}

TEST(Jumps, TimesAskedForDoNotChangeABit) {
  const auto propagator = [] {
    return std::make_unique<SpacecraftPropagator>(
        dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kConical),
                           std::make_unique<Alternating>(700.0, 1e-6),
                           std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kMoon))),
        1e-13, 0.0, servicer_state());
  };
  const auto in_one_go = propagator(), irregular = propagator();
  in_one_go->advance_to(20000.0);
  for (double t = 0.123; t < 20000.0; t += 17.3) {
    irregular->advance_to(t);
    static_cast<void>(irregular->accelerations());  // a table asks for forces elsewhere than the integrator stands
  }
  irregular->advance_to(20000.0);
  EXPECT_TRUE(same_bits(in_one_go->state(), irregular->state()));
  EXPECT_GT(in_one_go->edges_crossed(), 4);
}

TEST(Jumps, AnImpulseBeforeThemTakesTheStepAgainAsItWas) {
  // An impulse of nothing at many times about an edge and a date, in the step that ended there or the one after. The
  // forces of the wrong side for a step of 50 s would move the spacecraft along track by 1e-6 * 50 * 3 * 1000 = 0.15 m;
  // the two solutions differ by local errors, 1e-12 of 7e6 m, ten steps.
  Log log;
  const auto forces = [&log] {
    return list(std::make_unique<Switch>([](double t) { return 500.0 - t; }, &log),
                std::make_unique<Alternating>(600.0, 1e-6));
  };
  const CartesianState expected = fly(forces(), 1e-12, 1500.0);
  for (double t = 440.0; t < 660.0; t += 4.0) {
    SpacecraftPropagator propagator(dynamics_with(forces()), 1e-12, 0.0, servicer_state());
    propagator.advance_to(t);
    propagator.apply_impulse_rtn(Vector3::Zero());
    propagator.advance_to(1500.0);
    EXPECT_LT(distance(propagator.state(), expected), 1e-4) << t;
  }
}

TEST(Dynamics, SharesAddUpAndLeaveTheRegime) {
  const auto dynamics = dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical),
                                           std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kSun)));
  dynamics->enter_regime_of(0.0, servicer_state());
  ASSERT_EQ(dynamics->edge_count(), 1);
  const auto side = dynamics->regime().sides;
  // Behind the Earth: there the light's share is nothing, whatever the integrator was told.
  CartesianState behind = servicer_state();
  behind.position_eci = -7e6 * sun_moon_series(tt_of(test::mission_epoch())).sun_eci.normalized();
  const auto shares = dynamics->accelerations(0.0, behind);
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_EQ(shares[0].force, "inertial J2");
  EXPECT_EQ(shares[1].force, "radiation_pressure");
  EXPECT_EQ(shares[1].acceleration_eci, Vector3::Zero());
  EXPECT_EQ(shares[2].force, "sun");
  EXPECT_EQ(dynamics->regime().sides, side);

  Vector3 sum = Vector3::Zero();
  for (const auto& share : dynamics->accelerations(0.0, servicer_state())) sum += share.acceleration_eci;
  EXPECT_EQ(sum, dynamics->perturbation_eci(0.0, servicer_state()));
}

TEST(Dynamics, MeasuresTimeOnlyWhenAsked) {
  const auto dynamics = dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)));
  const auto total = [&] {
    double sum = 0.0;
    for (const auto& time : dynamics->times()) sum += time.wall_s;
    return sum;
  };
  const Vector3 untimed = dynamics->perturbation_eci(0.0, servicer_state());
  EXPECT_EQ(total(), 0.0);
  dynamics->measure_time(true);
  EXPECT_EQ(dynamics->perturbation_eci(0.0, servicer_state()), untimed);
  EXPECT_GT(total(), 0.0);
  ASSERT_EQ(dynamics->times().size(), 3u);
  EXPECT_EQ(dynamics->times()[0].force, "frames");
  EXPECT_EQ(dynamics->times()[2].force, "radiation_pressure");
}

/// A thrust along the velocity, m/s^2: forwards it leaves the ellipse, backwards it falls.
class Thrust final : public Force {
 public:
  explicit Thrust(double along_velocity) : along_velocity_(along_velocity) {}
  std::string_view name() const override { return "thrust"; }
  Vector3 acceleration_eci(const ForceInput& input) override {
    return along_velocity_ * input.velocity_eci.normalized();
  }

 private:
  double along_velocity_;
};

TEST(Propagator, SaysWhoLeavesItsOrbitAndWhen) {
  // The mission begins at 2011-07-18T01:00:00 UTC; both last under an hour.
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(error_of([] { fly(list(std::make_unique<Thrust>(-0.5)), 1e-12, 20000.0); }),
              AllOf(HasSubstr("spacecraft \"test\": re-enters: "), HasSubstr(" km above the Earth at 2011-07-18T01:")));
  EXPECT_THAT(error_of([] { fly(list(std::make_unique<Thrust>(5.0)), 1e-12, 20000.0); }),
              AllOf(HasSubstr("spacecraft \"test\": the orbit is not an ellipse"), HasSubstr(", at 2011-07-18T01:")));
  const auto start_at = [](double scale_r, double scale_v) {
    CartesianState state = servicer_state();
    state.position_eci *= scale_r;
    state.velocity_eci *= scale_v;
    SpacecraftPropagator(dynamics_with({}), 1e-12, 0.0, state);
  };
  // 7076.7 km from the centre at the start: 79.9 and 80.1 km above 6378.1363 km.
  const double start = servicer_state().position_eci.norm();
  EXPECT_THAT(error_of([&] { start_at((test::kEarthRadius + 79.9e3) / start, 1.05); }),
              HasSubstr("spacecraft \"test\": re-enters: 79.9 km above the Earth at 2011-07-18T01:00:00"));
  EXPECT_EQ(error_of([&] { start_at((test::kEarthRadius + 80.1e3) / start, 1.05); }), "");
  EXPECT_THAT(error_of([&] { start_at(1.0, 1.5); }),
              HasSubstr("spacecraft \"test\": the orbit is not an ellipse: at distance"));
}

}  // namespace
}  // namespace vbar::truth
