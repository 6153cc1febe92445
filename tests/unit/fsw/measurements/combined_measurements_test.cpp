// Several sources at one filter: their information adds up, one that errs is suspended and leaves the orbit to the
// other, and a change of sources changes no covariance.

#include <memory>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/measurements/bearings/bearing_aiding.h"
#include "fsw/measurements/keypoints/keypoint_aiding.h"
#include "fsw/orbit/roe.h"
#include "tests/support/accuracy.h"
#include "tests/support/sanitizers.h"
#include "tests/support/tango_view.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"
#include "tests/unit/fsw/measurements/cdgnss_pair.h"

namespace vbar::fsw::measurements {
namespace {

using measurements::test::bearing_of;
using measurements::test::Noise;
using test::kEarth;

constexpr double kBearingSigma = 12.0 * measurements::test::kArcsec;

Vector3 sun() {
  return measurements::test::scene_sun();
}

/// The cooperating pair at a kilometre on a passively safe orbit, with a camera beside the receivers.
struct CombinedPair : test::FilterPair {
  explicit CombinedPair(unsigned seed, double distance_m = 1000.0)
      : FilterPair(seed, 3.2e-3 * std::sqrt(3.0), 1e-3), noise(seed) {
    const auto chief = orbit::qns_from_cartesian(servicer.start).value();
    const Vector6 a_roe_m = distance_m * (Vector6() << 0.0, -1.0, 0.0, 0.06, 0.0, 0.06).finished();
    target.start = orbit::target_from_roe(chief, a_roe_m / chief.a).value();
    filter_settings.relative_orbit.from_sun.sigma = 1e-10;
    filter_settings.relative_orbit.drag.sigma = 1e-10;
    filter_settings.relative_orbit.empirical.sigma = 1e-10;
    filter_settings.processes.of<CentroidWander>().sigma = 1e-4;
    filter_settings.processes.of<BrightnessOffset>().sigma = 1e-4;
    filter_settings.processes.of<EarthlightOffset>().sigma = 1e-4;
    filter_settings.processes.of<BearingBias>().sigma = 1e-7;
    begin_filter();
    set_centroid_noise(0.0);
  }

  void set_centroid_noise(double sigma_m) {
    centroid_noise_m = sigma_m;
    BearingSettings settings;
    settings.model.centroid_noise_m = sigma_m;
    camera.configure(settings);
  }

  /// `bias`: rad, of both components.
  target_tracking::BearingMeasurement bearing(double bias = 0.0) {
    const auto own_state = servicer.state_at(tag), target_state = target.state_at(tag);
    const double distance = (target_state.position_eci - own_state.position_eci).norm();
    const double sigma = std::hypot(kBearingSigma, centroid_noise_m / distance);
    return bearing_of(tag, own_state, target_state, kBearingSigma, sigma * noise.normal2() + Vector2::Constant(bias));
  }

  /// Epochs of both receivers, and a bearing after each.
  void fly(int epochs, bool with_receivers, bool with_bearings, double bias = 0.0) {
    for (int k = 0; k < epochs; ++k, tag = tag + duration_of_seconds(10)) {
      const auto ours = servicer.observe(tag, satellites, kEarth);
      const auto theirs = target.observe(tag, satellites, kEarth);
      step(ours, with_receivers ? &theirs : nullptr);
      const auto seen = bearing(bias);
      if (with_bearings) status = camera.process(tag, seen, sun(), *estimator);
      largest_error.add(error_in_sigmas());
    }
  }

  [[nodiscard]] double error_in_sigmas() const {
    if (!estimator->has_relative()) return 0.0;
    const Matrix3 covariance = filter_covariance().topLeftCorner<3, 3>();
    return filter_position_error() / std::sqrt(covariance.trace());
  }

  Noise noise;
  double centroid_noise_m = 0.0;
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
  filter::RelativeNavigationFilter& start = *pair.estimator;
  const auto roe = orbit::roe_of_target(start.servicer(), pair.target.state_at(tag)).value();
  constexpr double kWide = 3.0 / 7087300.0;
  start.initialize_relative(roe, kWide * kWide * Matrix6::Identity(), filter::SolutionStatus::kEstimated);

  const auto with_bearing = [&](filter::RelativeNavigationFilter& filter) {
    auto seen = bearing_of(tag, pair.servicer.state_at(tag), pair.target.state_at(tag), kBearingSigma, Vector2::Zero());
    BearingModel model;
    model.centroid_noise_m = 0.0;
    filter::MeasurementBatch& batch = filter.workspace();
    ASSERT_EQ(bearing_rows(filter, seen, sun(), model, batch), Status::kOk);
    ASSERT_TRUE(filter.update(BearingAiding::kSource, batch));
  };
  const auto ours = pair.servicer.observe(tag, pair.satellites, kEarth);
  const auto theirs = pair.target.observe(tag, pair.satellites, kEarth);
  const auto with_codes = [&](filter::RelativeNavigationFilter& filter) {
    const auto frame = gnss::EarthFrame::at(tag, kEarth);
    auto differences = std::make_unique<gnss::DifferentialEpoch>();
    gnss::form_differences(ours, theirs, pair.store, frame, *differences);
    CarrierFilter carrier;
    carrier.activate_blocks(filter);
    const AntennaPlatform servicer{.R_eci_body = pair.servicer.R_eci_body_at(tag),
                                   .antenna_body_m = pair.nominal_antenna_m,
                                   .clock_m = gnss::kSpeedOfLight * pair.servicer.clock_s};
    const AntennaPlatform target{.R_eci_body = pair.target.R_eci_body_at(tag),
                                 .antenna_body_m = pair.nominal_antenna_m,
                                 .clock_m = gnss::kSpeedOfLight * pair.target.clock_s};
    const CarrierUpdate update = carrier.process_epoch(*differences, servicer, target, filter);
    ASSERT_GT(update.codes_used, 8);
  };
  const auto information = [&](bool bearing, bool codes) -> Matrix6 {
    auto filter = std::make_unique<filter::RelativeNavigationFilter>(start);
    if (bearing) with_bearing(*filter);
    if (codes) with_codes(*filter);
    return filter->roe_covariance().inverse();
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

constexpr unsigned kSeeds = vbar::test::share_under_sanitizers(5);

TEST(CombinedSources, OneInErrorIsSuspendedAndLeavesTheOrbitToTheOther) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    CombinedPair pair(seed), without(seed);
    pair.fly(40, true, true);
    without.fly(40, true, true);
    ASSERT_EQ(pair.camera.aid().state(), AidState::kAiding) << seed;
    // Both components off by five sigma, from now on.
    pair.fly(10, true, true, 5.0 * kBearingSigma);
    without.fly(10, true, false);
    EXPECT_EQ(pair.camera.aid().state(), AidState::kSuspended) << seed;
    EXPECT_EQ(pair.camera.counters().revisions, 0) << seed;
    const Vector6 apart = pair.filter_error() - without.filter_error();
    const double distance = std::sqrt(apart.dot(without.filter_covariance().inverse() * apart));
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
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
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

// Where receivers determine the orbit, the noise of the centroid is measured: here a quarter of the configured one. The
// normalised innovations then have their expected mean; without receivers they keep that of the configuration.
TEST(CombinedSources, CentroidNoiseIsMeasuredAgainstCarrierPhase) {
  for (const bool with_receivers : {true, false}) {
    double sum = 0.0;
    int count = 0;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      CombinedPair pair(seed, 200.0);
      pair.fly(20, true, false);
      pair.set_centroid_noise(0.12);
      pair.centroid_noise_m = 0.03;
      if (!with_receivers) pair.carrier->stop(pair.tag, *pair.estimator);
      for (int k = 0; k < 160; ++k) {
        pair.fly(1, with_receivers, true);
        if (k < 60) continue;
        sum += 0.5 * pair.camera.last_update().nis;
        ++count;
      }
    }
    // 500 values of mean 1 have one of standard deviation 0.04; the adaptation by a tenth spreads it to 0.1.
    if (with_receivers) {
      EXPECT_NEAR(sum / count, 1.0, 0.3);
    } else {
      EXPECT_LT(sum / count, 0.3);
    }
  }
}

// The noise of the centroid has been adapted to a target that follows the orbit. Then the Sun reaches another of its
// faces, and the centroid moves by 22 cm at 105 m: within the configured size it contradicts no other source. Five
// metres do.
TEST(CombinedSources, ACentroidThatMovesWithinItsStatedSizeContradictsNoOtherSource) {
  constexpr double kDistance_m = 105.0;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    CombinedPair pair(seed, kDistance_m);
    pair.filter_settings.processes.of<CentroidWander>().sigma = 0.05;
    pair.filter_settings.processes.of<BrightnessOffset>().sigma = 0.15;
    pair.filter_settings.processes.of<EarthlightOffset>().sigma = 0.05;
    pair.begin_filter();
    pair.fly(20, true, false);
    pair.set_centroid_noise(0.08);
    pair.centroid_noise_m = 0.01;
    pair.fly(70, true, true);
    ASSERT_EQ(pair.camera.aid().state(), AidState::kAiding) << seed;
    for (int k = 0; k < 25; ++k) {
      pair.fly(1, true, true, 0.22 / std::sqrt(2.0) / kDistance_m);
      EXPECT_FALSE(pair.camera.aid().is_contradicting()) << seed << ' ' << k;
      EXPECT_FALSE(pair.camera.aid().consistency().is_outside()) << seed << ' ' << k;
    }
    EXPECT_EQ(pair.camera.aid().state(), AidState::kAiding) << seed;
    pair.fly(5, true, true, 5.0 / std::sqrt(2.0) / kDistance_m);
    EXPECT_TRUE(pair.camera.aid().is_contradicting()) << seed;
  }
}

/// The pair 12 m apart, with a camera whose images show keypoints besides: lit from abeam of the orbit.
struct ClosePair : CombinedPair {
  explicit ClosePair(unsigned seed) : CombinedPair(seed, 12.0) {
    filter_settings.processes.of<CentroidWander>().sigma = 0.02;
    filter_settings.processes.of<BrightnessOffset>().sigma = 1e-3;
    filter_settings.processes.of<EarthlightOffset>().sigma = 1e-3;
    filter_settings.attitude.inertia = filter::inertia_of(3.0 * Matrix3::Identity()).value();
    begin_filter();
    set_centroid_noise(0.05);  // of a resolved target
    KeypointAidingSettings settings;
    settings.inertia = filter_settings.attitude.inertia;
    keypoints.configure(settings);
  }

  /// Navigation before: `sigma_m` of each of a * ROE.
  void hand_over(double sigma_m) {
    step(servicer.observe(tag, satellites, kEarth), nullptr);
    tag = tag + duration_of_seconds(10);
    step(servicer.observe(tag, satellites, kEarth), nullptr);
    const auto chief = orbit::qns_from_cartesian(servicer.state_at(tag)).value();
    Vector6 error;
    error << 0.0, noise.normal2(), noise.normal2(), 0.0;
    const double sigma = sigma_m / chief.a;
    const Vector6 roe = orbit::roe_of_target(estimator->servicer(), target_beside_estimate()).value() + sigma * error;
    estimator->initialize_relative(roe, sigma * sigma * Matrix6::Identity(), filter::SolutionStatus::kEstimated);
    tag = tag + duration_of_seconds(10);
  }

  void fly_keypoints(int images) {
    for (int k = 0; k < images; ++k, tag = tag + duration_of_seconds(10)) {
      step(servicer.observe(tag, satellites, kEarth), nullptr);
      keypoint_status = keypoints.process(image(), *estimator);
      largest_error.add(error_in_sigmas());
    }
  }

  /// Beside receivers, which determine the orbit.
  void fly_with_receivers_and_keypoints(int images) {
    for (int k = 0; k < images; ++k, tag = tag + duration_of_seconds(10)) {
      const auto ours = servicer.observe(tag, satellites, kEarth);
      const auto theirs = target.observe(tag, satellites, kEarth);
      step(ours, &theirs);
      keypoint_status = keypoints.process(image(), *estimator);
    }
  }

  Vector3 pose_error_camera_m = Vector3::Zero();
  imaging::CameraModel optics = vbar::test::close_camera();
  pose::KeypointShape shape = vbar::test::tango_shape();
  KeypointAiding keypoints;
  KeypointEditStatus keypoint_status = KeypointEditStatus::kNone;

 private:
  /// The target with respect to the estimate of the servicer as truly with respect to the servicer.
  [[nodiscard]] orbit::CartesianState target_beside_estimate() const {
    const orbit::CartesianState ours = servicer.state_at(tag), theirs = target.state_at(tag);
    const orbit::CartesianState estimated = estimator->servicer();
    return {.position_eci = estimated.position_eci + theirs.position_eci - ours.position_eci,
            .velocity_eci = estimated.velocity_eci + theirs.velocity_eci - ours.velocity_eci};
  }

  KeypointImage image() {
    const orbit::CartesianState ours = servicer.state_at(tag);
    const Vector3 apart = target.state_at(tag).position_eci - ours.position_eci;
    KeypointImage made;
    made.time = tag;
    made.camera.model = {.camera = 1, .optics = optics, .shape = shape};
    made.sun_eci = ours.position_eci.cross(ours.velocity_eci).normalized();
    Matrix3 R_camera_eci;
    R_camera_eci.row(2) = apart.normalized().transpose();
    R_camera_eci.row(0) = apart.cross(ours.position_eci).normalized().transpose();
    R_camera_eci.row(1) = R_camera_eci.row(2).cross(R_camera_eci.row(0));
    made.R_camera_eci = R_camera_eci;
    pose::PnpSolution pnp;
    pnp.pose.R_camera_body = R_camera_eci * target.R_eci_body_at(tag);
    pnp.pose.position_camera_m = R_camera_eci * apart + pose_error_camera_m;
    pnp.inliers = static_cast<int>(shape.size());
    pnp.covariance = 1e-4 * Matrix6::Identity();
    for (std::size_t k = 0; k < shape.size(); ++k) {
      const Vector3 point = pnp.pose.position_camera_m + pnp.pose.R_camera_body * shape[k];
      seen[k].pixel = imaging::pixel_of(optics, point).value() + kPixelSigma * noise.normal2();
      seen[k].covariance_px2 = kPixelSigma * kPixelSigma * Matrix2::Identity();
      seen[k].is_usable = true;
      seen[k].peak = 0.5;
    }
    made.keypoints = &seen;
    made.pnp = pnp;
    return made;
  }

  static constexpr double kPixelSigma = 1.0;
  pose::Keypoints seen{};
};

// bearings -> keypoints -> carrier phase -> bearings, each stopped where the next one starts: no change touches the
// orbit or its covariance, and the error never exceeds three sigmas.
TEST(CombinedSources, FourSourcesInTurnLeaveOneOrbit) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    ClosePair pair(seed);
    pair.hand_over(0.2);
    const auto change = [&](auto&& stop) {
      const Matrix6 covariance = pair.estimator->roe_covariance();
      const Vector6 roe = pair.estimator->roe();
      stop();
      EXPECT_EQ(pair.estimator->roe_covariance(), covariance);
      EXPECT_EQ(pair.estimator->roe(), roe);
    };
    pair.fly(30, false, true);
    EXPECT_EQ(pair.camera.aid().state(), AidState::kAiding) << seed;
    change([&] { pair.camera.stop(pair.tag, *pair.estimator); });
    pair.fly_keypoints(60);
    EXPECT_EQ(pair.keypoint_status, KeypointEditStatus::kFilter) << seed;
    EXPECT_TRUE(pair.estimator->has_attitude()) << seed;
    change([&] { pair.estimator->deactivate_attitude(); });
    pair.fly(60, true, false);
    EXPECT_TRUE(pair.carrier->is_fixed()) << seed;
    change([&] { pair.carrier->stop(pair.tag, *pair.estimator); });
    pair.fly(30, false, true);
    EXPECT_EQ(pair.camera.aid().state(), AidState::kAiding) << seed;
    EXPECT_LT(pair.largest_error, 3.0) << seed;
    EXPECT_EQ(pair.estimator->failures(), 0);
    EXPECT_EQ(pair.keypoints.counters().restarts + pair.carrier->counters().restarts, 0);
  }
}

// Images that contradict the orbit, by poses 3 m off, may end the attitude and suspend their source: the orbit that
// receivers determine stays as it is without them.
TEST(CombinedSources, KeypointsDoNotInflateAnOrbitByCarrierPhase) {
  ClosePair pair(1);
  pair.hand_over(0.2);
  pair.fly(30, true, false);
  ASSERT_TRUE(pair.carrier->is_fixed());
  pair.fly_with_receivers_and_keypoints(20);
  ASSERT_TRUE(pair.estimator->has_attitude());
  const double sigma_before = std::sqrt(pair.estimator->position_covariance_eci().trace());
  pair.pose_error_camera_m = Vector3(3.0, 0.0, 0.0);
  pair.fly_with_receivers_and_keypoints(40);
  EXPECT_EQ(pair.keypoints.counters().inflations, 0);
  EXPECT_FALSE(pair.estimator->has_attitude());
  EXPECT_EQ(pair.keypoints.aid().state(), AidState::kSuspended);
  EXPECT_LT(std::sqrt(pair.estimator->position_covariance_eci().trace()), 1.2 * sigma_before);
  EXPECT_LT(pair.error_in_sigmas(), 3.0);
  EXPECT_TRUE(pair.carrier->is_fixed());
}

}  // namespace
}  // namespace vbar::fsw::measurements
