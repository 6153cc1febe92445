#include <cmath>
#include <memory>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/measurements/gnss_absolute_source.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/paths.h"
#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/measurements/cdgnss_pair.h"

namespace vbar::fsw::measurements {
namespace {

using gnss::test::kEarth;
using test::FilterPair;

TEST(GnssAbsoluteAiding, ConvergesFromTheFirstTwoPositions) {
  FilterPair pair(31);
  pair.fly_alone(1);
  EXPECT_EQ(pair.own->aid().state(), AidState::kStarting);
  EXPECT_FALSE(pair.estimator->absolute_orbit().started());
  pair.fly_alone(1);
  EXPECT_EQ(pair.own->aid().state(), AidState::kAiding);
  pair.fly_alone(200);
  EXPECT_EQ(pair.own->counters().rejected, 0);
  const orbit::CartesianState truth = pair.servicer.state_at(pair.estimator->epoch());
  // Code noise of 1.2 m, 14 satellites, half an hour: decimetres.
  EXPECT_LT((pair.estimator->servicer().position_eci - truth.position_eci).norm(), 1.0);
  EXPECT_LT((pair.estimator->servicer().velocity_eci - truth.velocity_eci).norm(), 5e-3);
}

TEST(GnssAbsoluteAiding, RefersThePositionToTheCentreOfMass) {
  for (const bool has_attitude : {true, false}) {
    FilterPair pair(32);
    pair.servicer.code_sigma_m = 0.0;
    pair.servicer.antenna_body_m = Vector3(0.0, 0.0, 5.0);
    pair.own->set_antenna(pair.servicer.antenna_body_m);
    for (int k = 0; k < 60; ++k, pair.tag = pair.tag + duration_of_seconds(10)) {
      pair.estimator->advance_to(pair.tag, {});
      std::optional<Matrix3> attitude;
      if (has_attitude) attitude = pair.servicer.R_eci_body_at(pair.tag);
      ASSERT_TRUE(pair.own
                      ->process(pair.servicer.observe(pair.tag, pair.satellites, kEarth), attitude, pair.store,
                                gnss::EarthFrame::at(pair.tag, kEarth), *pair.estimator)
                      .ok());
    }
    const Vector3 error =
        pair.estimator->servicer().position_eci - pair.servicer.state_at(pair.estimator->epoch()).position_eci;
    if (has_attitude) {
      EXPECT_LT(error.norm(), 0.1);
    } else {
      EXPECT_GT(error.norm(), 1.0);
    }
  }
}

TEST(GnssAbsoluteAiding, CountsWhatItCannotUse) {
  FilterPair pair(33);
  pair.fly_alone(20);
  const std::vector<gnss::Ephemeris> all = pair.satellites;
  pair.satellites.resize(6);
  pair.fly_alone(10);
  EXPECT_EQ(pair.own->counters().no_solution, 10);
  EXPECT_EQ(pair.own->aid().state(), AidState::kSuspended);
  pair.satellites = all;
  pair.fly_alone(1);
  EXPECT_EQ(pair.own->aid().state(), AidState::kAiding);
  pair.servicer.start.position_eci += Vector3::Constant(500.0);
  pair.fly_alone(3);
  EXPECT_EQ(pair.own->counters().rejected, 3);
}

/// A burn that nobody reported: positions contradict the orbit, which is inflated and never discarded; the relative
/// orbit is propagated with it all the time.
TEST(GnssAbsoluteAiding, AnUnknownBurnInflatesTheOrbitAndKeepsTheRelativeOne) {
  FilterPair pair(34);
  pair.fly_filter(60);
  const double before = pair.estimator->roe()(1);
  pair.servicer.start.position_eci += 300.0 * pair.servicer.start.velocity_eci.normalized();
  for (int k = 0; k < 40; ++k) {
    pair.fly_alone(1);
    EXPECT_TRUE(pair.estimator->absolute_orbit().started()) << k;
    EXPECT_TRUE(pair.estimator->has_relative()) << k;
  }
  EXPECT_EQ(pair.own->counters().rejected, filter::AbsoluteOrbitFilter::kMaxRejected - 1);
  EXPECT_EQ(pair.estimator->absolute_orbit().inflations(), 1);
  EXPECT_EQ(pair.own->aid().state(), AidState::kAiding);
  const GpsTime time = pair.estimator->epoch();
  const double miss = (pair.estimator->servicer().position_eci - pair.servicer.state_at(time).position_eci).norm();
  EXPECT_LT(miss, 10.0);
  EXPECT_NEAR(7.1e6 * (pair.estimator->roe()(1) - before), 0.0, 1.0);  // of a separation of 9 m
}

// Normalised error squared of position and velocity of the own orbit. Truth: gravity of degree 60, Sun, Moon, tides,
// relativity, and 24 orbits of different nodes and phases; positions with a Gauss-Markov error of 1.5 m over 1800 s and
// white noise of 2 m.
TEST(AbsoluteOrbitFilter, IsConsistentWithItsErrors) {
  constexpr int kSeeds = vbar::test::share_under_sanitizers(24);
  constexpr double kSlow_m = 1.5, kSlowTime_s = 1800.0, kWhite_m = 2.0, kPeriod_s = 30.0;
  truth::TruthSettings settings;
  settings.epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
  settings.end = settings.epoch + duration_of_seconds(86400);
  settings.forces.sun = settings.forces.moon = settings.forces.solid_tides = settings.forces.relativity = true;
  settings.data_directory = vbar::tests::source_path("data");
  truth::TruthModel model(settings);
  const auto now = model.data().earth_orientation->at(settings.epoch);
  filter::FilterSettings filter_settings;
  filter_settings.earth = {.epoch = settings.epoch,
                           .ut1_minus_gps_s = now.ut1_minus_tai_s + 19.0,
                           .ut1_rate = 0.0,
                           .pole_x = now.pole_x,
                           .pole_y = now.pole_y};
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<std::unique_ptr<filter::RelativeNavigationFilter>> filters;
  std::vector<Vector3> slow;
  for (int k = 0; k < kSeeds; ++k) {
    const double degree = M_PI / 180.0;
    model.add_spacecraft("s" + std::to_string(k),
                         orbit::cartesian_from_qns(
                             {7087300.0 + 200.0 * k, 0.0015, 0.0, 98.18 * degree, 15.0 * k * degree, 47.0 * k * degree})
                             .value());
    filters.push_back(std::make_unique<filter::RelativeNavigationFilter>());
    filters.back()->configure(filter_settings);
    slow.push_back(kSlow_m * Vector3(normal(random), normal(random), normal(random)));
  }
  const double decay = std::exp(-kPeriod_s / kSlowTime_s);
  // 99 % of the mean of 24 chi-squares of six degrees at each of the times.
  const double band = 2.58 * std::sqrt(12.0 / kSeeds);
  double mean_of_all = 0.0;
  int evaluated = 0;
  for (int epoch = 1; epoch <= 420; ++epoch) {
    const GpsTime tag = settings.epoch + nearest_duration(kPeriod_s * epoch);
    model.advance_to(tag);
    const bool is_evaluated = epoch == 3 || epoch == 10 || epoch == 30 || epoch % 60 == 0;
    double nees = 0.0;
    Vector6 error_square = Vector6::Zero(), variance = Vector6::Zero();
    for (int k = 0; k < kSeeds; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const orbit::CartesianState truth = model.state(index);
      slow[index] = decay * slow[index] +
                    std::sqrt(1.0 - decay * decay) * kSlow_m * Vector3(normal(random), normal(random), normal(random));
      filter::AbsolutePosition position;
      position.position_eci =
          truth.position_eci + slow[index] + kWhite_m * Vector3(normal(random), normal(random), normal(random));
      position.covariance_m2 = kWhite_m * kWhite_m * Matrix3::Identity();
      filters[index]->advance_to(tag, {});
      filters[index]->update_absolute_orbit(position);
      if (!is_evaluated) continue;
      Vector6 error;
      error << filters[index]->servicer().position_eci - truth.position_eci,
          filters[index]->servicer().velocity_eci - truth.velocity_eci;
      const Matrix6 covariance = filters[index]->absolute_orbit().covariance();
      nees += error.dot(covariance.inverse() * error) / kSeeds;
      error_square += error.cwiseAbs2() / kSeeds;
      variance += covariance.diagonal() / kSeeds;
    }
    if (!is_evaluated) continue;
    if (epoch < 60) {
      // The velocity of the first two positions has a conservative sigma.
      EXPECT_LT(nees, 6.0 + band) << epoch;
      continue;
    }
    EXPECT_NEAR(nees, 6.0, band) << epoch;
    mean_of_all += nees;
    ++evaluated;
  }
  // The times are a correlation time apart: 99 % of the mean of all.
  EXPECT_NEAR(mean_of_all / evaluated, 6.0, band / std::sqrt(static_cast<double>(evaluated)));
}

}  // namespace
}  // namespace vbar::fsw::measurements
