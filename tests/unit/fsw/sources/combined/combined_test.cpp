// Two sources at one trunk, a kilometre apart: their information adds up, one that errs is suspended and leaves the
// orbit to the other, and a change of sources changes no covariance.

#include <memory>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "fsw/sources/bearings/bearing_aiding.h"
#include "fsw/sources/bearings/bearing_rows.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/navigation/angles_only_scene.h"
#include "tests/unit/fsw/sources/carrier_pair/trunk_pair.h"

namespace vbar::fsw::sources {
namespace {

using navigation::test::bearing_of;
using navigation::test::Noise;
using test::kEarth;

constexpr double kBearingSigma = 12.0 * navigation::test::kArcsec;
constexpr std::size_t kCarrier = 0, kBearings = 1;  // numbers of the sources

Vector3 sun() {
  return navigation::test::scene_sun();
}

/// The cooperating pair at a kilometre on a passively safe orbit, with a camera beside the receivers.
struct CombinedPair : test::TrunkPair {
  explicit CombinedPair(unsigned seed) : TrunkPair(seed, 3.2e-3 * std::sqrt(3.0), 1e-3), noise(seed) {
    const auto chief = orbit::qns_from_cartesian(servicer.start).value();
    const Vector6 a_roe_m = (Vector6() << 0.0, -1000.0, 0.0, 60.0, 0.0, 60.0).finished();
    target.start = orbit::target_from_roe(chief, a_roe_m / chief.a).value();
    trunk_settings.relative_orbit.from_sun.sigma = 1e-10;
    trunk_settings.relative_orbit.along_track.sigma = 1e-10;
    trunk_settings.relative_orbit.empirical.sigma = 1e-10;
    trunk_settings.centroid_wander.sigma = 1e-4;
    trunk_settings.brightness_offset.sigma = 1e-4;
    trunk_settings.boresight_a.sigma = 1e-7;
    begin_trunk();
    BearingSettings bearing_settings;
    bearing_settings.model.centroid_noise_m = 0.0;
    camera.configure(bearing_settings);
  }

  /// `bias`: rad, of both components.
  navigation::BearingMeasurement bearing(double bias = 0.0) {
    const Vector2 error = kBearingSigma * noise.normal2() + Vector2::Constant(bias);
    return bearing_of(tag, servicer.state_at(tag), target.state_at(tag), kBearingSigma, error);
  }

  /// Epochs of both receivers, and a bearing after each.
  void fly(int epochs, bool with_receivers, bool with_bearings, double bias = 0.0) {
    for (int k = 0; k < epochs; ++k, tag = tag + duration_of_seconds(10)) {
      estimator->set_source(kCarrier);
      const auto ours = servicer.observe(tag, satellites, kEarth);
      const auto theirs = target.observe(tag, satellites, kEarth);
      step(ours, with_receivers ? &theirs : nullptr);
      const auto seen = bearing(bias);
      estimator->set_source(kBearings);
      if (with_bearings) status = camera.process(tag, seen, sun(), *estimator);
      largest_error.add(error_in_sigmas());
    }
  }

  [[nodiscard]] double error_in_sigmas() const {
    if (!estimator->has_relative()) return 0.0;
    const Matrix3 covariance = trunk_covariance().topLeftCorner<3, 3>();
    return trunk_position_error() / std::sqrt(covariance.trace());
  }

  Noise noise;
  BearingAiding camera;
  BearingEditStatus status = BearingEditStatus::kNone;
  accuracy::Largest largest_error;  ///< of position, in sigmas
};

TEST(CombinedSources, InformationAddsUp) {
  CombinedPair pair(1);
  pair.fly(1, false, false);
  pair.fly(1, false, false);  // two positions initialise the own orbit
  const GpsTime tag = pair.tag - duration_of_seconds(10);
  pair.tag = tag;
  trunk::Trunk& start = *pair.estimator;
  const auto roe = orbit::roe_of_target(start.servicer(), pair.target.state_at(tag)).value();
  constexpr double kWide = 3.0 / 7087300.0;
  start.begin_relative(roe, kWide * kWide * Matrix6::Identity(), trunk::RelativeKnowledge::kEstimated);

  const auto with_bearing = [&](trunk::Trunk& trunk) {
    auto seen = bearing_of(tag, pair.servicer.state_at(tag), pair.target.state_at(tag), kBearingSigma, Vector2::Zero());
    BearingModel model;
    model.centroid_noise_m = 0.0;
    ASSERT_EQ(bearing_rows(trunk, seen, sun(), model), Status::kOk);
    ASSERT_TRUE(trunk.fold());
  };
  const auto ours = pair.servicer.observe(tag, pair.satellites, kEarth);
  const auto theirs = pair.target.observe(tag, pair.satellites, kEarth);
  const auto with_codes = [&](trunk::Trunk& trunk) {
    const auto frame = navigation::EarthFrame::at(tag, kEarth);
    auto differences = std::make_unique<navigation::DifferentialEpoch>();
    navigation::form_differences(ours, theirs, pair.store, frame, *differences);
    CarrierFilter filter;
    filter.begin_blocks(trunk);
    const AntennaPlatform servicer{.R_eci_body = pair.servicer.R_eci_body_at(tag),
                                   .antenna_body_m = pair.nominal_antenna_m,
                                   .clock_m = gnss::kSpeedOfLight * pair.servicer.clock_s};
    const AntennaPlatform target{.R_eci_body = pair.target.R_eci_body_at(tag),
                                 .antenna_body_m = pair.nominal_antenna_m,
                                 .clock_m = gnss::kSpeedOfLight * pair.target.clock_s};
    const CarrierUpdate update = filter.take(*differences, servicer, target, trunk);
    ASSERT_GT(update.codes_used, 8);
  };
  const auto information = [&](bool bearing, bool codes) -> Matrix6 {
    auto trunk = std::make_unique<trunk::Trunk>(start);
    if (bearing) with_bearing(*trunk);
    if (codes) with_codes(*trunk);
    return trunk->roe_covariance().inverse();
  };
  const Matrix6 prior = information(false, false);
  const Matrix6 sum = information(true, false) + information(false, true) - prior;
  const Matrix6 both = information(true, true);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> ratio(both, sum, Eigen::EigenvaluesOnly);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(ratio.eigenvalues()(k), 1.0, 0.01) << k;
  // Both contribute: more than the prior, and each more than the other in some direction.
  EXPECT_GT((information(true, false) - prior).trace(), 10.0 * prior.trace());
  EXPECT_GT((information(false, true) - prior).trace(), 10.0 * prior.trace());
}

TEST(CombinedSources, OneInErrorIsSuspendedAndLeavesTheOrbitToTheOther) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    CombinedPair pair(seed), without(seed);
    pair.fly(40, true, true);
    without.fly(40, true, true);
    ASSERT_EQ(pair.camera.aid().state(), AidState::kAiding) << seed;
    // Both components off by five sigma, from now on.
    pair.fly(10, true, true, 5.0 * kBearingSigma);
    without.fly(10, true, false);
    EXPECT_EQ(pair.camera.aid().state(), AidState::kSuspended) << seed;
    EXPECT_EQ(pair.camera.counters().inflations, 0) << seed;
    const Vector6 apart = pair.trunk_error() - without.trunk_error();
    const double distance = std::sqrt(apart.dot(without.trunk_covariance().inverse() * apart));
    EXPECT_LT(distance, 1.0) << seed;
    // The orbit stays, and bearings that agree again are used.
    pair.fly(60, true, true, 5.0 * kBearingSigma);
    EXPECT_EQ(pair.camera.aid().state(), AidState::kSuspended) << seed;
    EXPECT_LT(pair.largest_error, 3.0) << seed;
    pair.fly(10, true, true);
    EXPECT_EQ(pair.camera.aid().state(), AidState::kAiding) << seed;
    EXPECT_EQ(pair.estimator->failures(), 0);
  }
}

// bearings -> carrier phase -> bearings, each stopped where the next one starts: neither step changes the covariance of
// the orbit, and the error never exceeds three sigmas.
TEST(CombinedSources, AChangeOfSourcesLeavesTheOrbit) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    CombinedPair pair(seed);
    pair.fly(12, true, true);
    const auto change = [&](auto&& stop) {
      const Matrix6 covariance = pair.estimator->roe_covariance();
      const Vector6 roe = pair.estimator->roe();
      stop();
      EXPECT_EQ(pair.estimator->roe_covariance(), covariance);
      EXPECT_EQ(pair.estimator->roe(), roe);
    };
    const GpsTime stopped = pair.tag - duration_of_seconds(10);
    change([&] { pair.carrier->stop(stopped, *pair.estimator); });
    pair.fly(60, false, true);
    change([&] { pair.camera.stop(pair.tag, *pair.estimator); });
    pair.carrier->aid().go_to(AidState::kWaiting, pair.tag);
    pair.fly(60, true, false);
    EXPECT_TRUE(pair.carrier->is_fixed()) << seed;
    EXPECT_EQ(pair.carrier->counters().restarts, 0) << seed;
    change([&] { pair.carrier->stop(pair.tag, *pair.estimator); });
    pair.fly(60, false, true);
    EXPECT_EQ(pair.camera.aid().state(), AidState::kAiding);
    EXPECT_LT(pair.largest_error, 3.0) << seed;
  }
}

}  // namespace
}  // namespace vbar::fsw::sources
