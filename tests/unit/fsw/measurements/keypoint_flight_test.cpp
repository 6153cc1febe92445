// Waypoints 8 to 10 without images: accuracy, consistency, and what the source survives without losing the orbit.

#include "tests/unit/fsw/measurements/keypoint_flight.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"

namespace vbar::fsw::measurements {
namespace {

using filter::SolutionStatus;
using vbar::test::CloseFlight;
using vbar::test::KeypointErrors;

constexpr std::size_t kSettled = 120;  // images: ten minutes
const Vector6 kHandOverSigma{0.05, 0.5, 0.1, 0.1, 0.1, 0.1};

/// Truth once for all tests: the orbit is the same for every seed.
const CloseFlight& whole_flight() {
  static const CloseFlight flight = vbar::test::fly_closely(2.25);
  return flight;
}

/// Means over the images used after the first ten minutes, and NEES at the end.
struct Outcome {
  double position_m = 0.0;
  double attitude_deg = 0.0;
  double roe_nees = 0.0;
  double attitude_nees = 0.0;
};

Outcome navigate(const filter::FilterSettings& blocks, const KeypointAidingSettings& settings,
                 const KeypointErrors& errors, double rate_deg_s, unsigned seed) {
  KeypointFlight flown(whole_flight(), errors, rate_deg_s, seed, blocks, settings);
  flown.hand_over(Vector6::Zero(), kHandOverSigma);
  Outcome outcome;
  int count = 0;
  while (flown.next < whole_flight().epochs.size()) {
    const std::size_t k = flown.next;
    if (flown.step() != KeypointEditStatus::kFilter || k < kSettled) continue;
    outcome.position_m += flown.error.position_m;
    outcome.attitude_deg += flown.error.attitude / kDegree;
    outcome.roe_nees = flown.error.roe_nees;
    outcome.attitude_nees = flown.error.attitude_nees;
    ++count;
  }
  EXPECT_GT(count, 1000) << seed;
  EXPECT_EQ(flown.aiding->counters().restarts, 0) << seed;
  EXPECT_EQ(flown.filter->failures(), 0) << seed;
  outcome.position_m /= count;
  outcome.attitude_deg /= count;
  return outcome;
}

Outcome mean_of_seeds(const filter::FilterSettings& blocks, const KeypointAidingSettings& settings,
                      const KeypointErrors& errors, unsigned seeds) {
  Outcome mean;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    // Rates of the mission: 0.3 to 1.5 deg/s.
    const Outcome one = navigate(blocks, settings, errors, 0.3 + 1.2 * (seed - 1) / (seeds - 1), seed);
    mean.position_m += one.position_m / seeds;
    mean.attitude_deg += one.attitude_deg / seeds;
    mean.roe_nees += one.roe_nees / seeds;
    mean.attitude_nees += one.attitude_nees / seeds;
  }
  return mean;
}

constexpr unsigned kSeeds = 8;
// Chi-square of 48 degrees of freedom: 99.9 % between 22 and 88.
constexpr double kMinNees = 22.0 / kSeeds;
constexpr double kMaxNees = 88.0 / kSeeds;

TEST(KeypointFlight, IsConsistentInWhiteNoise) {
  filter::FilterSettings blocks = flight_blocks(whole_flight());
  blocks.processes.of<KeypointCommon>() = {.correlated_share = 0.0,
                                           .shift_sigma_px = 0.05,
                                           .stretch_sigma = 1e-6,
                                           .lasting_stretch = {.sigma = 1e-6, .time_s = 3600.0},
                                           .lasting_turn = {.sigma = 1e-6, .time_s = 3600.0}};
  blocks.processes.of<KeypointOrigin>().sigma = 1e-6;
  blocks.processes.of<CameraMounts>().sigma = 1.5e-5;
  KeypointAidingSettings settings = flight_settings();
  settings.novelty.gain = 0.0;
  settings.editing.tail_degrees = 1e9;  // Gaussian
  const Outcome mean = mean_of_seeds(blocks, settings, {}, kSeeds);
  EXPECT_GT(mean.roe_nees, kMinNees);
  EXPECT_LT(mean.roe_nees, kMaxNees);
  // The truth has no torque but gravity's; the filter allows for others, so its attitude is better than it says.
  EXPECT_GT(mean.attitude_nees, 0.5);
  EXPECT_LT(mean.attitude_nees, kMaxNees);
}

TEST(KeypointFlight, IsConsistentWithANetworkThatErrsAlikeInNeighbouringImages) {
  KeypointErrors errors;
  errors.sigma_px = 2.0;
  errors.told_px = 2.0;
  errors.lasting_share = 0.9;
  errors.outlier_share = 0.03;
  errors.flip_share = 0.05;
  const Outcome mean = mean_of_seeds(flight_blocks(whole_flight()), flight_settings(), errors, kSeeds);
  accuracy::expect_below("keypoints as an aid of the trunk, mean error of the position at 5 to 10 m",
                         "truth, all forces, simulated keypoints of 2 px, 8 seeds", mean.position_m, 0.023, "m");
  accuracy::expect_below("keypoints as an aid of the trunk, mean error of the target's attitude",
                         "truth, gravity gradient, simulated keypoints of 2 px, 8 seeds", mean.attitude_deg, 1.0,
                         "deg");
  EXPECT_GT(mean.roe_nees, 0.3);
  EXPECT_LT(mean.roe_nees, kMaxNees);
  EXPECT_GT(mean.attitude_nees, 0.3);
  EXPECT_LT(mean.attitude_nees, kMaxNees);
}

TEST(KeypointFlight, AdaptsToANetworkWithTooSmallCovariances) {
  KeypointErrors errors;
  errors.sigma_px = 2.0;
  errors.told_px = 1.0;
  errors.lasting_share = 0.7;
  errors.lasting_time_s = 30.0;
  const Outcome mean = mean_of_seeds(flight_blocks(whole_flight()), flight_settings(), errors, 4);
  // Chi-square of 24 degrees of freedom: 99.9 % below 51.2.
  EXPECT_LT(mean.roe_nees, 51.2 / 4.0);
  EXPECT_LT(mean.attitude_nees, 51.2 / 4.0);
}

/// A part of the flight in sunlight, with a fault in it.
class KeypointFaults : public testing::Test {
 protected:
  KeypointFaults()
      : flown(whole_flight(), errors_without_eclipse(), 1.0, 3, flight_blocks(whole_flight()), settings_in_sunlight()) {
    // Abeam of the orbit: never in eclipse.
    const orbit::CartesianState& start = whole_flight().epochs[0].servicer;
    flown.sun_eci = start.position_eci.cross(start.velocity_eci).normalized();
  }

  static KeypointErrors errors_without_eclipse() {
    KeypointErrors errors;
    errors.has_dark = false;
    errors.lasting_share = 0.7;
    return errors;
  }
  static KeypointAidingSettings settings_in_sunlight() {
    KeypointAidingSettings settings = flight_settings();
    settings.max_phase = M_PI;
    return settings;
  }
  void hand_over(double range_sigma_m = 0.02) {
    Vector6 sigma = Vector6::Constant(0.02);
    sigma(1) = range_sigma_m;
    flown.hand_over(Vector6(0.01, 0.3 * range_sigma_m, 0.0, 0.0, 0.0, 0.0), sigma);
  }
  /// Steps until the first image whose keypoints are used.
  int steps_until_keypoints(int limit) {
    for (int k = 0; k < limit; ++k) {
      if (flown.step() == KeypointEditStatus::kFilter) return k + 1;
    }
    return limit + 1;
  }

  KeypointFlight flown;
};

TEST_F(KeypointFaults, AKnownRangeStartsTheAttitudeWithThreeImages) {
  hand_over();
  flown.step();  // two positions initialise the own orbit
  EXPECT_EQ(steps_until_keypoints(10), 3);
  EXPECT_EQ(flown.aiding->aid().state(), AidState::kAiding);
  for (int k = 0; k < 10; ++k) flown.step();
  EXPECT_LT(flown.error.position_m, 0.1);
  EXPECT_LT(flown.error.attitude, 3.0 * kDegree);
}

TEST_F(KeypointFaults, AnUncertainRangeDelaysTheAttitude) {
  hand_over(0.5);
  for (int k = 0; k < 6; ++k) EXPECT_NE(flown.step(), KeypointEditStatus::kFilter) << k;
  EXPECT_FALSE(flown.filter->has_attitude());
  EXPECT_EQ(flown.aiding->aid().state(), AidState::kStarting);
  EXPECT_LE(steps_until_keypoints(20), 20);  // six images that agree, some of them rejected as outliers
  for (int k = 0; k < 10; ++k) flown.step();
  EXPECT_LT(flown.error.position_m, 0.1);
  EXPECT_LT(flown.error.attitude, 3.0 * kDegree);
  EXPECT_EQ(flown.aiding->counters().restarts, 0);
}

/// A network that sees the target too far for as long as it sees the same side of it. The mean of n values of an error
/// of first-order correlation r weighs 1 + (n - 1) (1 - r) / (1 + r) independent ones; treated as n, the range would be
/// wrong by four of its sigmas after 20 images.
TEST_F(KeypointFaults, PositionsThatErrAlikeCountAsFewerOnes) {
  constexpr int kImages = 20;
  KeypointAidingSettings settings = settings_in_sunlight();
  settings.start_range_share = 0.0;  // no attitude
  settings.start_images = 100;
  flown.aiding->configure(settings);
  flown.network_scale = 1.04;
  hand_over(0.5);
  for (int k = 0; k < kImages; ++k) EXPECT_NE(flown.step(), KeypointEditStatus::kFilter) << k;
  ASSERT_GT(flown.aiding->counters().positions_used, kImages / 2);
  const double r = std::exp(-5.0 * 1.0 * kDegree / settings.novelty.angle);  // 1 deg/s, 5 s apart
  const vbar::test::CloseEpoch& start = whole_flight().epochs[0];
  const double range_m = (start.target.position_eci - start.servicer.position_eci).norm();
  const double independent = 1.0 + (kImages - 1) * (1.0 - r) / (1.0 + r);
  const double of_poses_m = settings.agreed_range_share * range_m / std::sqrt(independent);
  EXPECT_GT(flown.sigma_m(), 0.8 * of_poses_m / std::hypot(1.0, of_poses_m / 0.5));  // with the hand-over's 0.5 m
  EXPECT_LT(flown.error.roe_nees, 22.5);  // 99.9 % of chi-square with six degrees of freedom
}

TEST_F(KeypointFaults, WithoutAnyOrbitPosesBeginIt) {
  for (int k = 0; k < 2; ++k) flown.step();
  EXPECT_FALSE(flown.filter->has_relative());
  EXPECT_LE(steps_until_keypoints(200), 200);
  EXPECT_EQ(flown.filter->solution_status(), SolutionStatus::kEstimated);
  for (int k = 0; k < 20; ++k) flown.step();
  EXPECT_LT(flown.error.position_m, 0.3);
  EXPECT_LT(flown.error.attitude, 3.0 * kDegree);
}

/// Half an hour without images: the attitude may be lost, the orbit and its covariance remain.
TEST_F(KeypointFaults, SilenceKeepsTheOrbit) {
  hand_over();
  while (flown.next < 120) flown.step();
  for (int k = 0; k < 360; ++k) {
    flown.coast();
    ASSERT_EQ(flown.filter->solution_status(), SolutionStatus::kEstimated);
  }
  EXPECT_EQ(flown.aiding->aid().state(), AidState::kSuspended);
  EXPECT_LT(flown.error.position_m, 4.0 * flown.sigma_m());
  for (int k = 0; k < 60; ++k) flown.step();
  EXPECT_EQ(flown.aiding->aid().state(), AidState::kAiding);
  EXPECT_EQ(flown.aiding->counters().restarts, 0);
  EXPECT_LT(flown.error.position_m, 0.1);
  EXPECT_LT(flown.error.attitude, 2.0 * kDegree);
}

class KeypointFlips : public KeypointFaults, public testing::WithParamInterface<int> {};

TEST_P(KeypointFlips, TheAttitudeIsInitialisedAgainAndTheOrbitKept) {
  hand_over();
  while (flown.next < 60) flown.step();
  ASSERT_LT(flown.error.attitude, 2.0 * kDegree);
  const double before = flown.error.position_m;
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(M_PI, Vector3::Unit(GetParam())));
  for (int k = 0; k < 10; ++k) flown.step(true, turned);
  EXPECT_LT(flown.error.attitude, 3.0 * kDegree);
  EXPECT_GE(flown.aiding->counters().attitudes_reset, 1);
  EXPECT_EQ(flown.aiding->counters().restarts, 0);
  EXPECT_EQ(flown.filter->solution_status(), SolutionStatus::kEstimated);
  EXPECT_LT(flown.error.position_m, before + 0.05);  // of 3 sigma at this time
}

INSTANTIATE_TEST_SUITE_P(AboutEachAxis, KeypointFlips, testing::Values(0, 1, 2));

class KeypointUpsets : public KeypointFaults, public testing::WithParamInterface<int> {};

/// The network sees the target turned by 90 deg for a minute, with confidence, after the attitude has been confirmed
/// for longer than ten minutes: it is recognised from the first image on, nothing of it is used, and the attitude
/// stays.
TEST_P(KeypointUpsets, AMinuteOfAWrongNetworkChangesNothing) {
  hand_over();
  while (flown.next < 140) {
    flown.aiding->forget_verdict();
    flown.step();
    const auto& verdict = flown.aiding->network_verdict();
    EXPECT_FALSE(verdict && verdict->contradicts) << flown.next;
  }
  const double before = flown.error.position_m;
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.5 * M_PI, Vector3::Unit(GetParam())));
  for (int k = 0; k < 12; ++k) {
    flown.aiding->forget_verdict();
    EXPECT_NE(flown.step(true, turned), KeypointEditStatus::kFilter) << k;
    ASSERT_TRUE(flown.aiding->network_verdict()) << k;
    EXPECT_TRUE(flown.aiding->network_verdict()->contradicts) << k;
  }
  EXPECT_EQ(flown.aiding->aid().state(), AidState::kSuspended);
  EXPECT_EQ(flown.step(), KeypointEditStatus::kFilter);
  EXPECT_EQ(flown.aiding->aid().state(), AidState::kAiding);
  EXPECT_EQ(flown.aiding->counters().attitudes_reset, 0);
  EXPECT_EQ(flown.aiding->counters().inflations, 0);
  EXPECT_LT(flown.error.attitude, 3.0 * kDegree);
  EXPECT_LT(flown.error.position_m, before + 0.03);
}

/// A contradiction that lasts is the attitude's.
TEST_P(KeypointUpsets, AnAttitudeThatIsContradictedForLongerIsInitialisedAgain) {
  hand_over();
  while (flown.next < 140) flown.step();
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.5 * M_PI, Vector3::Unit(GetParam())));
  for (int k = 0; k < 30; ++k) flown.step(true, turned);
  EXPECT_GE(flown.aiding->counters().attitudes_reset, 1);
  EXPECT_LT(flown.error.attitude, 3.0 * kDegree);
}

INSTANTIATE_TEST_SUITE_P(AboutEachAxis, KeypointUpsets, testing::Values(0, 1, 2));

TEST_F(KeypointFaults, AFalseBurnOf30CentimetresASecondIsSurvived) {
  hand_over();
  while (flown.next < 60) flown.step();
  const GpsTime time = whole_flight().epochs[60].time;
  const auto later =
      std::find_if(flown.burns.begin(), flown.burns.end(), [&](const filter::Burn& burn) { return burn.time > time; });
  flown.burns.insert(later, {time, {0.3, 0.0, 0.0}});
  // The attitude outlives the contradiction of the orbit: only positions are used meanwhile.
  for (int k = 0; k < 60; ++k) {
    flown.step();
    EXPECT_LT(flown.error.attitude, 3.0 * kDegree) << k;
  }
  EXPECT_EQ(flown.filter->solution_status(), SolutionStatus::kEstimated);
  EXPECT_GE(flown.aiding->counters().inflations, 1);
  EXPECT_LT(flown.error.position_m, 0.3);
  EXPECT_LT(flown.error.attitude, 3.0 * kDegree);
}

TEST_F(KeypointFaults, ValuesThatAreNotFiniteChangeNothing) {
  hand_over();
  while (flown.next < 30) flown.step();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector6 roe = flown.filter->roe();
  const Matrix6 covariance = flown.filter->roe_covariance();
  const vbar::test::MeasuredEpoch& measured = flown.network.measure(29);
  pose::Keypoints keypoints = *measured.keypoints;
  for (auto& keypoint : keypoints) keypoint.pixel.x() = nan;
  KeypointImage image;
  image.time = measured.time;
  image.camera = flown.camera;
  image.sun_eci = *flown.sun_eci;
  image.R_camera_eci = measured.R_camera_eci;
  image.keypoints = &keypoints;
  image.pnp = measured.pnp;
  image.pnp->pose.position_camera_m.x() = nan;
  image.pnp->pose.R_camera_body.setConstant(nan);
  EXPECT_EQ(flown.aiding->process(image, *flown.filter), KeypointEditStatus::kNone);
  for (auto& keypoint : keypoints) {
    keypoint.pixel = {400.0, 300.0};
    keypoint.covariance_px2.setZero();
  }
  EXPECT_EQ(flown.aiding->process(image, *flown.filter), KeypointEditStatus::kNone);
  image.R_camera_eci->setConstant(nan);
  EXPECT_EQ(flown.aiding->process(image, *flown.filter), KeypointEditStatus::kNone);
  EXPECT_EQ(flown.filter->roe(), roe);
  EXPECT_EQ(flown.filter->roe_covariance(), covariance);
  for (int k = 0; k < 10; ++k) EXPECT_EQ(flown.step(), KeypointEditStatus::kFilter);
}

/// Outside the shadow, but the camera looks into the dark side: positions alone, no attitude, and no persistence of
/// refusals.
TEST_F(KeypointFaults, ABacklitTargetStartsNoAttitude) {
  flown.aiding->configure(flight_settings());
  hand_over();
  const vbar::test::CloseEpoch& start = whole_flight().epochs[0];
  const Vector3 to_target = (start.target.position_eci - start.servicer.position_eci).normalized();
  ASSERT_TRUE(filter::is_sunlit(start.target.position_eci, to_target));
  const Vector3 abeam = *flown.sun_eci;
  flown.sun_eci = to_target;
  for (int k = 0; k < 20; ++k) EXPECT_NE(flown.step(), KeypointEditStatus::kFilter);
  EXPECT_FALSE(flown.filter->has_attitude());
  flown.sun_eci = abeam;
  EXPECT_LE(steps_until_keypoints(10), 10);
}

/// The target is lit, but enters the shadow within two minutes.
TEST_F(KeypointFaults, NoAttitudeStartsBeforeDusk) {
  hand_over();
  const orbit::CartesianState& target = whole_flight().epochs[0].target;
  const Vector3 radial = target.position_eci.normalized();
  const Vector3 forward = target.velocity_eci.normalized();
  // Angle from the antisolar direction to the target: that of the edge and 1.5 minutes of the orbit.
  const double ahead = std::asin(6378137.0 / target.position_eci.norm()) + 5.4 * kDegree;
  flown.sun_eci = -(std::cos(ahead) * radial + std::sin(ahead) * forward);
  ASSERT_TRUE(filter::is_sunlit(target.position_eci + 20.0 * target.velocity_eci, *flown.sun_eci));
  ASSERT_FALSE(filter::is_sunlit(target.position_eci + 120.0 * target.velocity_eci, *flown.sun_eci));
  for (int k = 0; k < 10; ++k) EXPECT_NE(flown.step(), KeypointEditStatus::kFilter);
  EXPECT_FALSE(flown.filter->has_attitude());
}

/// The network sees nothing of a lit target that should be in the image: the target is searched in the whole image.
/// That it is missing shows nothing of where it is: the estimate is kept, and its covariance is that of a coast.
TEST_F(KeypointFaults, AMissingTargetIsSearchedAndTheEstimateKept) {
  hand_over();
  while (flown.next < 60) flown.step();
  EXPECT_FALSE(flown.aiding->searches());
  for (int k = 0; k < 13; ++k) flown.step(false);
  EXPECT_TRUE(flown.aiding->searches());
  const Vector6 roe = flown.filter->roe();
  for (int k = 0; k < 30; ++k) flown.step(false);
  EXPECT_LT((flown.filter->roe() - roe).norm() * 7.0e6, 5.0);
  EXPECT_LT(flown.error.position_m, 4.0 * flown.sigma_m());
  EXPECT_LT(flown.sigma_m(), 0.5);
  EXPECT_EQ(flown.aiding->counters().inflations, 0);
  EXPECT_LE(steps_until_keypoints(10), 10);
  EXPECT_FALSE(flown.aiding->searches());
}

/// Poses that are far from the estimate and agree with each other are those of a displaced target; poses that agree
/// with nothing are those of a network in error.
TEST_F(KeypointFaults, PosesWithoutAgreementDoNotSpoilTheEstimate) {
  hand_over();
  while (flown.next < 140) flown.step();
  const double before = flown.sigma_m();
  const double error = flown.error.position_m;
  for (int k = 0; k < 12; ++k) {
    // Another attitude and another range in each image.
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(1.3 * k, Vector3::Unit(k % 3)));
    flown.network_scale = k % 2 == 0 ? 0.3 : 2.5;
    flown.step(true, turned);
  }
  flown.network_scale = 1.0;
  EXPECT_EQ(flown.aiding->counters().inflations, 0);
  EXPECT_GT(flown.aiding->counters().undecided, 0);
  EXPECT_LT(flown.sigma_m(), 3.0 * before);
  EXPECT_LT(flown.error.position_m, error + 0.1);
  EXPECT_LE(steps_until_keypoints(10), 10);
}

}  // namespace
}  // namespace vbar::fsw::measurements
