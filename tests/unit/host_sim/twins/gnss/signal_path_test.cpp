#include "host_sim/twins/gnss/signal_path.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/support/gnss_scene.h"

namespace vbar::twins::gnss {
namespace {

using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;

Vector3 turned(const Vector3& v, double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitZ()) * v;
}

// An antenna in the missions' orbit `offset_s` after the start.
AntennaState antenna_at(double offset_s) {
  const BodyTruth body = test::in_orbit(0.0);
  AntennaState antenna;
  antenna.time = test::kGnssStart;
  antenna.offset_s = offset_s;
  // Straight on: what the orbit does meanwhile is not the subject.
  const Vector3 position_eci = body.position_eci + offset_s * body.velocity_eci;
  const Vector3 rotation = fsw::gnss::kEarthRateGps * Vector3::UnitZ();
  antenna.position_ecef = turned(position_eci, -rotation.z() * offset_s);
  antenna.velocity_ecef = turned(body.velocity_eci, -rotation.z() * offset_s) - rotation.cross(antenna.position_ecef);
  antenna.boresight_ecef = antenna.position_ecef.normalized();
  return antenna;
}

// The travel time by bisection in an inertial frame, where nothing turns: the Earth-fixed orbit of the satellite
// carried along with the Earth to each instant.
double inertial_range_m(const Constellation& constellation, std::size_t index, const AntennaState& antenna) {
  const double rate = fsw::gnss::kEarthRateGps;
  const Vector3 receiver = turned(antenna.position_ecef, rate * antenna.offset_s);
  double low_s = 0.0;
  double high_s = 0.2;
  for (int k = 0; k < 60; ++k) {
    const double travel_s = (low_s + high_s) / 2.0;
    const double sent_s = antenna.offset_s - travel_s;
    const Vector3 satellite =
        turned(constellation.true_state(index, antenna.time, sent_s).position_ecef, rate * sent_s);
    ((satellite - receiver).norm() > kSpeedOfLight * travel_s ? low_s : high_s) = travel_s;
  }
  return kSpeedOfLight * low_s;
}

// 1e-6 m: what doubles leave of 4e7 m after three rotations, some of their last bits (7e-9 m).
TEST(SignalPath, RangeAgreesWithTheInertialFrame) {
  const auto constellation = test::constellation(1);
  const AntennaState antenna = antenna_at(-0.0004);
  accuracy::Largest largest;
  int visible = 0;
  for (std::size_t k = 0; k < constellation->size(); ++k) {
    const auto path = visible_path(*constellation, k, antenna, {});
    if (!path) continue;
    ++visible;
    largest.add(std::abs(path->range_m - inertial_range_m(*constellation, k, antenna)));
    EXPECT_GT(path->shapiro_m, 0.005);  // Ashby 2003: below 2 cm from medium orbits to the ground, more along the limb
    EXPECT_LT(path->shapiro_m, 0.03);
  }
  EXPECT_GT(visible, 10);
  accuracy::expect_below("GNSS emulator: range with light time and Earth rotation",
                         "bisection in the inertial frame, all satellites in view", largest, 1e-6, "m");
}

// Central differences over 1 s of the range err by jerk / 24: that of a straight motion at 7.5 km/s past a satellite is
// at most v^3 / r^2 = 1e-3 m/s^3, and a third of the rotating orbits' acceleration besides: below 1e-3 m/s.
TEST(SignalPath, RangeRateIsItsDerivative) {
  const auto constellation = test::constellation(
      1, {.orbit_error_radial_m = 0.0, .orbit_error_transverse_m = 0.0, .orbit_error_normal_m = 0.0});
  for (std::size_t k = 0; k < constellation->size(); ++k) {
    const auto before = visible_path(*constellation, k, antenna_at(-0.5), {});
    const auto here = visible_path(*constellation, k, antenna_at(0.0), {});
    const auto after = visible_path(*constellation, k, antenna_at(0.5), {});
    if (!before || !here || !after) continue;
    EXPECT_NEAR(here->range_rate_mps, after->range_m - before->range_m, 1e-3) << name_of(constellation->id(k));
  }
}

// What the broadcast set predicts differs from the truth by the satellite's errors: with none, by the message's
// rounding.
TEST(SignalPath, BroadcastPredictsTheTruth) {
  const auto constellation = test::constellation(1, {.orbit_error_radial_m = 0.0,
                                                     .orbit_error_transverse_m = 0.0,
                                                     .orbit_error_normal_m = 0.0,
                                                     .clock_error_ns = 0.0});
  const AntennaState antenna = antenna_at(0.0);
  for (std::size_t k = 0; k < constellation->size(); ++k) {
    const auto path = visible_path(*constellation, k, antenna, {});
    if (!path) continue;
    const SignalPath predicted = broadcast_path(constellation->broadcast_set(k, antenna.time).ephemeris, antenna);
    EXPECT_NEAR(path->range_m, predicted.range_m, 0.2) << name_of(constellation->id(k));
    EXPECT_NEAR(path->satellite_clock_s, predicted.satellite_clock_s, 5e-10) << name_of(constellation->id(k));
  }
}

// Each mask alone, against the angle it is about.
TEST(SignalPath, EachMaskHidesWhatItSays) {
  const auto constellation = test::constellation(1);
  const AntennaState antenna = antenna_at(0.0);
  const VisibilitySettings open{.transmit_aperture_deg = 360.0,
                                .receiver_mask_deg = 360.0,
                                .horizon_mask_deg = -90.0,
                                .occultation_altitude_km = 0.0};
  constexpr double kDegree = std::numbers::pi / 180.0;
  int hidden = 0;
  for (std::size_t k = 0; k < constellation->size(); ++k) {
    const Vector3 satellite = constellation->true_state(k, antenna.time, -0.07).position_ecef;
    const Vector3 line = (satellite - antenna.position_ecef).normalized();
    const double elevation_deg = std::asin(line.dot(antenna.boresight_ecef)) / kDegree;
    const double off_nadir_deg = std::acos(line.dot(satellite.normalized())) / kDegree;
    const auto seen = [&](auto change) {
      VisibilitySettings settings = open;
      change(settings);
      return visible_path(*constellation, k, antenna, settings).has_value();
    };
    // The Earth of 6378 km hides what is below its limb, 25.85 deg under the horizontal from 7087.3 km.
    if (std::abs(elevation_deg + 25.85) > 0.1) {
      EXPECT_EQ(seen([](auto&) {}), elevation_deg > -25.85);
    }
    if (elevation_deg < -25.0) {
      ++hidden;
      continue;
    }
    const auto near = [](double a, double b) { return std::abs(a - b) < 0.1; };
    if (!near(elevation_deg, -10.0)) {
      EXPECT_EQ(seen([](auto& s) { s.horizon_mask_deg = -10.0; }), elevation_deg > -10.0);
    }
    if (!near(elevation_deg, 10.0)) {
      EXPECT_EQ(seen([](auto& s) { s.receiver_mask_deg = 160.0; }), elevation_deg > 10.0);
    }
    if (!near(off_nadir_deg, 12.0)) {
      EXPECT_EQ(seen([](auto& s) { s.transmit_aperture_deg = 24.0; }), off_nadir_deg < 12.0);
    }
  }
  EXPECT_GT(hidden, 10);
}

}  // namespace
}  // namespace vbar::twins::gnss
