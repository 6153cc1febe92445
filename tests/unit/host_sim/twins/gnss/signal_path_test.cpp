#include "host_sim/twins/gnss/signal_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "fsw/gnss/constants.h"
#include "host_sim/twins/gnss/body_frame.h"
#include "host_sim/twins/gnss/constellation.h"
#include "tests/support/accuracy.h"
#include "tests/support/figures.h"
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

namespace {

constexpr int kDraws = 4000;

// Appendix A: centre of mass uniform in a ball of 3 mm (mean square 3/5 R^2), phase centre 5 mm in a direction drawn
// (mean square of a component L^2/3), antenna 30 and attitude 20 arcsec. Sample mean squares of 4000 are
// within 10 % (4 sigma and more).
TEST(BodyFrame, DrawsAreThoseOfTheTable) {
  const BodyFrameSettings settings;
  double com_square = 0.0, pco_z_square = 0.0, antenna_square = 0.0, attitude_square = 0.0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    const BodyFrameErrors errors = draw_body_frame(settings, seed, "servicer");
    EXPECT_LE(errors.com_m.norm(), 3e-3);
    EXPECT_NEAR(errors.pco_m.norm(), 5e-3, 1e-12);
    com_square += errors.com_m.squaredNorm();
    pco_z_square += errors.pco_m.z() * errors.pco_m.z();
    antenna_square += errors.antenna_rotation.squaredNorm();
    attitude_square += errors.attitude_rotation.squaredNorm();
  }
  EXPECT_NEAR(com_square / kDraws / (0.6 * 9e-6), 1.0, 0.1);
  EXPECT_NEAR(pco_z_square / kDraws / (25e-6 / 3.0), 1.0, 0.1);
  EXPECT_NEAR(std::sqrt(antenna_square / kDraws / 3.0) / kArcsecond, 30.0, 1.5);
  EXPECT_NEAR(std::sqrt(attitude_square / kDraws / 3.0) / kArcsecond, 20.0, 1.0);
}

// The floor's formula against its own definition over 4000 pairs of draws. By hand: sqrt(2 (5^2 + 0.6 3^2)) = 7.80 mm;
// the 0.3 m arm under 20 arcsec adds 0.04 mm to each.
TEST(BodyFrame, StaticFloor) {
  const BodyFrameSettings settings;
  double square = 0.0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed)
    square += static_floor_m(settings, draw_body_frame(settings, seed, "servicer"), settings,
                             draw_body_frame(settings, seed, "target"))
                  .squaredNorm();
  EXPECT_NEAR(static_floor_rms_m(settings, settings) * 1e3, 7.80, 0.01);
  EXPECT_NEAR(std::sqrt(square / kDraws) / static_floor_rms_m(settings, settings), 1.0, 0.03);
}

// A small rotation of the body carries the antenna along: 0.3 m by 20 arcsec is 29 micrometres.
TEST(BodyFrame, AttitudeErrorMovesTheAntenna) {
  BodyFrameSettings settings;
  BodyFrameErrors errors;
  errors.attitude_rotation = fsw::Vector3(20.0 * kArcsecond, 0.0, 0.0);
  const fsw::Vector3 moved = antenna_from_com(settings, errors) - settings.antenna_in_body_m;
  EXPECT_NEAR(moved.y() * 1e6, -29.09, 0.01);
  EXPECT_NEAR(true_boresight(settings, errors).y(), -20.0 * kArcsecond, 1e-12);
}

}  // namespace

namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr KlobucharCoefficients kExample{{3.82e-8, 1.49e-8, -1.79e-7, 0.0}, {1.43e5, 0.0, -3.28e5, 1.13e5}};

// The worked example that goes with many receivers' manuals (Klobuchar's own coefficients of a winter day): latitude 40
// deg, longitude 260 deg east, elevation 20, azimuth 210 deg, 20:45 UT: 23.784 m. Printed to a millimetre.
TEST(Klobuchar, WorkedExample) {
  const double delay_m = klobuchar_delay_m(kExample, 40.0 * kRadPerDegree, 260.0 * kRadPerDegree, 20.0 * kRadPerDegree,
                                           210.0 * kRadPerDegree, 593100.0);
  accuracy::expect_below("Klobuchar delay on the ground", "worked example, 23.784 m", std::abs(delay_m - 23.784), 5e-4,
                         "m");
}

// Shares of the electron content above 350, 500 and 709 km and the shell over 709 km, computed by hand from Montenbruck
// and Gill 2002 to the digits given.
TEST(Klobuchar, ShareAboveAnOrbit) {
  EXPECT_NEAR(electron_content_above(350e3), 0.8665, 5e-5);
  EXPECT_NEAR(electron_content_above(500e3), 0.362, 5e-4);
  EXPECT_NEAR(electron_content_above(709e3), 0.0541, 5e-5);
  EXPECT_DOUBLE_EQ(electron_content_above(0.0), 1.0);
  EXPECT_NEAR(shell_altitude_m(709e3), 779.7e3, 50.0);
}

// Straight up from an orbit the delay is the vertical one times the share; a ray along the horizontal crosses the shell
// at the angle whose sine is the ratio of the radii.
TEST(Klobuchar, SlantInOrbit) {
  const double radius_m = 6371e3 + 709e3;
  const fsw::Vector3 position(radius_m, 0.0, 0.0);
  const double vertical_m = klobuchar_vertical_delay_m(kExample, 0.0, 0.0, 50400.0) * electron_content_above(709e3);
  EXPECT_NEAR(klobuchar_delay_in_orbit_m(kExample, position, fsw::Vector3::UnitX(), 50400.0), vertical_m, 1e-12);
  const double shell_m = 6371e3 + shell_altitude_m(709e3);
  const double pierce_longitude = std::acos(radius_m / shell_m);
  const double at_pierce_m = klobuchar_vertical_delay_m(kExample, 0.0, pierce_longitude, 50400.0);
  const double slant = 1.0 / std::sqrt(1.0 - radius_m * radius_m / (shell_m * shell_m));
  EXPECT_NEAR(klobuchar_delay_in_orbit_m(kExample, position, fsw::Vector3::UnitY(), 50400.0),
              at_pierce_m * electron_content_above(709e3) * slant, 1e-9);
}

// Over a day in steps of 0.1 s, in which a low orbit moves by less than a kilometre: no step. The series of the cosine
// has a slope of 1 per radian at most.
TEST(Klobuchar, VerticalDelayIsContinuous) {
  const double amplitude_m = fsw::gnss::kSpeedOfLight * kExample.alpha[0];
  double last_m = klobuchar_vertical_delay_m(kExample, 0.0, 0.0, 0.0);
  accuracy::Largest largest_m;
  accuracy::Smallest lowest_m;
  for (int tenths = 1; tenths < 864000; ++tenths) {
    const double delay_m = klobuchar_vertical_delay_m(kExample, 0.0, 0.0, 0.1 * tenths);
    largest_m.add(std::abs(delay_m - last_m));
    lowest_m.add(delay_m);
    last_m = delay_m;
  }
  EXPECT_LT(largest_m, 2.0 * amplitude_m * 2.0 * std::numbers::pi * 0.1 / 72000.0);
  EXPECT_GE(lowest_m, fsw::gnss::kSpeedOfLight * 5e-9 * (1.0 - 1e-12));
}

// From the ground the thin shell and the broadcast obliquity factor are two forms of one mapping: above 30 deg they
// agree within the factor's own error of some percent.
TEST(Klobuchar, ShellAgreesWithBroadcastObliquityOnTheGround) {
  const fsw::Vector3 ground(6371e3, 0.0, 0.0);
  for (const double elevation_deg : {30.0, 50.0, 70.0, 90.0}) {
    const double elevation = elevation_deg * kRadPerDegree;
    const fsw::Vector3 north(std::sin(elevation), 0.0, std::cos(elevation));
    const double shell_m = klobuchar_delay_in_orbit_m(kExample, ground, north, 50400.0);
    const double broadcast_m = klobuchar_delay_m(kExample, 0.0, 0.0, elevation, 0.0, 50400.0);
    EXPECT_NEAR(shell_m / broadcast_m, 1.0, 0.06) << elevation_deg;
  }
}

}  // namespace

}  // namespace vbar::twins::gnss
