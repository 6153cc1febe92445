// Interpolated states are those of the orbit to within the bound that is stated, or the file is refused. The orbit is a
// circular Keplerian one, and the remainder of a polynomial through its states is known: f^(m) is (n^m) r.

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/orbit_files/orbit_file.h"

namespace vbar::orbit_files {
namespace {

using fsw::Vector3;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kMu = 3.986004415e14, kRadius_m = 6778.0e3, kInclination = 0.9;
const double kRate = std::sqrt(kMu / (kRadius_m * kRadius_m * kRadius_m));

TimedState circular(double t) {
  const double u = kRate * t;
  const Vector3 node = Vector3::UnitX(), ahead(0.0, std::cos(kInclination), std::sin(kInclination));
  TimedState one;
  one.time = fsw::GpsTime{} + fsw::nearest_duration(t);
  one.state.position_eci = kRadius_m * (std::cos(u) * node + std::sin(u) * ahead);
  one.state.velocity_eci = kRadius_m * kRate * (std::cos(u) * ahead - std::sin(u) * node);
  return one;
}

Track track_of(double step_s, int count, bool has_velocities = true) {
  Track track;
  track.object = "A";
  track.has_velocities = has_velocities;
  for (int k = 0; k < count; ++k) track.states.push_back(circular(k * step_s));
  return track;
}

FramedState at(const Track& track, double t) {
  return interpolated(track, fsw::GpsTime{} + fsw::nearest_duration(t), "orbit.oem");
}

double error_m(const Track& track, double t) {
  return (at(track, t).state.position_eci - circular(t).state.position_eci).norm();
}

std::string refusal(const Track& track, double t) {
  try {
    static_cast<void>(at(track, t));
  } catch (const std::out_of_range& error) {
    return error.what();
  }
  return "";
}

TEST(Interpolation, ErrsByLessThanTheBoundThatItStates) {
  int accepted = 0;
  for (const bool has_velocities : {true, false})
    for (const double step_s : {30.0, 60.0, 120.0, 240.0, 300.0, 420.0, 600.0}) {
      const Track track = track_of(step_s, 21, has_velocities);
      for (double place = 0.05; place < 20.0; place += 0.43) {
        const double t = place * step_s;
        if (!refusal(track, t).empty()) continue;
        ++accepted;
        const FramedState found = at(track, t);
        ASSERT_TRUE(found.interpolation);
        // Double precision leaves a micrometre where the bound is nothing.
        EXPECT_LT(error_m(track, t), found.interpolation->bound_m + 1e-5) << step_s << " " << place;
        EXPECT_LE(found.interpolation->bound_m, kMaxInterpolationErrorM);
        EXPECT_EQ(found.interpolation->step_s, step_s);
        if (!has_velocities) continue;
        EXPECT_LT((found.state.velocity_eci - circular(t).state.velocity_eci).norm(),
                  found.interpolation->bound_mps.value() + 1e-6);
      }
    }
  EXPECT_GT(accepted, 300);
}

// (n h)^8 r / 8! times 16 is 8.6 m at 420 s, 1.2 m at 330 s and 148 m at 600 s.
TEST(Interpolation, StatesTooFarApartAreRefusedWithTheirError) {
  EXPECT_EQ(refusal(track_of(330.0, 21), 10.5 * 330.0), "");
  EXPECT_THAT(refusal(track_of(600.0, 21), 10.5 * 600.0),
              AllOf(HasSubstr("orbit.oem: no state of A at "), HasSubstr("600 s apart"), HasSubstr("error of 1"),
                    HasSubstr("Hermite polynomial of degree 7"), HasSubstr("accepted: up to 10 m")));
  EXPECT_THAT(refusal(track_of(1800.0, 21), 10.5 * 1800.0), HasSubstr("up to a quarter of a revolution"));
  // At steps of a revolution all states are alike, and each is found again from its neighbours.
  const double period_s = 2.0 * std::numbers::pi / kRate;
  EXPECT_THAT(refusal(track_of(period_s, 21), 10.5 * period_s), HasSubstr("up to a quarter of a revolution"));
  EXPECT_EQ(error_m(track_of(3600.0, 21), 7200.0), 0.0) << "a state of the file itself";
}

TEST(Interpolation, FollowsThePublishedRule) {
  constexpr double kStep_s = 120.0;
  Track track = track_of(kStep_s, 21);
  const auto remainder = [&](int degree, double product) {
    return kRadius_m * std::pow(kRate * kStep_s, degree + 1) / std::tgamma(degree + 2) * product;
  };
  track.published_rule = InterpolationRule{Polynomial::kLagrange, 5, true};
  // Midway between two of six states: (2.5 1.5 0.5)^2.
  EXPECT_NEAR(error_m(track, 10.5 * kStep_s), remainder(5, 3.515625), 0.05 * remainder(5, 3.515625));
  EXPECT_EQ(at(track, 10.5 * kStep_s).interpolation->rule.degree, 5);
  track.published_rule = InterpolationRule{Polynomial::kHermite, 5, true};
  // Three states, the third one behind the middle step: (0.5 0.5 1.5)^2.
  EXPECT_NEAR(error_m(track, 10.5 * kStep_s), remainder(5, 0.140625), 0.05 * remainder(5, 0.140625));
  track.published_rule = InterpolationRule{Polynomial::kLagrange, 1, true};
  EXPECT_THAT(refusal(track, 10.5 * kStep_s), HasSubstr("by the Lagrange polynomial of degree 1 that the file states"));
}

TEST(Interpolation, StopsAtGaps) {
  Track track = track_of(60.0, 61);
  track.states.erase(track.states.begin() + 20, track.states.begin() + 40);
  EXPECT_THAT(refusal(track, 1800.0),
              HasSubstr("have a gap from 1980-01-06T00:19:00.000Z to 1980-01-06T00:40:00.000Z"));
  // On either side of it the states of that side are enough.
  EXPECT_LT(error_m(track, 1110.0), 1e-4);
  EXPECT_LT(error_m(track, 2450.0), 1e-4);
  EXPECT_EQ(error_m(track, 2400.0), 0.0);
  // A single state that is missing leaves a step of twice the others: no gap, and still exact.
  track = track_of(60.0, 61);
  track.states.erase(track.states.begin() + 20);
  EXPECT_LT(error_m(track, 1200.0), 1e-3);
  track.largest_step_s = 90.0;  // of an SP3 file of 60 s
  EXPECT_THAT(refusal(track, 1200.0), HasSubstr("gap"));
}

// What does not fit its neighbours: a maneuver of 1 m/s, and velocities relative to the rotating Earth in a file that
// claims another frame.
TEST(Interpolation, StatesThatContradictEachOtherAreRefused) {
  Track track = track_of(60.0, 61);
  for (std::size_t k = 30; k < track.states.size(); ++k) {
    track.states[k].state.velocity_eci += Vector3(1.0, 0.0, 0.0);
    track.states[k].state.position_eci += Vector3(60.0 * static_cast<double>(k - 29), 0.0, 0.0);
  }
  EXPECT_THAT(refusal(track, 29.5 * 60.0), HasSubstr("left out"));
  EXPECT_EQ(refusal(track, 10.5 * 60.0), "") << "far from it";
  track = track_of(60.0, 61);
  for (TimedState& one : track.states)
    one.state.velocity_eci -= Vector3(0, 0, 7.292115e-5).cross(one.state.position_eci);
  EXPECT_THAT(refusal(track, 10.5 * 60.0), HasSubstr("left out"));
}

TEST(Interpolation, TooFewStatesToCheckAreRefused) {
  EXPECT_THAT(refusal(track_of(60.0, 2), 30.0), HasSubstr("2 states without a gap are too few"));
  EXPECT_EQ(refusal(track_of(60.0, 3), 30.0), "");
  EXPECT_THAT(refusal(track_of(60.0, 5, false), 30.0), HasSubstr("accepted: 6 or more"));
  EXPECT_EQ(refusal(track_of(60.0, 6, false), 30.0), "");
  EXPECT_THAT(refusal(track_of(60.0, 1, false), 0.0), HasSubstr("one position and no velocity"));
}

}  // namespace
}  // namespace vbar::orbit_files
