#include "fsw/measurements/bearings/bearing_aiding.h"

#include <memory>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::measurements {
namespace {

using namespace measurements::test;
using filter::Burn;
using filter::kAt;
using filter::Propagation;
using filter::SolutionStatus;

constexpr double kSigma = 12.0 * kArcsec;

filter::FilterSettings blocks() {
  filter::FilterSettings settings;
  settings.earth = scene_earth();
  settings.processes.of<CentroidWander>().sigma = 1e-3;
  return settings;
}

/// A pair under the on-board gravity, and a filter that is aided by bearings.
class BearingAidingScene : public testing::Test {
 protected:
  BearingAidingScene() {
    BearingSettings settings;
    settings.batch.bearings = 30;
    settings.model.centroid_noise_m = 0.0;
    aiding.configure(settings);
    filter->configure(blocks());
    servicer = scene_servicer();
    target = scene_target(servicer, roe_of_metres(-300.0, -20000.0, 0.0, 500.0, 0.0, 500.0));
    filter->set_apriori(apriori(scene_target(servicer, roe_of_metres(-310.0, -20300.0, 80.0, 400.0, -60.0, 450.0))));
  }

  filter::TargetApriori apriori(const orbit::CartesianState& state) const {
    filter::TargetApriori known;
    known.time = now;
    known.target = state;
    known.sigma_a_roe_m << 30.0, 500.0, 100.0, 100.0, 100.0, 100.0;
    return known;
  }

  /// Ten seconds on, through the burns within.
  void move() {
    const GpsTime next = now + duration_of_seconds(10);
    target = Propagation(now, scene_earth(), scene_sun()).coast(target, 10.0);
    for (const Burn& burn : burns) {
      if (burn.time < now || burn.time >= next) continue;
      servicer = Propagation(now, scene_earth(), scene_sun()).coast(servicer, seconds(burn.time - now));
      servicer = orbit::apply_impulse_rtn(servicer, burn.dv_rtn);
      now = burn.time;
    }
    servicer = Propagation(now, scene_earth(), scene_sun()).coast(servicer, seconds(next - now));
    now = next;
  }

  void take_position() {
    filter->advance_to(now, burns);
    filter::AbsolutePosition position;
    position.position_eci = servicer.position_eci;
    for (int axis = 0; axis < 3; ++axis) position.position_eci(axis) += noise.normal();
    filter->update_absolute_orbit(position);
  }

  BearingEditStatus look(bool has_bearing = true) {
    filter->advance_to(now, burns);
    std::optional<target_tracking::BearingMeasurement> bearing;
    const Vector2 error = kSigma * (scatter * noise.normal2() + shift);
    if (has_bearing) bearing = bearing_of(now, servicer, target, kSigma, error);
    return aiding.process(now, bearing, scene_sun(), *filter);
  }

  /// Six positions and a bearing a minute; the scene stands at the time of the last bearing.
  BearingEditStatus watch(int minutes, bool has_bearing = true, bool has_positions = true) {
    BearingEditStatus status = BearingEditStatus::kNone;
    for (int k = 0; k < minutes; ++k) {
      for (int fix = 0; fix < 6; ++fix) {
        move();
        if (has_positions) take_position();
      }
      status = look(has_bearing);
    }
    return status;
  }

  double error() const {
    const auto estimated = orbit::relative_state_rtn(filter->servicer(), filter->target().value());
    const auto truth = orbit::relative_state_rtn(servicer, target);
    return (estimated.position_rtn - truth.position_rtn).norm();
  }
  double sigma() const {
    return std::sqrt(filter::covariance_rtn(filter->estimate(), filter->servicer()).topLeftCorner<3, 3>().trace());
  }
  bool valid() const { return filter->solution_status() == SolutionStatus::kEstimated; }

  GpsTime now = scene_start();
  orbit::CartesianState servicer, target;
  std::vector<Burn> burns;
  Noise noise{11};
  double scatter = 1.0;             ///< of the bearings, over their standard deviation
  Vector2 shift = Vector2::Zero();  ///< common to them, in standard deviations
  std::unique_ptr<filter::RelativeNavigationFilter> filter = std::make_unique<filter::RelativeNavigationFilter>();
  BearingAiding aiding;
};

TEST_F(BearingAidingScene, AprioriThenBatchThenRows) {
  EXPECT_FALSE(filter->has_relative());
  EXPECT_EQ(watch(1, false), BearingEditStatus::kNone);
  EXPECT_EQ(filter->solution_status(), SolutionStatus::kApriori);
  // The a-priori orbit: 500 m along track, and the servicer's velocity, known to some 0.1 m/s after a minute.
  EXPECT_GT(sigma(), 500.0);
  EXPECT_EQ(aiding.aid().state(), AidState::kWaiting);
  EXPECT_EQ(watch(29), BearingEditStatus::kBatch);
  EXPECT_FALSE(valid());
  EXPECT_EQ(aiding.aid().state(), AidState::kStarting);
  EXPECT_EQ(watch(1), BearingEditStatus::kBatch);
  EXPECT_TRUE(valid());
  EXPECT_EQ(aiding.aid().state(), AidState::kAiding);
  EXPECT_EQ(watch(1), BearingEditStatus::kFilter);
  EXPECT_EQ(aiding.last_accepted(), now);
  EXPECT_NEAR(aiding.counters().used, 31, 1);
  EXPECT_LT(error(), 4.0 * sigma());
}

TEST_F(BearingAidingScene, ABurnDeterminesTheRange) {
  watch(100);
  const double before = sigma();
  burns.push_back({now + duration_of_seconds(20), {0.0, 0.1, 0.1}});
  watch(100);
  EXPECT_LT(sigma(), 0.25 * before);
  EXPECT_LT(error(), 4.0 * sigma());
}

TEST_F(BearingAidingScene, CoastsThroughAnEclipseAndASilentReceiver) {
  watch(90);
  watch(35, false, false);
  EXPECT_TRUE(valid());
  EXPECT_LT(error(), 4.0 * sigma());
  watch(30);
  EXPECT_EQ(aiding.counters().rejected, 0);
  EXPECT_LT(error(), 4.0 * sigma());
}

TEST_F(BearingAidingScene, AnHourOfSilenceSuspendsTheSourceAndLeavesTheOrbit) {
  watch(60);
  watch(60, false);
  EXPECT_EQ(aiding.aid().state(), AidState::kSuspended);
  EXPECT_TRUE(valid());
  EXPECT_EQ(watch(1), BearingEditStatus::kFilter);
  EXPECT_EQ(aiding.aid().state(), AidState::kAiding);
}

/// Bearings that contradict the orbit are refused, then the orbit is revised; the servicer's own orbit follows its
/// receiver, by its own gate.
TEST_F(BearingAidingScene, AnUnreportedBurnIsRefusedThenFollowed) {
  watch(120);
  servicer = orbit::apply_impulse_rtn(servicer, {0.02, -0.05, 0.05});
  watch(240);
  EXPECT_GT(aiding.counters().rejected, 0);
  EXPECT_GT(aiding.counters().revisions + aiding.counters().restarts, 0);
  EXPECT_TRUE(valid());
  EXPECT_LT(error(), 4.0 * sigma());
  EXPECT_EQ(watch(1), BearingEditStatus::kFilter);
}

/// Five times the stated scatter for twenty images: the bearings are refused or weigh less, and a correct orbit stays.
TEST_F(BearingAidingScene, BearingsThatScatterLeaveACorrectOrbit) {
  watch(240);
  const double before = sigma();
  scatter = 5.0;
  watch(20);
  EXPECT_GT(aiding.counters().rejected, 3);
  EXPECT_EQ(aiding.counters().revisions + aiding.counters().restarts, 0);
  EXPECT_TRUE(valid());
  EXPECT_LT(sigma(), 1.2 * before);
  EXPECT_LT(error(), 4.0 * sigma());
  scatter = 1.0;
  watch(30);
  EXPECT_EQ(aiding.aid().state(), AidState::kAiding);
  EXPECT_LT(sigma(), 1.2 * before);
  EXPECT_LT(error(), 4.0 * sigma());
}

/// White innovations larger than stated are scatter: the orbit stays. Those of one sign are an error of the orbit
/// across the line of sight: its covariance becomes that of the innovations there, and grows less along the line of
/// sight.
TEST_F(BearingAidingScene, LargeInnovationsOfOneSignInflateTheOrbitAndWhiteOnesDoNot) {
  watch(240);
  const auto variances = [&] {
    const Matrix6 rtn = filter::covariance_rtn(filter->estimate(), filter->servicer());
    return Vector3(rtn.diagonal().head<3>());
  };
  const Vector3 before = variances();
  aiding.explain_excess(4.0, *filter);
  EXPECT_EQ(variances(), before);
  watch(60);
  shift = Vector2(2.0, 2.0);
  watch(12);
  const Matrix6 lagging = filter->roe_covariance();
  const double distance = (target.position_eci - servicer.position_eci).norm();
  aiding.explain_excess(4.0, *filter);
  const Vector3 after = variances();
  for (const int axis : {0, 2}) EXPECT_GT(std::sqrt(after(axis)), kSigma * distance) << axis;
  const Matrix6 excess = (filter->roe_covariance() - lagging) / lagging.trace();
  const Vector6 eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix6>(excess).eigenvalues();  // in ascending order
  EXPECT_GT(eigenvalues(4), 0.0);
  EXPECT_LT(std::abs(eigenvalues(3)), 1e-9 * eigenvalues(5));
}

/// Two hours without bearings, then those of a body on the target's orbit, 10 km behind it, for two hours with a burn:
/// the filter takes its orbit. The one before is kept, and is what the filter itself would have propagated without
/// bearings.
TEST_F(BearingAidingScene, TheOrbitBeforeThatOfAnotherBodyIsKeptAndReturns) {
  watch(240);
  watch(120, false);
  const orbit::CartesianState right = target;
  const auto unaided = std::make_unique<filter::RelativeNavigationFilter>(*filter);
  target = scene_target(
      servicer, orbit::roe_of_target(servicer, target).value() + roe_of_metres(0.0, -10000.0, 0.0, 0.0, 0.0, 0.0));
  const GpsTime since = now;
  burns.push_back({now + duration_of_seconds(3605), {0.01, -0.02, 0.03}});
  watch(120);
  ASSERT_GT(aiding.counters().revisions + aiding.counters().restarts, 0);

  orbit::CartesianState still = right;
  for (GpsTime time = since; time < now; time = time + duration_of_seconds(10))
    still = Propagation(time, scene_earth(), scene_sun()).coast(still, 10.0);
  target = still;
  EXPECT_GT(error(), 10.0 * sigma());  // the filter is wrong

  const KeptOrbit& kept = aiding.kept_at_epoch(*filter);
  ASSERT_TRUE(kept.is_kept());
  unaided->advance_to(now, burns);
  const Vector6 difference_m = kA * (kept.roe() - unaided->roe());
  EXPECT_LT(accuracy::largest_entry(difference_m), 0.5);
  for (int k = 0; k < 6;
       ++k) {  // more, because accelerations that the filter knows the direction of count in all three
    const double ratio = std::sqrt(kept.covariance()(k, k) / unaided->roe_covariance()(k, k));
    EXPECT_GT(ratio, 0.9) << k;
    EXPECT_LT(ratio, 1.6) << k;
  }

  aiding.return_to_kept(now, *filter);
  EXPECT_FALSE(kept.is_kept());
  EXPECT_TRUE(valid());
  EXPECT_LT(error(), 4.0 * sigma());
  EXPECT_EQ(watch(1), BearingEditStatus::kFilter);
  watch(60);
  EXPECT_LT(error(), 4.0 * sigma());
}

TEST_F(BearingAidingScene, AnOrbitIsKeptForHalfADay) {
  watch(120);
  KeptOrbit kept;
  EXPECT_FALSE(kept.target(servicer).ok());
  kept.keep(*filter);
  filter->advance_to(now + KeptOrbit::kLongest, {});
  kept.advance(*filter);
  EXPECT_TRUE(kept.is_kept());
  filter->advance_to(filter->epoch() + duration_of_seconds(1), {});
  kept.advance(*filter);
  EXPECT_FALSE(kept.is_kept());
}

TEST_F(BearingAidingScene, ASecondAprioriDoesNotReplaceAnEstimate) {
  watch(60);
  const Vector6 roe = filter->roe();
  const Matrix6 covariance = filter->roe_covariance();
  filter->set_apriori(apriori(servicer));
  EXPECT_EQ(filter->roe(), roe);
  EXPECT_EQ(filter->roe_covariance(), covariance);
  EXPECT_TRUE(valid());
}

TEST_F(BearingAidingScene, ABearingThatDoesNotFitChangesNothing) {
  watch(60);
  const Vector6 roe = filter->roe();
  const Matrix6 covariance = filter->roe_covariance();
  auto bearing = bearing_of(now, servicer, target, kSigma, {1e-2, 0.0});
  EXPECT_EQ(aiding.process(now, bearing, scene_sun(), *filter), BearingEditStatus::kRejected);
  bearing.direction_eci = -bearing.direction_eci;  // behind the camera
  EXPECT_EQ(aiding.process(now, bearing, scene_sun(), *filter), BearingEditStatus::kRejected);
  bearing.direction_eci.setConstant(NAN);
  EXPECT_EQ(aiding.process(now, bearing, scene_sun(), *filter), BearingEditStatus::kRejected);
  EXPECT_EQ(filter->roe(), roe);
  EXPECT_EQ(filter->roe_covariance(), covariance);
}

/// Against Kalman's equations with full matrices, the sensitivities by differences of the geometry.
TEST(BearingRows, TheirUpdateIsKalmans) {
  const orbit::CartesianState servicer = scene_servicer();
  const Vector6 roe = roe_of_metres(-87.0, -50000.0, 30.0, 1000.0, -20.0, 1000.0);
  Vector6 sigma_roe;
  sigma_roe << 2.0, 20.0, 3.0, 3.0, 3.0, 3.0;
  sigma_roe /= kA;
  const auto filter = std::make_unique<filter::RelativeNavigationFilter>();
  filter->configure(blocks());
  filter->advance_to(scene_start(), {});
  filter->set_states(servicer, scene_target(servicer, roe));
  filter->initialize_relative(roe, sigma_roe.cwiseAbs2().asDiagonal(), SolutionStatus::kEstimated);
  filter::Estimate& estimate = filter->estimate();
  estimate.reset(kAt<BrightnessOffset>, 0.1, 0.15 * 0.15);
  estimate.reset(kAt<EarthlightOffset>, -0.03, 0.05 * 0.05);
  for (int axis = 0; axis < 2; ++axis) {
    estimate.reset(kAt<CentroidWander> + axis, 0.02 - 0.05 * axis, 0.3 * 0.3);
    estimate.reset(kAt<BearingBias> + axis, 1e-6, 1.5e-5 * 1.5e-5);
  }

  constexpr int kSmall = 12;
  using Small = Eigen::Matrix<double, kSmall, 1>;  // ROE, brightness offset, wander, boresight, earthlight offset
  constexpr std::array<int, kSmall> kIndex = {0,
                                              1,
                                              2,
                                              3,
                                              4,
                                              5,
                                              kAt<BrightnessOffset>,
                                              kAt<CentroidWander>,
                                              kAt<CentroidWander> + 1,
                                              kAt<BearingBias>,
                                              kAt<BearingBias> + 1,
                                              kAt<EarthlightOffset>};
  const auto bearing = bearing_of(scene_start(), servicer, scene_target(servicer, roe), 12.0 * kArcsec, {2e-5, -3e-5});
  const Matrix3 axes = target_tracking::bearing_axes(bearing.direction_eci, servicer);
  const double growth = target_tracking::centroid_scatter_growth(
      target_tracking::cos_phase_of(scene_target(servicer, roe).position_eci - servicer.position_eci, scene_sun()));
  const auto shown = [&](const Small& x) {
    const Vector3 target = scene_target(servicer, x.head<6>()).position_eci;
    const Vector3 sight =
        target_tracking::centre_of_brightness(target, servicer.position_eci, scene_sun(), {x(6), x(11)}) -
        servicer.position_eci;
    return Vector2(axes.topRows<2>() * sight.normalized() + growth * x.segment<2>(7) / sight.norm() + x.segment<2>(9));
  };
  Small mean, sigma;
  for (int k = 0; k < kSmall; ++k) {
    mean(k) = estimate.mean(kIndex[static_cast<std::size_t>(k)]);
    sigma(k) = std::sqrt(estimate.variance(kIndex[static_cast<std::size_t>(k)]));
  }
  Eigen::Matrix<double, 2, kSmall> h;
  for (int k = 0; k < kSmall; ++k) {
    const Small step = 0.01 * sigma(k) * Small::Unit(k);
    h.col(k) = (shown(mean + step) - shown(mean - step)) / (0.02 * sigma(k));
  }
  BearingModel model;
  model.centroid_noise_m = 0.5;
  const double range = (scene_target(servicer, roe).position_eci - servicer.position_eci).norm();
  const Eigen::Matrix<double, kSmall, kSmall> p = sigma.cwiseAbs2().asDiagonal();
  const double variance = bearing.sigma * bearing.sigma + 0.25 * growth * growth / (range * range);
  const Matrix2 s = h * p * h.transpose() + variance * Matrix2::Identity();
  const Eigen::Matrix<double, kSmall, 2> gain = p * h.transpose() * s.inverse();
  const Small expected = mean - gain * shown(mean);
  const Eigen::Matrix<double, kSmall, kSmall> rest = p - gain * h * p;

  filter::MeasurementBatch& batch = filter->workspace();
  ASSERT_EQ(bearing_rows(*filter, bearing, scene_sun(), model, batch), Status::kOk);
  estimation::predict_innovations(estimate, batch);
  const double nis = estimation::group_nis(batch, 0, 2);
  EXPECT_NEAR(nis, shown(mean).dot(s.inverse() * shown(mean)), 1e-3 * nis);
  EXPECT_NEAR(nis, estimation::joint_nis(batch), 1e-9 * nis);
  ASSERT_TRUE(filter->update(BearingAiding::kSource, batch));
  for (int k = 0; k < kSmall; ++k) {
    const int i = kIndex[static_cast<std::size_t>(k)];
    // The bearing's curvature over a sigma is 1e-4 of its slope.
    EXPECT_NEAR(estimate.mean(i), expected(k), 1e-3 * sigma(k)) << k;
    EXPECT_NEAR(estimate.variance(i), rest(k, k), 1e-3 * p(k, k)) << k;
  }
  EXPECT_LT((batch.residual.head<2>() + shown(expected)).norm(), 1e-3 * shown(mean).norm());
}

}  // namespace
}  // namespace vbar::fsw::measurements
