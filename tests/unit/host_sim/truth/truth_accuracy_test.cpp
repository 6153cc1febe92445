// How true the truth is: against another program's numbers, and against an independent integration of the same forces.

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/truth/force_list.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/spacecraft_propagator.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;
using test::cowell;
using test::mission_epoch;

std::unique_ptr<SpacecraftDynamics> dynamics_with(std::unique_ptr<Force> force) {
  std::vector<std::unique_ptr<Force>> forces;
  forces.push_back(std::move(force));
  return test::dynamics_with(std::move(forces));
}

std::unique_ptr<SpacecraftDynamics> gravity_60() {
  const auto model = load_gravity_coefficients(test::kDataDirectory / "gravity/ggm05s_120.txt", 60);
  return dynamics_with(std::make_unique<GravityForce>(std::make_shared<const GravityField>(model, 60, 60)));
}

fsw::GpsTime after(double seconds) {
  return mission_epoch() + fsw::nearest_duration(seconds);
}

TEST(TruthAccuracy, J2OrbitOfAnotherProgram) {
  // The mission's table state after 21600 s under J2 alone, printed to 0.1 mm and 1e-6 m/s: half a unit of it, and 0.1
  // mm for this propagation (measured against Cowell below).
  SpacecraftPropagator propagator(dynamics_with(std::make_unique<test::InertialJ2>()), 1e-13, 0.0,
                                  test::servicer_state());
  propagator.advance_to(21600.0);
  const CartesianState end = propagator.state();
  accuracy::expect_below("six hours under J2 alone, position", "another program, printed to 0.1 mm",
                         accuracy::largest_entry(end.position_eci - Vector3(750773.9627, 4583790.1554, -5352715.4900)),
                         1.5e-4, "m");
  EXPECT_LT(accuracy::largest_entry(end.velocity_eci - Vector3(712.735141, -5721.338951, -4787.387539)), 6e-7);
}

TEST(TruthAccuracy, VariationalEquationsAgainstCowellOverALeg) {
  // Six hours, 60x60. Claims: position 1 mm, relative position of two spacecraft 10 m apart 0.1 mm. The reference's own
  // error is shown by a second run of it at a tenfold tolerance: below a tenth of each claim.
  constexpr double kLeg = 21600.0;
  const auto dynamics = gravity_60();
  const CartesianState servicer = cowell(*dynamics, test::servicer_state(), 0.0, kLeg);
  const CartesianState target = cowell(*dynamics, test::target_state(10.0), 0.0, kLeg);
  const CartesianState coarser = cowell(*dynamics, test::servicer_state(), 0.0, kLeg, 1e-13);
  ASSERT_LT((coarser.position_eci - servicer.position_eci).norm(), 1e-4);

  TruthModel model(test::mission_settings());
  model.add_spacecraft("servicer", test::servicer_state());
  model.add_spacecraft("target", test::target_state(10.0));
  model.advance_to(after(kLeg));
  const double position_error = (model.state(0).position_eci - servicer.position_eci).norm();
  const double velocity_error = (model.state(0).velocity_eci - servicer.velocity_eci).norm();
  const Vector3 relative = model.state(1).position_eci - model.state(0).position_eci;
  const double relative_error = (relative - (target.position_eci - servicer.position_eci)).norm();
  constexpr const char* kReference = "Cowell's equations by Fehlberg 7(8), the same 60x60 gravity";
  accuracy::expect_below("six hours of the variational equations, position", kReference, position_error, 1e-3, "m");
  EXPECT_LT(velocity_error, 1e-6);  // the position's error times the mean motion, 1e-3 1/s
  accuracy::expect_below("six hours of the variational equations, relative position of two spacecraft 10 m apart",
                         kReference, relative_error, 1e-4, "m");
}

TEST(TruthAccuracy, AllSmoothForcesAgainstCowellOverALeg) {
  // As above with drag, Sun, Moon, tides and relativity (sunlight and its edges: edges_test.cpp), each spacecraft its
  // own ballistic coefficient.
  constexpr double kLeg = 21600.0;
  TruthSettings settings = test::mission_settings();
  settings.forces.drag = settings.forces.sun = settings.forces.moon = true;
  settings.forces.solid_tides = settings.forces.relativity = true;
  settings.end = after(kLeg);
  const SpacecraftSettings servicer{"servicer", test::servicer_state(), {154.0, 1.3, 2.5, 2.5, 1.32}};
  const SpacecraftSettings target{"target", test::target_state(10.0), {40.0, 0.38, 2.25, 0.55, 1.2}};
  TruthModel model(settings);
  const auto by_cowell = [&](const SpacecraftSettings& spacecraft) {
    const auto dynamics = test::dynamics_with(make_forces(settings, model.data(), spacecraft));
    dynamics->enter_interval(0.0);
    return cowell(*dynamics, spacecraft.osculating, 0.0, kLeg);
  };
  const CartesianState servicer_end = by_cowell(servicer);
  const CartesianState target_end = by_cowell(target);

  model.add_spacecraft(servicer);
  model.add_spacecraft(target);
  model.advance_to(after(kLeg));
  const Vector3 relative = model.state(1).position_eci - model.state(0).position_eci;
  constexpr const char* kReference = "Cowell's equations by Fehlberg 7(8), the same forces";
  accuracy::expect_below("six hours with 60x60 gravity, drag, Sun, Moon, tides, relativity: position", kReference,
                         (model.state(0).position_eci - servicer_end.position_eci).norm(), 1e-3, "m");
  accuracy::expect_below("the same: relative position of two unlike spacecraft from 10 m apart", kReference,
                         (relative - (target_end.position_eci - servicer_end.position_eci)).norm(), 1e-4, "m");
}

TEST(TruthAccuracy, StatesBetweenStepsAreAsGood) {
  // Every 7 s over an orbit, from the dense output, against the same model at the finest tolerance.
  TruthModel model(test::mission_settings());
  TruthSettings fine_settings = test::mission_settings();
  fine_settings.tolerance = TruthSettings::kSmallestTolerance;
  TruthModel fine(fine_settings);
  for (TruthModel* m : {&model, &fine}) {
    m->add_spacecraft("servicer", test::servicer_state());
    m->add_spacecraft("target", test::target_state(10.0));
  }
  accuracy::Largest position, relative, relative_velocity;
  for (double t = 7.0; t < 6000.0; t += 7.0) {
    model.advance_to(after(t));
    fine.advance_to(after(t));
    const CartesianState a = model.state(0), b = model.state(1), c = fine.state(0), d = fine.state(1);
    position.add((a.position_eci - c.position_eci).norm());
    relative.add((b.position_eci - a.position_eci - (d.position_eci - c.position_eci)).norm());
    relative_velocity.add((b.velocity_eci - a.velocity_eci - (d.velocity_eci - c.velocity_eci)).norm());
  }
  constexpr const char* kReference = "the same at the finest tolerance, every 7 s of an orbit";
  // The claims of the leg.
  accuracy::expect_below("states between steps, position", kReference, position, 1e-3, "m");
  accuracy::expect_below("states between steps, relative position of two spacecraft 10 m apart", kReference, relative,
                         1e-4, "m");
  EXPECT_LT(relative_velocity, 1e-7);  // the relative position's claim times the mean motion
}

TEST(TruthAccuracy, ImpulsesAgainstCowell) {
  // Three burns on the way, each in RTN by its definition.
  const auto dynamics = gravity_60();
  TruthModel model(test::mission_settings());
  model.add_spacecraft("servicer", test::servicer_state());
  CartesianState reference = test::servicer_state();
  double t = 0.0;
  for (const auto& [time, dv] : {std::pair{1000.123456789, Vector3(0.1, 0.5, -0.2)},
                                 {4000.0, Vector3(0.0, -0.3, 0.4)},
                                 {9000.5, Vector3(-0.2, 0.0, 0.0)}}) {
    model.advance_to(after(time));
    model.apply_impulse_rtn(0, dv);
    reference = cowell(*dynamics, reference, t, time);
    t = time;
    const Vector3 r = reference.position_eci.normalized();
    const Vector3 n = reference.position_eci.cross(reference.velocity_eci).normalized();
    reference.velocity_eci += dv[0] * r + dv[1] * n.cross(r) + dv[2] * n;
  }
  model.advance_to(after(15000.0));
  reference = cowell(*dynamics, reference, t, 15000.0);
  accuracy::expect_below("three impulses in four hours, position",
                         "Cowell's equations, the impulses by their definition",
                         (model.state(0).position_eci - reference.position_eci).norm(), 1e-3,
                         "m");  // the claim over a leg
}

TEST(TruthAccuracy, TheWholeMission) {
  // 41.25 h with the target 75 km away, in steps of a minute, against Cowell. Along-track errors grow with the square
  // of time, so that the leg's claim of 1 mm in 6 h would allow 47 mm here; claimed is 1 mm, and 0.2 mm relative, of
  // which Cowell's own error (against a finer run of it) is 0.15 mm and 0.05 mm. The time it takes is recorded, not
  // judged.
  constexpr double kMission = 148500.0;
  TruthModel model(test::mission_settings());
  model.add_spacecraft("servicer", test::servicer_state());
  model.add_spacecraft("target", test::target_state(-75000.0));
  for (double t = 60.0; t <= kMission; t += 60.0) model.advance_to(after(t));
  const auto dynamics = gravity_60();
  const CartesianState servicer = cowell(*dynamics, test::servicer_state(), 0.0, kMission);
  const CartesianState target = cowell(*dynamics, test::target_state(-75000.0), 0.0, kMission);
  const double position_error = (model.state(0).position_eci - servicer.position_eci).norm();
  const Vector3 relative = model.state(1).position_eci - model.state(0).position_eci;
  const double relative_error = (relative - (target.position_eci - servicer.position_eci)).norm();
  RecordProperty("wall_ms_per_simulated_hour", std::to_string(model.statistics().wall_s * 1e3 / (kMission / 3600.0)));
  constexpr const char* kReference = "Cowell's equations by Fehlberg 7(8), the same 60x60 gravity, 0.15 mm itself";
  accuracy::expect_below("41.25 hours of the variational equations, position", kReference, position_error, 1e-3, "m");
  accuracy::expect_below("41.25 hours of the variational equations, relative position at 75 km", kReference,
                         relative_error, 2e-4, "m");
}

}  // namespace
}  // namespace vbar::truth
